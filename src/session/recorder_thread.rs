//! A recorder on its own thread, so that a slow disk does not delay the session loop.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread::{self, JoinHandle};

use crossbeam_channel::{Sender, bounded};

use crate::advice;
use crate::capture::recording::RecordedSetup;
use crate::recorder::{RecordError, Recorder};
use crate::snapshot::Snapshot;

/// Steps that wait for the disk: more than 1 s at 175 readings per second.
const QUEUE_LENGTH: usize = 256;

/// Writes every step to a recording.
pub(super) struct RecorderThread {
    path: PathBuf,
    queue: Sender<Snapshot>,
    writer: JoinHandle<Result<(), RecordError>>,
    is_lossless: bool,
    missed: u64,
}

impl RecorderThread {
    /// Creates a recording. A lossless one delays the session loop when the disk is slow; any other one drops steps and
    /// counts them.
    pub fn start(
        path: &Path,
        setup: &RecordedSetup,
        is_lossless: bool,
    ) -> Result<Self, RecordError> {
        let mut recorder = Recorder::create(path, setup)?;
        let (queue, steps) = bounded::<Snapshot>(QUEUE_LENGTH);
        let write = move || {
            for step in steps {
                recorder.write(&step)?;
            }
            recorder.finish()
        };
        let writer = thread::Builder::new().name("recorder".into()).spawn(write);
        Ok(Self {
            path: path.to_owned(),
            queue,
            writer: writer.map_err(|error| {
                // A further attempt must not fail because of the file of this one.
                let _ = fs::remove_file(path);
                RecordError::Create {
                    path: path.to_owned(),
                    reason: advice::no_thread(&error).to_string(),
                }
            })?,
            is_lossless,
            missed: 0,
        })
    }

    /// Queues a step.
    pub fn push(&mut self, step: &Snapshot) {
        let is_queued = match self.is_lossless {
            true => self.queue.send(step.clone()).is_ok(),
            false => self.queue.try_send(step.clone()).is_ok(),
        };
        self.missed += u64::from(!is_queued);
    }

    /// Waits until everything is written.
    pub fn finish(self) -> Result<(), RecordError> {
        drop(self.queue);
        let stopped = |reason: String| RecordError::Write {
            path: self.path.clone(),
            reason,
        };
        match self.writer.join() {
            Err(_) => Err(stopped("the recorder thread panicked".into())),
            Ok(Err(error)) => Err(error),
            Ok(Ok(())) if self.missed > 0 => Err(stopped(format!(
                "the disk is too slow, {} steps are missing",
                self.missed
            ))),
            Ok(Ok(())) => Ok(()),
        }
    }
}

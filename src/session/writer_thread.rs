//! A thread that writes to a file, so that a slow disk does not delay the session loop.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};

use crate::advice;
use crate::recorder::RecordError;

/// Steps that wait for the disk: more than 1 s at 175 readings per second.
const QUEUE_LENGTH: usize = 256;

/// Longest time at the end in which the disk accepts nothing.
const DISK_TIMEOUT: Duration = Duration::from_secs(2);

/// Writes a `T` of every step to a file.
pub(super) struct WriterThread<T> {
    path: PathBuf,
    queue: Sender<T>,
    writer: JoinHandle<Result<(), RecordError>>,
    /// Disconnected when the writer has ended.
    ended: Receiver<()>,
    /// Steps that were written.
    written: Arc<AtomicU64>,
    is_lossless: bool,
    missed: u64,
}

/// The steps on their way to the file, until the session ends.
pub(super) struct QueuedSteps<T> {
    queue: Receiver<T>,
    /// Steps that the writer has taken before the present one.
    written: Arc<AtomicU64>,
    is_first: bool,
}

impl<T> Iterator for QueuedSteps<T> {
    type Item = T;

    fn next(&mut self) -> Option<T> {
        self.count();
        self.queue.recv().ok()
    }
}

impl<T> QueuedSteps<T> {
    /// Returns the next step, or an error if none comes within `timeout` or the session has ended.
    pub fn next_within(&mut self, timeout: Duration) -> Result<T, RecvTimeoutError> {
        self.count();
        self.queue.recv_timeout(timeout)
    }

    /// Counts the step that was taken before as written.
    fn count(&mut self) {
        if !std::mem::take(&mut self.is_first) {
            self.written.fetch_add(1, Ordering::Relaxed);
        }
    }
}

impl<T: Send + 'static> WriterThread<T> {
    /// Starts to write to a new file. A lossless one delays the session loop when the disk is slow, which no output with an
    /// effect allows; any other one drops steps and counts them.
    pub fn start(
        path: &Path,
        is_lossless: bool,
        write: impl FnOnce(QueuedSteps<T>) -> Result<(), RecordError> + Send + 'static,
    ) -> Result<Self, RecordError> {
        let (queue, receiver) = bounded(QUEUE_LENGTH);
        let (end, ended) = bounded::<()>(0);
        let written = Arc::new(AtomicU64::new(0));
        let steps = QueuedSteps {
            queue: receiver,
            written: written.clone(),
            is_first: true,
        };
        let write = move || {
            let _end = end;
            write(steps)
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
            ended,
            written,
            is_lossless,
            missed: 0,
        })
    }

    /// Queues the part of a step.
    pub fn push(&mut self, step: T) {
        let is_queued = match self.is_lossless {
            true => self.queue.send(step).is_ok(),
            false => self.queue.try_send(step).is_ok(),
        };
        self.missed += u64::from(!is_queued);
    }

    /// Waits until everything is written. A disk that accepts nothing for 2 s is given up.
    pub fn finish(self) -> Result<(), RecordError> {
        drop(self.queue);
        let stopped = |reason: String| RecordError::Write {
            path: self.path.clone(),
            reason,
        };
        let written = || self.written.load(Ordering::Relaxed);
        let mut before = written();
        while self.ended.recv_timeout(DISK_TIMEOUT) == Err(RecvTimeoutError::Timeout) {
            if std::mem::replace(&mut before, written()) == written() {
                return Err(stopped("the disk does not respond".into()));
            }
        }
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

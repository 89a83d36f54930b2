//! A recorder that looks on from a thread of its own.

use std::path::{Path, PathBuf};
use std::thread::JoinHandle;

use ademan::capture::Source;
use ademan::recorder::{RecordError, Recorder};
use ademan::setup::LoadedSetup;
use ademan::snapshot::Snapshot;
use crossbeam_channel::{Sender, bounded};

use crate::failure::Failure;

/// Frames that wait for the disk: more than a second at 175 a second.
const WAITING_FRAMES: usize = 256;

/// Writes every frame that it is shown.
pub struct Recording {
    path: PathBuf,
    frames: Sender<Snapshot>,
    writer: JoinHandle<Result<(), RecordError>>,
    waits: bool,
    missed: u64,
}

impl Recording {
    /// Begins a recording of this setup with this source. One that `waits` misses nothing, but holds
    /// up whoever shows it frames: for sources that can wait.
    pub fn start(
        path: &Path,
        assembly: &LoadedSetup,
        source: &dyn Source,
        waits: bool,
    ) -> Result<Self, Failure> {
        let setup = assembly
            .recorded_setup()
            .with_packet_period(source.packet_period());
        let mut recorder = Recorder::create(path, &setup)
            .map_err(|error| Failure::wrong_use(error.to_string()))?;
        let (frames, waiting) = bounded::<Snapshot>(WAITING_FRAMES);
        let writer = std::thread::spawn(move || {
            for frame in waiting {
                recorder.write(&frame)?;
            }
            recorder.finish()
        });
        Ok(Self {
            path: path.to_owned(),
            frames,
            writer,
            waits,
            missed: 0,
        })
    }

    /// Takes a frame.
    pub fn show(&mut self, frame: &Snapshot) {
        let taken = match self.waits {
            true => self.frames.send(frame.clone()).is_ok(),
            false => self.frames.try_send(frame.clone()).is_ok(),
        };
        self.missed += u64::from(!taken);
    }

    /// Waits until all is written.
    pub fn finish(self) -> Result<(), Failure> {
        drop(self.frames);
        let written = self.writer.join();
        let path = self.path.display();
        match written {
            Err(_) => Err(Failure::job(format!("the recorder of {path} broke down"))),
            Ok(Err(error)) => Err(Failure::job(error.to_string())),
            Ok(Ok(())) if self.missed > 0 => Err(Failure::job(format!(
                "{} frames are missing in {path}: the disk was too slow",
                self.missed
            ))),
            Ok(Ok(())) => Ok(()),
        }
    }
}

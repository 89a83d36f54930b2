//! The files that a session records to: all results of each step, and the poses for animation programs.

use std::fs;
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

use crossbeam_channel::RecvTimeoutError;

use super::Session;
use super::observer::Observer;
use super::options::SessionOptions;
use super::write_failures::WriteFailures;
use super::writer_thread::{QueuedSteps, WriterThread};
use crate::capture::recording::RecordedSetup;
use crate::files;
use crate::recorder::{CompleteFile, RecordError, Recorder, cannot_create, write_error};
use crate::trace::bvh::{self, PoseOptions};
use ademan_core::kinematics::HandPose;
use ademan_core::pipeline::Pipeline;
use ademan_core::snapshot::{Snapshot, StepView};
use ademan_core::time::NO_DEADLINE;

/// Time without a step after which the steps so far reach the disk.
const FLUSH_AFTER: Duration = Duration::from_millis(500);

/// Frames per second of a BVH file.
const BVH_RATE_HZ: f64 = 100.0;

/// Checks that the files of the recordings can be created, so that neither is created if one cannot, no output creates a file, which
/// would be in the way of the next try, and no session waits for a device in vain.
pub(super) fn check_files(options: &SessionOptions) -> Result<(), RecordError> {
    let paths = [&options.record_to, &options.record_bvh_to];
    (paths.into_iter().flatten()).try_for_each(|path| check_file(path))?;
    match paths {
        [Some(steps), Some(poses)] if files::is_same_file(steps, poses) => {
            Err(RecordError::Create {
                path: steps.clone(),
                reason: "`--record-bvh` names the same file; choose another name for it".into(),
            })
        }
        _ => Ok(()),
    }
}

fn check_file(path: &Path) -> Result<(), RecordError> {
    files::check_destination(path)
        .and_then(|()| files::check_absent(path))
        .map_err(|error| cannot_create(path, error))
}

impl Session {
    /// Creates the files of the options `record_to` and `record_bvh_to`. With `may_wait`, a slow disk delays the loop.
    pub(super) fn start_recordings(
        &self,
        packet_period: Option<Duration>,
        may_wait: bool,
    ) -> Result<Recordings, RecordError> {
        let mut recordings = Recordings::new(self.write_failures.clone());
        check_files(&self.options)?;
        if let Some(path) = &self.options.record_to {
            let recorded = self.setup.recorded_setup();
            let recorded = recorded.with_packet_period(packet_period);
            recordings.record_steps(path, &recorded, may_wait)?;
        }
        if let Some(path) = &self.options.record_bvh_to {
            let started = recordings.record_poses(path, may_wait);
            started.inspect_err(|_| {
                // A further attempt must not fail because of the file of this one.
                if let Some(steps) = &self.options.record_to {
                    let _ = fs::remove_file(steps);
                }
            })?;
        }
        Ok(recordings)
    }
}

/// The recordings of a session, each with a thread of its own.
#[derive(Default)]
pub(super) struct Recordings {
    steps: Option<WriterThread<Snapshot>>,
    poses: Option<WriterThread<HandPose>>,
    failures: WriteFailures,
}

impl Recordings {
    /// Creates an empty set of recordings. A file that becomes incomplete is added to `failures` at once.
    pub fn new(failures: WriteFailures) -> Self {
        Self {
            failures,
            ..Self::default()
        }
    }

    /// Creates a recording of all results. A lossless one delays the session loop when the disk is slow.
    pub fn record_steps(
        &mut self,
        path: &Path,
        setup: &RecordedSetup,
        is_lossless: bool,
    ) -> Result<(), RecordError> {
        let mut recorder = Recorder::create(path, setup)?;
        // The recording of a replay must not depend on the speed of the machine.
        let timeout = if is_lossless {
            NO_DEADLINE
        } else {
            FLUSH_AFTER
        };
        let write = move |mut steps: QueuedSteps<Snapshot>| {
            loop {
                match steps.next_within(timeout) {
                    Ok(step) => recorder.write(&step)?,
                    Err(RecvTimeoutError::Timeout) => recorder.flush()?,
                    Err(RecvTimeoutError::Disconnected) => {
                        let file = recorder.complete()?;
                        return Ok(move || file.sync());
                    }
                }
            }
        };
        let failures = self.failures.clone();
        self.steps = Some(WriterThread::start(path, is_lossless, failures, write)?);
        Ok(())
    }

    /// Creates a BVH file of the poses of the hands that are seen first.
    pub fn record_poses(&mut self, path: &Path, is_lossless: bool) -> Result<(), RecordError> {
        let file = files::create_private(path).map_err(|error| cannot_create(path, error))?;
        let owned = path.to_owned();
        let write = move |poses: QueuedSteps<HandPose>| {
            let failed = |error: io::Error| write_error(&owned, error);
            let synced = file.try_clone().map_err(failed)?;
            bvh::write_file(poses, file, PoseOptions::new(BVH_RATE_HZ)).map_err(failed)?;
            let complete = CompleteFile::new(owned, synced);
            Ok(move || complete.sync())
        };
        let failures = self.failures.clone();
        self.poses = Some(WriterThread::start(path, is_lossless, failures, write)?);
        Ok(())
    }

    fn push(&mut self, step: &StepView) {
        if let Some(steps) = &mut self.steps {
            steps.push(step.to_snapshot());
        }
        if let (Some(poses), Some(pose)) = (&mut self.poses, step.pose) {
            poses.push(*pose);
        }
    }

    /// Completes the files. Returns the first reason why one is incomplete.
    pub fn finish(self) -> Option<RecordError> {
        let steps = self.steps.and_then(|steps| steps.finish().err());
        let poses = self.poses.and_then(|poses| poses.finish().err());
        steps.or(poses)
    }
}

impl Observer for Recordings {
    fn observe(&mut self, step: &StepView, _: Instant, _: &Pipeline) {
        self.push(step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::recording::Replay;
    use crate::capture::{Channels, Reading, Sample, Source, SourceEvent};
    use ademan_core::pipeline::PipelineState;
    use ademan_core::time::Timestamp;

    #[test]
    fn a_step_of_a_live_source_reaches_the_disk_when_no_other_follows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hand.mcap");
        let mut recordings = Recordings::default();
        let setup = RecordedSetup::default();
        recordings.record_steps(&path, &setup, false).unwrap();
        let channels = Channels {
            full_scale: 255,
            counts: [3, 141].into_iter().collect(),
            unsent: Default::default(),
        };
        let reading = Reading::new(Timestamp(7), None, Sample::Channels(channels));
        let step = Snapshot {
            state: PipelineState::Running,
            reading: Some(reading.clone()),
            ..Snapshot::default()
        };
        recordings.push(&step.view());
        let start = Instant::now();
        // The recording is not complete, as after a crash.
        while Replay::open(&path).unwrap().next().unwrap() == SourceEvent::End {
            assert!(
                start.elapsed() < Duration::from_secs(60),
                "nothing is written"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
        let replayed = Replay::open(&path).unwrap().next().unwrap();
        assert_eq!(replayed, SourceEvent::Reading(reading));
        assert!(recordings.finish().is_none());
    }
}

//! Changes of the calibration and the filter of a running session.
//!
//! The thread that asks for a change builds the estimator. The session loop exchanges it between two readings and returns the
//! old one, so that the loop neither allocates nor frees an estimator.

use std::sync::Arc;

use crossbeam_channel::{Receiver, Sender, bounded};

use super::command_channel::CommandSender;
use super::estimator_swap::EstimatorSwap;
use super::reply::RequestError;
use crate::setup::LoadedSetup;
use ademan_core::document::Document;
use ademan_core::estimate::{ChannelMap, Estimator, Smoothing};
use ademan_core::hand::JointAngles;

/// Changes the glove and the filter of the first hand of a session.
#[derive(Debug)]
pub struct SensorLink {
    setup: Arc<LoadedSetup>,
    commands: CommandSender,
    is_recorded: bool,
    retired: (Sender<Box<Estimator>>, Receiver<Box<Estimator>>),
}

impl SensorLink {
    pub(super) fn new(setup: Arc<LoadedSetup>, commands: CommandSender, is_recorded: bool) -> Self {
        Self {
            setup,
            commands,
            is_recorded,
            retired: bounded(1),
        }
    }

    /// Returns the setup with which the session was started.
    pub fn setup(&self) -> &LoadedSetup {
        &self.setup
    }

    /// Returns the glove file of the first hand with which the session was started; `None` if its source needs none.
    pub fn glove_document(&self) -> Option<&Document> {
        self.setup.glove_document()
    }

    /// Returns the filter with which the session was started.
    pub fn smoothing(&self) -> Smoothing {
        self.setup.smoothing()
    }

    /// Replaces the channels of the glove, its rest pose and the filter. Everything is released first, and output is armed again
    /// once the hand has been clear of every control. Does not wait.
    ///
    /// # Errors
    /// Fails if the session has ended or is recorded, or if the last change has not been made yet.
    pub fn replace(
        &self,
        map: Option<&ChannelMap>,
        rest: &JointAngles,
        smoothing: Smoothing,
    ) -> Result<(), RequestError> {
        if self.is_recorded {
            let reason = "the calibration stays, as the session is recorded, and a recording holds one glove file";
            return Err(RequestError::Refused(reason.into()));
        }
        let estimator = self.setup.finger_estimator(map, rest, smoothing);
        // Frees the estimator of the change before.
        let _ = self.retired.1.try_recv();
        self.commands.send_estimator(EstimatorSwap {
            estimator: Box::new(estimator),
            retired: self.retired.0.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::Sample;
    use crate::session::{Session, SessionOptions};
    use crate::setup::Setup;
    use ademan_core::device::{EventKind, OutputEvent};
    use ademan_core::hand::Dof;
    use ademan_core::pipeline::PipelineState;

    /// A hand that types, and waits for the receiver of its snapshots.
    fn typing() -> (LoadedSetup, SessionOptions) {
        let setup = Setup {
            source: Some("typist:hello hello hello".parse().unwrap()),
            output: "none".into(),
            ..Setup::default()
        };
        let options = SessionOptions {
            lossless_snapshots: true,
            ..SessionOptions::default()
        };
        (setup.load_files().unwrap(), options)
    }

    #[test]
    fn another_offset_changes_the_angle_after_everything_is_released() {
        let (setup, options) = typing();
        let session = Session::start(setup, options).unwrap();
        let snapshots = session.snapshots();
        let is_down = |event: &OutputEvent| matches!(event.kind, EventKind::KeyDown(_));
        let mut first = snapshots.iter();
        assert!(first.any(|snapshot| snapshot.events.iter().any(is_down)));

        let link = session.sensors();
        let map = link.setup().glove.as_ref().unwrap().map.clone();
        let elbow = map
            .rows()
            .iter()
            .position(|row| row.dof == Dof::ElbowFlexion);
        let elbow = elbow.unwrap();
        let mut calibrations: Vec<_> = map.rows().iter().map(|row| row.calibration).collect();
        calibrations[elbow].offset += 0.2;
        let map = map.with_calibrations(&calibrations);
        link.replace(Some(&map), &JointAngles::default(), Smoothing::Off)
            .unwrap();
        // Snapshots from before the change wait in the queue, with their own presses and releases.
        let mut pressed = 1;
        let swapped = snapshots.iter().find(|snapshot| {
            for event in &snapshot.events {
                match event.kind {
                    EventKind::KeyDown(_) => pressed += 1,
                    EventKind::KeyUp(_) => pressed -= 1,
                    _ => {}
                }
            }
            snapshot.reading.is_none() && snapshot.state == PipelineState::Paused
        });
        assert!(swapped.is_some() && pressed == 0, "{pressed} keys are down");
        let next = snapshots.iter().find(|snapshot| snapshot.angles.is_some());
        let next = next.unwrap();
        let Some(Sample::Channels(channels)) = next.reading.map(|reading| reading.sample) else {
            panic!("a reading of channels");
        };
        let row = &map.rows()[elbow];
        let expected = map.radians(row, f64::from(channels.counts[row.channel]));
        let angle = next.angles.unwrap().get(Dof::ElbowFlexion);
        assert!(
            (angle - expected).abs() < 1e-9,
            "{angle} instead of {expected}"
        );
    }

    #[test]
    fn the_calibration_of_a_recorded_session_stays() {
        let (setup, options) = typing();
        let session = Session::start(setup, options).unwrap();
        let loaded = Arc::clone(&session.sensors().setup);
        let link = SensorLink::new(loaded, session.commands().clone(), true);
        let refused = link.replace(None, &JointAngles::default(), Smoothing::Off);
        assert!(
            matches!(refused, Err(RequestError::Refused(_))),
            "{refused:?}"
        );
    }
}

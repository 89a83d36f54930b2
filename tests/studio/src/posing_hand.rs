//! A simulated person in a glove who takes the poses of a calibration.

use std::sync::{Arc, Mutex, MutexGuard};
use std::thread;
use std::time::Duration;

use ademan::calibrate::CalibrationPose;
use ademan::capture::{CaptureError, Channels, Reading, Sample, Source, SourceEvent, SourceStats};
use ademan::layout::Glove;
use ademan::sim::SimulatedWearer;
use ademan::time::Timestamp;

/// Number of the person, who differs from the others in lengths, habits and sensors.
const PERSON: u64 = 3;

/// Time that the source blocks while the person waits.
const IDLE: Duration = Duration::from_millis(1);

/// Behavior and readings of the person.
#[derive(Default)]
struct Part {
    /// Readings that are still to come.
    left: usize,
    pose: Option<CalibrationPose>,
    sent: Vec<(Timestamp, Channels)>,
}

/// The person, for a test that says what to do.
#[derive(Clone, Default)]
pub struct Person(Arc<Mutex<Part>>);

impl Person {
    fn part(&self) -> MutexGuard<'_, Part> {
        self.0.lock().expect("no thread panics with the lock")
    }

    /// Moves to a pose, or holds it, for a number of readings. Returns the number of all readings up to then.
    pub fn take(&self, pose: CalibrationPose, readings: usize) -> usize {
        let mut part = self.part();
        part.pose = Some(pose);
        part.left += readings;
        part.sent.len() + part.left
    }

    /// Returns all readings so far.
    pub fn sent(&self) -> Vec<(Timestamp, Channels)> {
        self.part().sent.clone()
    }
}

/// The glove of the person.
pub struct PosingHand {
    person: Person,
    wearer: SimulatedWearer,
}

impl PosingHand {
    /// Puts a glove on the person.
    pub fn new(person: &Person, glove: &Glove) -> Self {
        Self {
            person: person.clone(),
            wearer: SimulatedWearer::new(PERSON, &glove.map, glove.side),
        }
    }
}

impl Source for PosingHand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let mut part = self.person.part();
        let Some(pose) = part.pose.filter(|_| part.left > 0) else {
            drop(part);
            thread::sleep(IDLE);
            return Ok(SourceEvent::Idle);
        };
        self.wearer.take(pose);
        let (time, channels) = self.wearer.next_packet();
        part.left -= 1;
        part.sent.push((time, channels.clone()));
        let reading = Reading::new(time, None, Sample::Channels(channels));
        Ok(SourceEvent::Reading(reading))
    }

    fn name(&self) -> &str {
        "person"
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.person.part().sent.len() as u64,
            ..SourceStats::default()
        }
    }
}

//! A camera whose images of a person go through a pipeline, image by image.

use ademan::capture::{Reading, Sample};
use ademan::device::{EventKind, Events};
use ademan::hand::{Finger, Joint, JointPositions, Side};
use ademan::setup::LoadedSetup;
use ademan::time::Timestamp;
use glam::DVec3;

use crate::support::checked::CheckedPipeline;

/// The time between two images, in microseconds.
const PERIOD_US: u64 = 33_333;

/// A camera, and a pipeline that receives what the camera sees.
pub struct Camera {
    pub pipeline: CheckedPipeline,
    pub time_us: u64,
    /// Events that no call of [`keys`](Self::keys) has returned.
    pub events: Vec<EventKind>,
}

impl Camera {
    pub fn new(setup: &LoadedSetup) -> Self {
        Self {
            pipeline: CheckedPipeline::new(setup),
            time_us: 1_000_000,
            events: Vec::new(),
        }
    }

    /// Advances the time to the next image.
    pub fn advance(&mut self) {
        self.time_us += PERIOD_US;
    }

    /// Sends what the image shows of one side. Returns `false` if the pipeline rejects it.
    pub fn send(&mut self, side: Side, sample: Sample) -> bool {
        let reading = Reading::new(Timestamp(self.time_us), Some(side), sample);
        let mut events = Events::new();
        let is_accepted = self.pipeline.step(&reading, &mut events).is_ok();
        self.events.extend(events.iter().map(|event| event.kind));
        is_accepted
    }

    /// Returns the keys that went down (`A`) and up (`-A`) since the last call.
    pub fn keys(&mut self) -> String {
        let events = std::mem::take(&mut self.events);
        let keys = events.iter().filter_map(|event| match event {
            EventKind::KeyDown(key) => Some(key.name().to_owned()),
            EventKind::KeyUp(key) => Some(format!("-{}", key.name())),
            _ => None,
        });
        keys.collect::<Vec<_>>().join(" ")
    }
}

/// Returns the fraction of a movement that each of its images shows. The last one is 1.
pub fn images(seconds: f64) -> impl Iterator<Item = f64> {
    let count = (seconds * 1e6 / PERIOD_US as f64).round();
    (1..=count as u32).map(move |number| f64::from(number) / count)
}

/// Returns a hand whose index fingertip is at `tip` and whose other fingers are bent by `bend` degrees at two joints.
pub fn hand(tip: DVec3, bend: f64) -> JointPositions {
    let mut positions = JointPositions::default();
    let wrist = tip + DVec3::new(0.02, 0.0, 0.18);
    positions.set(Joint::Wrist, wrist);
    for &finger in Finger::ALL {
        let side = 0.024 * (finger.index() as f64 - 1.0);
        let is_thumb = finger == Finger::Thumb;
        let turns = if is_thumb || finger == Finger::Index {
            [0.0; 3]
        } else {
            [0.0, bend, bend]
        };
        let mut position = tip + DVec3::new(side, 0.0, if is_thumb { 0.12 } else { 0.09 });
        let mut angle = 0.0_f64;
        let (first, last) = finger.joints()[finger.joints().len() - 4..]
            .split_first()
            .expect("four joints");
        positions.set(*first, position);
        for ((joint, bone), turn) in last.iter().zip([0.042, 0.027, 0.021]).zip(turns) {
            angle += turn.to_radians();
            position += DVec3::new(0.0, -angle.sin(), -angle.cos()) * bone;
            positions.set(*joint, position);
        }
    }
    positions
}

//! The object of a touch.

use serde::Serialize;

use crate::contact::{Phase, TargetName, TargetNames, Touch};
use crate::hand::{Finger, Side};
use crate::time::Timestamp;

/// The object of a touch.
#[derive(Serialize)]
pub struct TouchObject<'a> {
    time_us: Timestamp,
    side: Side,
    finger: Finger,
    target: TargetName<'a>,
    phase: Phase,
    depth: f32,
    position: [f32; 2],
}

impl<'a> TouchObject<'a> {
    /// Creates the object of a touch. `names` has the names of the targets.
    pub fn new(touch: &Touch, names: &'a TargetNames) -> Self {
        Self {
            time_us: touch.time,
            side: touch.side,
            finger: touch.finger,
            target: names.get(touch.target),
            phase: touch.phase,
            depth: touch.depth,
            position: touch.position.to_array(),
        }
    }
}

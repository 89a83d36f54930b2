//! An open hand that is held still, by which a person shows where boards and pointers belong.

use std::time::Duration;

use parry3d::math::Vec3;

use crate::time::Timestamp;

/// The time for which the hand is held.
pub const HOLD: Duration = Duration::from_secs(1);

/// The largest distance of the index fingertip from where it was at first, in metres: the noise of a webcam and the tremor of
/// a raised hand are less, and a hand that reaches for something is further away after 0.1 s.
const STILL: f32 = 0.025;

/// The smallest distance of a fingertip from its knuckle, as a fraction of the length of the finger: a bend of 60° in all.
const OPEN: f32 = 0.9;

/// A fingertip that is still, and the time since when it has been still.
#[derive(Clone, Copy, Debug)]
pub struct StillTip {
    since: Timestamp,
    last: Timestamp,
    first: Vec3,
}

impl StillTip {
    /// Creates a fingertip that is still from now on.
    pub fn new(time: Timestamp, at: Vec3) -> Self {
        Self {
            since: time,
            last: time,
            first: at,
        }
    }

    /// Returns the fingertip at a later time; `None` if it has moved, or if nothing was known of it for longer than `max_gap`.
    #[must_use]
    pub fn at(self, time: Timestamp, at: Vec3, max_gap: Duration) -> Option<Self> {
        let is_still = self.first.distance(at) <= STILL && time.since(self.last) <= max_gap;
        is_still.then_some(Self { last: time, ..self })
    }

    /// Returns the time for which it has been still.
    pub fn duration(&self) -> Duration {
        self.last.since(self.since)
    }
}

/// Returns `true` if a finger is straight. `joints` are the positions from its knuckle to its tip; those that are not known are left
/// out. A finger without a length is not straight.
pub fn is_straight(joints: impl IntoIterator<Item = Vec3>) -> bool {
    let mut joints = joints.into_iter();
    let Some(knuckle) = joints.next() else {
        return false;
    };
    let (length, tip) = joints.fold((0.0, knuckle), |(length, from), to| {
        (length + from.distance(to), to)
    });
    length > 0.0 && tip.distance(knuckle) >= OPEN * length
}

//! A pointer that rests clicks.

use std::time::Duration;

use parry3d::math::Vec2;

use crate::time::Timestamp;

/// A pointer that stays within a circle for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DwellSettings {
    /// For how long.
    pub duration: Duration,
    /// The radius of the circle, in pixels.
    pub radius_px: f32,
}

/// Where the pointer rests.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Resting {
    since: Option<(Vec2, Timestamp)>,
    /// It has clicked, and has to leave the circle before it does again.
    is_done: bool,
}

impl Resting {
    /// Whether it has rested for long enough, once.
    pub(super) fn clicks(&mut self, dwell: DwellSettings, at: Vec2, time: Timestamp) -> bool {
        let Some((middle, since)) = self.since else {
            // Where it is first seen it has to be left first: nobody brought it there.
            *self = Self {
                since: Some((at, time)),
                is_done: true,
            };
            return false;
        };
        if at.distance(middle) > dwell.radius_px {
            *self = Self {
                since: Some((at, time)),
                is_done: false,
            };
            return false;
        }
        let clicks = !self.is_done && time.since(since) >= dwell.duration;
        self.is_done |= clicks;
        clicks
    }
}

//! Dwell clicks: a cursor that rests clicks.

use std::time::Duration;

use parry3d::math::Vec2;

use crate::time::Timestamp;

/// The time and the radius of a dwell click.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DwellSettings {
    /// The time for which the cursor has to rest.
    pub duration: Duration,
    /// The radius of the circle that it must not leave, in pixels.
    pub radius_px: f32,
}

/// Detects that a cursor rests.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DwellDetector {
    /// The center of the circle, and the time at which the cursor entered it.
    circle: Option<(Vec2, Timestamp)>,
    /// `true` if the cursor has to leave the circle before the next click.
    has_clicked: bool,
}

impl DwellDetector {
    /// Updates the position of the cursor; returns `true` once it has rested for long enough.
    pub(super) fn update(
        &mut self,
        settings: DwellSettings,
        position: Vec2,
        time: Timestamp,
    ) -> bool {
        let Some((center, since)) = self.circle else {
            // The first position does not click: the wearer did not move the cursor there.
            *self = Self {
                circle: Some((position, time)),
                has_clicked: true,
            };
            return false;
        };
        if position.distance(center) > settings.radius_px {
            *self = Self {
                circle: Some((position, time)),
                has_clicked: false,
            };
            return false;
        }
        let clicks = !self.has_clicked && time.since(since) >= settings.duration;
        self.has_clicked |= clicks;
        clicks
    }
}

//! A fingertip that pushes forward.

use parry3d::math::Vec3;

use super::gesture::Thresholds;

/// Rate at which the origin of a push follows a fingertip that moves forward, in 1/s: a push needs this multiple of its depth per
/// second. With 15 mm that is 150 mm/s, the minimum speed of TouchFree.
const FOLLOW_RATE: f32 = 10.0;

/// Maximum sideways motion per forward motion: 15°. A fingertip that moves further sideways is on its way to
/// another position.
const MAX_SIDEWAYS: f32 = 0.27;

/// Sideways motion that is ignored, in metres: hand tremor.
const SIDEWAYS_TREMOR: f32 = 0.002;

/// A fingertip that moves forward by more than this multiple of the push depth is reaching, not pushing.
const MAX_DEPTHS: f32 = 2.5;

/// A fingertip slower than this, in m/s, is at rest.
const REST_SPEED: f32 = 0.05;

/// A step more than this many times as long as the step before, and longer than [`MIN_GAP`], hides readings: the fingertip may have
/// moved sideways in it. A camera that loses one picture has a step of twice the length.
const GAP_PERIODS: f32 = 1.75;

/// The shortest step that hides readings, in seconds: longer than the periods of a camera with 30 pictures per second vary.
const MIN_GAP: f32 = 0.05;

/// Measures the depth of a push from an origin.
///
/// The origin follows the fingertip at once when it moves back or sideways, and slowly when it moves forward.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PushDetector {
    origin: Option<Vec3>,
    /// `true` if the fingertip has moved sideways or too far, or was not seen. It has to rest before a push can begin.
    is_travelling: bool,
    /// The duration of the last step, in seconds.
    last_step: f32,
}

impl PushDetector {
    /// Returns the depth of the push, in metres. `depth` is the depth that presses; while a push `is_on`, the
    /// origin does not move. A pose may be [after a gap](crate::kinematics::HandPose::is_after_gap).
    pub(super) fn update(
        &mut self,
        tip: Option<Vec3>,
        forward: Vec3,
        (depth, is_on): (f32, bool),
        (seconds, is_after_gap): (f32, bool),
    ) -> Option<f32> {
        let Some(tip) = tip else {
            *self = Self::default();
            return None;
        };
        let last_step = std::mem::replace(&mut self.last_step, seconds);
        let is_unseen = is_after_gap || seconds > MIN_GAP.max(GAP_PERIODS * last_step);
        let motion = tip - self.origin.unwrap_or(tip);
        let ahead = motion.dot(forward);
        let sideways = (motion - forward * ahead).length();
        let is_sideways = sideways > SIDEWAYS_TREMOR + MAX_SIDEWAYS * ahead;
        if !is_on && (is_sideways || is_unseen) || ahead > MAX_DEPTHS * depth {
            self.is_travelling = true;
        } else if ahead <= REST_SPEED * seconds {
            self.is_travelling = false;
        }
        if self.is_travelling || ahead <= 0.0 {
            self.origin = Some(tip);
            return Some(0.0);
        }
        let follow = if is_on {
            0.0
        } else {
            1.0 - 1.0 / (1.0 + FOLLOW_RATE * seconds)
        };
        self.origin = Some(tip - motion * (1.0 - follow));
        Some(ahead)
    }
}

/// Returns the thresholds of a push that presses at `depth`, in metres: it releases at half of it, and a
/// quarter of it is near.
pub(super) fn thresholds(depth: f32) -> Thresholds {
    Thresholds {
        near: 0.25 * depth,
        off: 0.5 * depth,
        on: depth,
    }
}

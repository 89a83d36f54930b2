//! The settings of a pointer.

use parry3d::math::Vec2;

use super::arm_axes::ArmAxes;
use super::dwell::DwellSettings;
use super::gesture::{Gesture, PinchGaps};
use super::mode::PointingMode;
use crate::contact::TargetId;
use crate::device::KeyAction;
use crate::device::value_output::ValueOutput;
use crate::estimate::OneEuroSettings;
use crate::hand::Side;

/// Maximum number of clicks of a pointer.
pub const MAX_CLICKS: usize = 8;

/// The settings of a pointer. Pixels are in the scale of `screen_px`.
#[derive(Clone, Debug, PartialEq)]
pub struct PointerSettings {
    /// The source of its presses and the subject of its depth events. The scene does not contain it.
    pub target: TargetId,
    /// The hand that points; `None` for the first one that is seen.
    pub side: Option<Side>,
    /// The relation between the hand and the position of the cursor.
    pub mode: PointingMode,
    /// The events that move the cursor.
    pub output: CursorOutput,
    /// The whole range in pixels, to the right and up; at least 2.
    pub screen_px: Vec2,
    /// Maximum motion of the cursor in one step, in pixels; at least 2. Only the very first position is
    /// emitted without this limit.
    pub max_step_px: f32,
    /// The smoothing of the position, in pixels. Does not apply to [`PointingMode::Rate`].
    pub smoothing: Option<OneEuroSettings>,
    /// Distance that the hand moves before the cursor follows, in pixels. The cursor is dragged along as on a
    /// string of this length.
    pub dead_zone_px: f32,
    /// Gain as a function of the speed of the hand, in pixels per second: linear between two knots, constant
    /// beyond the ends. Speeds are ascending. An empty list is a gain of 1.
    pub acceleration: Vec<(f32, f32)>,
    /// The gain while precision is on.
    pub precision_factor: f32,
    /// The gesture for precision, in addition to [`KeyAction::Precision`].
    pub precision_gesture: Option<Gesture>,
    /// The gesture for the clutch: the cursor moves only while it is on. [`KeyAction::Clutch`] holds the
    /// cursor as well.
    pub clutch: Option<Gesture>,
    /// The distances of all pinches.
    pub pinch: PinchGaps,
    /// The clicks and their actions, at most [`MAX_CLICKS`].
    pub clicks: Vec<(ClickMethod, KeyAction)>,
    /// The action that is tapped where the cursor rests.
    pub dwell: Option<(DwellSettings, KeyAction)>,
    /// Distance that the hand moves while a button is pressed before the cursor follows, in pixels.
    pub drag_threshold_px: f32,
    /// Scrolling by moving the hand.
    pub scroll: Option<ScrollSettings>,
    /// The output of the third axis, 0..=1 towards the wearer. Does not apply to [`PointingMode::Rate`].
    pub depth: Option<ValueOutput>,
    /// The axes that the motion of the hand drives while the clutch is held, in the mode [`PointingMode::Arm`].
    pub axes: ArmAxes,
}

impl PointerSettings {
    /// Returns `true` if it uses a stick, trigger or button of a glove.
    pub fn uses_inputs(&self) -> bool {
        let clicks = self.clicks.iter().filter_map(|(method, _)| match method {
            ClickMethod::Gesture(gesture) => Some(*gesture),
            ClickMethod::Push(_) => None,
        });
        let others = [self.precision_gesture, self.clutch];
        let others = others.into_iter().flatten();
        let scroll = self.scroll.iter().map(|scroll| scroll.gesture);
        let mut gestures = clicks.chain(others).chain(scroll);
        self.mode.starts_at_rest() || gestures.any(|it| matches!(it, Gesture::Input(_)))
    }
}

/// The events that move the cursor of the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CursorOutput {
    /// Positions: [`EventKind::MoveTo`](crate::device::EventKind::MoveTo).
    Absolute,
    /// Motion in pixels: [`EventKind::MoveBy`](crate::device::EventKind::MoveBy).
    Relative,
    /// None.
    None,
}

/// The way in which a click is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClickMethod {
    /// A gesture; the action is held while it is on.
    Gesture(Gesture),
    /// A push of the index fingertip by this distance forward, in metres; the action is held while it lasts.
    Push(f32),
}

/// Scrolling by moving the hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScrollSettings {
    /// While it is on, motion scrolls instead of moving the cursor.
    pub gesture: Gesture,
    /// Pixels per detent of the wheel; negative to invert the direction.
    pub px_per_detent: f32,
}

/// Returns the gain at a speed, by linear interpolation between knots with ascending speeds.
pub(super) fn gain(knots: &[(f32, f32)], speed: f32) -> f32 {
    let after = knots.iter().position(|&(knot, _)| speed < knot);
    match (after, knots.last()) {
        (_, None) => 1.0,
        (Some(0), _) => knots[0].1,
        (None, Some(&(_, gain))) => gain,
        (Some(after), _) => {
            let ((slow, low), (fast, high)) = (knots[after - 1], knots[after]);
            low + (high - low) * (speed - slow) / (fast - slow)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_is_linear_between_knots_and_constant_beyond_them() {
        let knots = [(100.0, 0.5), (300.0, 1.5), (400.0, 4.0)];
        let gains = [0.0, 100.0, 200.0, 350.0, 400.0, 9e9].map(|speed| gain(&knots, speed));
        assert_eq!(gains, [0.5, 0.5, 1.0, 2.75, 4.0, 4.0]);
        assert_eq!(gain(&[], 7.0), 1.0);
    }
}

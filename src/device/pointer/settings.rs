//! What a pointer does.

use parry3d::math::Vec2;

use super::dwell::DwellSettings;
use super::gesture::{Gesture, PinchGaps};
use super::mode::PointingMode;
use crate::contact::TargetId;
use crate::device::KeyAction;
use crate::device::value_output::ValueOutput;
use crate::estimate::OneEuroSettings;
use crate::hand::Side;

/// The most clicks that a pointer has.
pub const MAX_CLICKS: usize = 8;

/// What a pointer does. Pixels are those of `screen`.
#[derive(Clone, Debug, PartialEq)]
pub struct PointerSettings {
    /// What owns its presses, and what its depth is told of. Nothing of it is in the scene.
    pub target: TargetId,
    /// The hand that points; `None` for the first that is seen.
    pub side: Option<Side>,
    /// How the hand says where.
    pub mode: PointingMode,
    /// How the cursor of the screen is moved.
    pub output: CursorOutput,
    /// How many pixels the whole range is to the right and up; at least 2.
    pub screen_px: Vec2,
    /// The most that the cursor moves in a frame, in pixels; at least 2. Only the first place of all,
    /// which the cursor may be anywhere away from, is sent as it is.
    pub max_step_px: f32,
    /// How the place is smoothed, in pixels; a [`Rate`](Mode::Rate) is not.
    pub smoothing: Option<OneEuroSettings>,
    /// How far the hand goes before the cursor follows, in pixels: it is drawn along as on a string.
    pub dead_zone_px: f32,
    /// Gains by the speed of the hand, in pixels a second: between two knots along a line, beyond the
    /// ends as at the ends; speeds ascend. None is a gain of 1.
    pub acceleration: Vec<(f32, f32)>,
    /// The gain while the pointer is made slow.
    pub precision_factor: f32,
    /// While it is on the pointer is slow, as by [`KeyAction::Precision`].
    pub precision_gesture: Option<Gesture>,
    /// The cursor moves only while it is on. Beside that [`KeyAction::Clutch`] holds it still.
    pub clutch: Option<Gesture>,
    /// When fingers pinch.
    pub pinch: PinchGaps,
    /// What presses what; at most [`MOST_CLICKS`].
    pub clicks: Vec<(ClickMethod, KeyAction)>,
    /// What is tapped where the cursor rests.
    pub dwell: Option<(DwellSettings, KeyAction)>,
    /// How far the hand goes while something is pressed until the cursor follows, in pixels.
    pub drag_threshold_px: f32,
    /// What makes a wheel of it.
    pub scroll: Option<ScrollSettings>,
    /// What the third axis drives, 0..=1 towards the wearer; not that of a [`Rate`](Mode::Rate).
    pub depth: Option<ValueOutput>,
}

/// How the cursor of the screen is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CursorOutput {
    /// To places on the screen.
    Absolute,
    /// By pixels.
    Relative,
    /// Not at all.
    None,
}

/// What presses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClickMethod {
    /// A gesture, as long as it is on.
    Gesture(Gesture),
    /// The index fingertip, as long as it is pushed forward so many metres from where it was.
    Push(f32),
}

/// What makes a wheel of a pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScrollSettings {
    /// While it is on, motion turns the wheel instead of moving the cursor.
    pub gesture: Gesture,
    /// How many pixels are a click of the wheel; below 0 the wheel turns the other way.
    pub px_per_detent: f32,
}

/// The gain at a speed, by knots whose speeds ascend.
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
    fn gains_lie_on_lines_between_the_knots() {
        let knots = [(100.0, 0.5), (300.0, 1.5), (400.0, 4.0)];
        let gains = [0.0, 100.0, 200.0, 350.0, 400.0, 9e9].map(|speed| gain(&knots, speed));
        assert_eq!(gains, [0.5, 0.5, 1.0, 2.75, 4.0, 4.0]);
        assert_eq!(gain(&[], 7.0), 1.0);
    }
}

//! Signed axes that follow the motion of a hand while its clutch is held: the arm as a 6-DoF joystick.

use super::posture::{HandMotion, HandPosture};
use crate::device::{Axis, Capabilities, Capability, DeviceOutput, EventKind};
use crate::time::Timestamp;

/// The axes of a pointer in the mode [`Arm`](super::PointingMode::Arm).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmAxes {
    /// The axes, each at most once.
    pub axes: Vec<ArmAxis>,
    /// Deflection within which an axis is 0: 0..1.
    pub dead_zone: f32,
    /// Exponent of the response outside the dead zone, more than 0. More than 1 is finer near the center.
    pub curve: f32,
}

/// An axis and the motion that deflects it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmAxis {
    /// The axis.
    pub axis: Axis,
    /// The direction of the motion.
    pub direction: ArmDirection,
    /// The motion for a deflection of 1, in metres or radians; not 0. A negative one reverses the axis. A trigger axis
    /// stays 0 for a negative deflection.
    pub full: f32,
}

/// A direction in which a hand moves or turns.
///
/// Displacements are along the axes of the world. Rotations are right-handed about the axes that the hand had when the
/// clutch was pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmDirection {
    /// To the right.
    Right,
    /// Away from the wearer.
    Forward,
    /// Upwards.
    Up,
    /// About the axis across the palm: the fingers rise.
    Pitch,
    /// About the axis along the hand: clockwise as the wearer sees it.
    Roll,
    /// About the axis out of the back of the hand: counter-clockwise from above.
    Yaw,
}

impl ArmAxes {
    pub(super) fn add_capabilities(&self, required: &mut Capabilities) {
        for axis in &self.axes {
            required.insert(Capability::Axis(axis.axis));
        }
    }

    /// Returns the value of an axis after a motion, rounded to thousandths.
    fn value(&self, axis: &ArmAxis, motion: &HandMotion, gain: f32) -> f32 {
        let deflection = axis.direction.amount(motion) / axis.full;
        let size = deflection.abs().min(1.0);
        let t = ((size - self.dead_zone) / (1.0 - self.dead_zone)).max(0.0);
        let value = t.powf(self.curve) * gain * deflection.signum();
        let lowest = if axis.axis.is_trigger() { 0.0 } else { -1.0 };
        // The sum makes zero positive.
        (value.clamp(lowest, 1.0) * 1e3).round() / 1e3 + 0.0
    }
}

impl ArmDirection {
    fn amount(self, motion: &HandMotion) -> f32 {
        let HandMotion {
            displacement,
            rotation,
        } = motion;
        match self {
            Self::Right => displacement.x,
            Self::Forward => -displacement.z,
            Self::Up => displacement.y,
            Self::Pitch => rotation.x,
            Self::Roll => -rotation.z,
            Self::Yaw => rotation.y,
        }
    }
}

/// The state of the axes: their center and what they have emitted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ArmAxesState {
    /// The posture in which the clutch was pressed; `None` while it is off.
    center: Option<HandPosture>,
    /// The value of each axis that was emitted last.
    emitted: [f32; Axis::COUNT],
}

impl ArmAxesState {
    /// Follows the hand for one step. While `is_engaged` is `false`, every axis is 0.
    pub(super) fn update(
        &mut self,
        settings: &ArmAxes,
        posture: &HandPosture,
        (is_engaged, gain): (bool, f32),
        (time, out): (Timestamp, &mut DeviceOutput),
    ) {
        if !is_engaged {
            self.center(settings, time, out);
            return;
        }
        let center = self.center.get_or_insert(*posture);
        let motion = posture.motion_since(center);
        for (axis, emitted) in settings.axes.iter().zip(&mut self.emitted) {
            emit(
                axis.axis,
                settings.value(axis, &motion, gain),
                emitted,
                time,
                out,
            );
        }
    }

    /// Returns every axis to 0 until the clutch is pressed again.
    pub(super) fn center(&mut self, settings: &ArmAxes, time: Timestamp, out: &mut DeviceOutput) {
        self.center = None;
        for (axis, emitted) in settings.axes.iter().zip(&mut self.emitted) {
            emit(axis.axis, 0.0, emitted, time, out);
        }
    }
}

/// Emits a value that has changed. One that does not fit into the event list is emitted by a later step.
fn emit(axis: Axis, value: f32, emitted: &mut f32, time: Timestamp, out: &mut DeviceOutput) {
    if value.is_finite() && value != *emitted && out.emit(time, EventKind::Axis(axis, value)) {
        *emitted = value;
    }
}

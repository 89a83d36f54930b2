//! The trusted measurements of a hand in one step.

use parry3d::math::Vec3;

use crate::device::DeviceInput;
use crate::hand::{Dof, Finger, FingerSet, Input, Joint};
use crate::kinematics::HandPose;

/// A view of the device input that returns `None` for untrusted measurements.
#[derive(Clone, Copy)]
pub(super) struct TrustedHand<'a>(&'a DeviceInput<'a>);

impl<'a> TrustedHand<'a> {
    pub(super) fn new(input: &'a DeviceInput<'a>) -> Self {
        Self(input)
    }

    /// Returns `true` if the hand was re-acquired: its path since the last step is unknown.
    pub(super) fn jumped(&self) -> bool {
        self.0.pose.jumped
    }

    pub(super) fn pose(&self) -> &'a HandPose {
        self.0.pose
    }

    /// Returns an angle in radians; `None` if it is not measured, not finite, or its finger is untrusted.
    pub(super) fn angle(&self, dof: Dof) -> Option<f32> {
        let is_untrusted = dof
            .finger()
            .is_some_and(|it| self.0.pose.untrusted.contains(it));
        let is_known = self.0.angles.is_known(dof) && !is_untrusted;
        let radians = is_known.then(|| self.0.angles.get(dof) as f32)?;
        radians.is_finite().then_some(radians)
    }

    /// Returns the value of a stick, trigger or button of the glove, −1..=1; `None` if it is unknown or not finite.
    pub(super) fn input(&self, input: Input) -> Option<f32> {
        let value = self.0.inputs.get(input);
        value.filter(|value| value.is_finite())
    }

    /// Returns the center of a fingertip in the world, in metres; `None` if it is unknown, not finite, or
    /// untrusted.
    pub(super) fn tip(&self, finger: Finger) -> Option<Vec3> {
        let tip = self.0.pose.fingertip(finger)?;
        let is_trusted = !self.0.pose.untrusted.contains(finger) && tip.is_finite();
        is_trusted.then_some(tip)
    }

    /// Returns the position of a joint of the palm or the wrist in the world, in metres; `None` if it is unknown, not finite, or
    /// the whole hand is untrusted. It does not depend on a single finger.
    pub(super) fn joint(&self, joint: Joint) -> Option<Vec3> {
        let position = self.0.pose.position(joint)?;
        let is_trusted = self.0.pose.untrusted != FingerSet::ALL && position.is_finite();
        is_trusted.then_some(position)
    }
}

//! What can be believed of a hand in one frame.

use parry3d::math::Vec3;

use crate::device::DeviceInput;
use crate::hand::{Dof, Finger, FingerSet};
use crate::kinematics::HandPose;

/// A hand in one frame without what cannot be believed of it.
#[derive(Clone, Copy)]
pub(super) struct Sight<'a> {
    seen: &'a DeviceInput<'a>,
    untrusted: FingerSet,
}

impl<'a> Sight<'a> {
    pub(super) fn of(seen: &'a DeviceInput<'a>) -> Self {
        let untrusted = seen.pose.untrusted.union(seen.angles.untrusted);
        Self { seen, untrusted }
    }

    /// Whether the hand was re-acquired: nothing is known of the way here.
    pub(super) fn jumped(&self) -> bool {
        self.seen.pose.jumped || self.seen.angles.jumped
    }

    pub(super) fn pose(&self) -> &'a HandPose {
        self.seen.pose
    }

    /// An angle in radians; `None` when it is not measured, not finite, or of a finger in doubt.
    pub(super) fn angle(&self, dof: Dof) -> Option<f32> {
        let is_doubtful = dof.finger().is_some_and(|it| self.untrusted.contains(it));
        let is_seen = self.seen.angles.is_known(dof) && !is_doubtful;
        let radians = is_seen.then(|| self.seen.angles.get(dof) as f32)?;
        radians.is_finite().then_some(radians)
    }

    /// The middle of a fingertip in the world (metres); `None` when it is not known, not finite, or in
    /// doubt.
    pub(super) fn tip(&self, finger: Finger) -> Option<Vec3> {
        let tip = self.seen.pose.fingertip(finger)?;
        let is_believed = !self.untrusted.contains(finger) && tip.is_finite();
        is_believed.then_some(tip)
    }
}

//! A place in space that a hand is seen from.

use parry3d::math::{Pose, Vec3};

use crate::contact::surface::Anchor;
use crate::kinematics::HandPose;

/// A frame that goes along with its anchor and keeps the world's directions: +X to its right, +Y up,
/// +Z towards the wearer, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnchoredFrame {
    /// What it is fixed to.
    pub anchor: Anchor,
    /// Where it is as seen from the anchor, in the world's axes.
    pub anchor_from_frame: Pose,
}

impl AnchoredFrame {
    /// Where it is for this pose of the hand; `None` when its anchor is not known.
    pub fn world_from_frame(&self, pose: &HandPose) -> Option<Pose> {
        let origin = match self.anchor {
            Anchor::World => Vec3::ZERO,
            Anchor::Joint(joint) => pose.position(joint)?,
        };
        Some(Pose::from_parts(
            origin + self.anchor_from_frame.translation,
            self.anchor_from_frame.rotation,
        ))
    }

    /// A point of the world as seen from it; `None` when that is not known or not finite.
    pub(super) fn to_local(&self, pose: &HandPose, point: Vec3) -> Option<Vec3> {
        let place = self.world_from_frame(pose)?.inverse_transform_point(point);
        place.is_finite().then_some(place)
    }

    /// The way away from the wearer, in the world.
    pub(super) fn forward(&self) -> Vec3 {
        self.anchor_from_frame.rotation * Vec3::NEG_Z
    }
}

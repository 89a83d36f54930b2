//! A frame that moves with the body and keeps its orientation in the world.

use parry3d::math::{Pose, Vec3};

use super::posture::HandPoint;
use crate::contact::surface::Anchor;
use crate::kinematics::HandPose;

/// A frame that follows the position of its anchor but not its rotation: +X to the right, +Y up, +Z towards
/// the wearer, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnchoredFrame {
    /// The world, a joint, or the position of the hand at the start.
    pub anchor: Anchor,
    /// The point of the open hand whose position is [`Anchor::Start`].
    pub start: HandPoint,
    /// The pose relative to the position of the anchor, in the world's axes.
    pub anchor_from_frame: Pose,
}

impl AnchoredFrame {
    /// Returns its pose in the world for a pose of the hand; `None` if the position of its anchor is unknown.
    pub fn world_from_frame(&self, pose: &HandPose) -> Option<Pose> {
        let origin = match (self.anchor, self.start) {
            (Anchor::Start, HandPoint::Knuckle) => pose.start.knuckle,
            (Anchor::Start, HandPoint::Wrist) => pose.start.wrist,
            (anchor, _) => anchor.position(pose, false),
        }?;
        Some(Pose::from_parts(
            origin + self.anchor_from_frame.translation,
            self.anchor_from_frame.rotation,
        ))
    }

    /// Converts a point of the world into this frame; `None` if the result is unknown or not finite.
    pub(super) fn to_local(self, pose: &HandPose, point: Vec3) -> Option<Vec3> {
        let local = self.world_from_frame(pose)?.inverse_transform_point(point);
        local.is_finite().then_some(local)
    }

    /// Returns the direction away from the wearer, in the world.
    pub(super) fn forward(&self) -> Vec3 {
        self.anchor_from_frame.rotation * Vec3::NEG_Z
    }
}

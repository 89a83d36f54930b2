//! Positions of a fingertip on a target.

use parry3d::math::{Pose, Vec3};

use super::action::TargetPoint;

/// A target that the fingertip can press. Heights are measured from the front of the target to the fingertip's pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ReachTarget {
    /// Pose of the target in the world.
    pub(super) world_from_target: Pose,
    /// Height before and after a press, in metres.
    pub(super) hover_height: f32,
    /// Height at the end of the travel, in metres; negative.
    pub(super) bottom_height: f32,
    /// Travel in metres.
    pub(super) travel: f32,
    /// Radius of the fingertip in metres.
    pub(super) tip_radius: f32,
}

impl ReachTarget {
    /// Returns the center of the fingertip (world, metres) for a point of the front and a height of the pad.
    pub(super) fn tip_position(&self, point: TargetPoint, height: f32) -> Vec3 {
        self.world_from_target * point.offset.extend(height + self.tip_radius)
    }

    /// Returns the pad of a fingertip (target frame, metres) whose center is at `tip` (world, metres).
    pub(super) fn pad_position(&self, tip: Vec3) -> Vec3 {
        self.world_from_target.inverse_transform_point(tip) - Vec3::Z * self.tip_radius
    }
}

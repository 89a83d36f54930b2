//! An arm prepared for forward kinematics.

use parry3d::math::Pose;

use super::HandPose;
use super::finger_lanes::FingerLanes;
use super::joint_rotations::JointRotations;
use super::link::Link;
use super::prepared_links::PreparedLinks;
use crate::estimate::JointAngles;

/// The links of an arm that a joint or fingertip depends on, prepared for forward kinematics of one hand.
///
/// The results are equal to the results of [`ArmModel::link_poses`](super::ArmModel::link_poses), in half the time.
#[derive(Clone, Debug)]
pub(super) struct PreparedArm {
    /// The links that are not in `fingers`.
    links: PreparedLinks,
    fingers: Option<FingerLanes>,
}

impl PreparedArm {
    /// Prepares links, of which parents come before their children.
    pub fn new(links: &[Link]) -> Self {
        let mut is_done = vec![false; links.len()];
        let fingers = FingerLanes::new(links, &mut is_done);
        Self {
            links: PreparedLinks::new(links, |index| is_done[index]),
            fingers,
        }
    }

    /// Returns `true` if four fingers are computed at once.
    #[cfg(test)]
    pub fn has_lanes(&self) -> bool {
        self.fingers.is_some()
    }

    /// Writes the poses of all joints and fingertips of the arm into `hand`.
    pub fn forward(&self, world_from_root: &Pose, angles: &JointAngles, hand: &mut HandPose) {
        let rotations = JointRotations::from_angles(angles);
        let half_angle = |angle| {
            let ([sine], [cosine]) = rotations.half_angles([angle]);
            Some((sine, cosine))
        };
        let links = &self.links;
        links.forward(world_from_root, half_angle, |joint, pose| {
            hand.set(joint, *pose);
        });
        if let Some(fingers) = &self.fingers {
            fingers.forward(&rotations, hand);
        }
    }
}

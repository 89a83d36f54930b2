//! An arm prepared for forward kinematics.

use arrayvec::ArrayVec;
use parry3d::math::{Pose, Vec3};

use super::HandPose;
use super::finger_lanes::FingerLanes;
use super::joint_rotations::JointRotations;
use super::link::{Link, MAX_LINKS, far_end};
use super::principal_axis::PrincipalAxis;
use crate::estimate::JointAngles;
use crate::hand::{Dof, Joint};

/// The links of an arm that a joint or fingertip depends on, with everything that does not depend on the angles.
///
/// The results are equal to the results of [`ArmModel::link_poses`](super::ArmModel::link_poses), in half the time.
#[derive(Clone, Debug)]
pub(super) struct PreparedArm {
    /// The links that are not in `fingers`, parents before children.
    links: Vec<PreparedLink>,
    fingers: Option<FingerLanes>,
}

#[derive(Clone, Debug)]
struct PreparedLink {
    parent: Parent,
    /// `None` if the link turns about the pivot of its parent.
    offset: Option<Vec3>,
    turn: Turn,
    joint: Option<Joint>,
    tip: Option<(Joint, f32)>,
}

/// The parent of a link among the prepared ones.
#[derive(Clone, Copy, Debug)]
enum Parent {
    Root,
    /// The one before, whose pose does not have to be read from memory.
    Previous,
    At(usize),
}

/// The rotation of a link.
#[derive(Clone, Copy, Debug)]
enum Turn {
    Fixed,
    /// About an axis of its frame, with the sense of the rotation, ±1.
    Principal(PrincipalAxis, f32, Dof),
    About(Vec3, Dof),
}

impl PreparedArm {
    /// Prepares links, of which parents come before their children.
    pub fn new(links: &[Link]) -> Self {
        let mut is_done = vec![false; links.len()];
        let mut fingers = FingerLanes::new(links, &mut is_done);
        let is_used = used_links(links);
        // The index of each link in the prepared ones.
        let mut indices = vec![None; links.len()];
        let mut prepared = Vec::new();
        for (index, link) in links.iter().enumerate() {
            if is_used[index] && !is_done[index] {
                indices[index] = Some(prepared.len());
                let parent = match link.parent.and_then(|parent| indices[parent]) {
                    None => Parent::Root,
                    Some(parent) if parent + 1 == prepared.len() => Parent::Previous,
                    Some(parent) => Parent::At(parent),
                };
                prepared.push(PreparedLink::new(link, parent));
            }
        }
        if let Some(fingers) = &mut fingers {
            fingers.palm =
                indices[fingers.palm].expect("fingers grow from a link that is not one of theirs");
        }
        Self {
            links: prepared,
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
        let mut poses = ArrayVec::<Pose, MAX_LINKS>::new();
        let mut previous = *world_from_root;
        for link in &self.links {
            let parent = match link.parent {
                Parent::Root => *world_from_root,
                Parent::Previous => previous,
                Parent::At(index) => poses[index],
            };
            let pose = link.pose(&parent, &rotations);
            previous = pose;
            if let Some(joint) = link.joint {
                hand.set(joint, pose);
            }
            if let Some((tip, length)) = link.tip {
                hand.set(tip, far_end(length, &pose));
            }
            poses.push(pose);
        }
        if let Some(fingers) = &self.fingers {
            fingers.forward(&poses[fingers.palm], &rotations, hand);
        }
    }
}

/// Returns, for each link, `true` if the pose of a joint or fingertip depends on it.
pub fn used_links(links: &[Link]) -> Vec<bool> {
    let mut is_used = vec![false; links.len()];
    for (index, link) in links.iter().enumerate().rev() {
        is_used[index] |= link.joint.is_some() || link.fingertip.is_some();
        if let Some(parent) = link.parent {
            is_used[parent] |= is_used[index];
        }
    }
    is_used
}

impl PreparedLink {
    fn new(link: &Link, parent: Parent) -> Self {
        let turn = link
            .dof
            .map(|dof| match PrincipalAxis::from_vector(link.axis) {
                Some((axis, sense)) => Turn::Principal(axis, sense, dof),
                None => Turn::About(link.axis, dof),
            });
        Self {
            parent,
            offset: Some(link.offset).filter(|offset| *offset != Vec3::ZERO),
            turn: turn.unwrap_or(Turn::Fixed),
            joint: link.joint,
            tip: link
                .fingertip
                .map(|finger| (Joint::tip(finger), link.length)),
        }
    }

    fn pose(&self, parent: &Pose, rotations: &JointRotations) -> Pose {
        let rotation = match self.turn {
            Turn::Fixed => parent.rotation,
            Turn::Principal(axis, sense, dof) => {
                let (sine, cosine) = rotations.sine_and_cosine(dof);
                axis.rotate(parent.rotation, sine * sense, cosine)
            }
            Turn::About(axis, dof) => parent.rotation * rotations.about(axis, dof),
        };
        let offset = self.offset.map(|offset| parent.rotation * offset);
        let translation = offset.map_or(parent.translation, |offset| parent.translation + offset);
        Pose::from_parts(translation, rotation)
    }
}

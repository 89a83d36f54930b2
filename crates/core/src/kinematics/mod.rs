//! Stage 3: [`Estimate`](crate::estimate::Estimate) → [`HandPose`].

mod anthropometry;
mod arm_model;
mod finger_lanes;
mod inverse;
mod joint_rotations;
mod lane_pose;
mod link;
mod link_pose;
mod measured;
mod prepared_arm;
mod prepared_links;
mod reach;

pub use anthropometry::BoneLengths;
pub(crate) use anthropometry::FOREARM_PER_HAND;
pub use arm_model::{ArmModel, ArmModelError};
pub use inverse::{IkSolution, IkVariable, MAX_IK_VARIABLES, angles_from_variables, solve_ik};
pub use joint_rotations::sin_cos;
pub use lane_pose::{LanePose, rotated};
pub use link::{Link, MAX_LINKS};
pub use prepared_links::PreparedLinks;
pub use reach::{HandReach, half_bent_fingers, typing_angle};

use parry3d::math::{Pose, Vec3};

use crate::hand::{BodyPoints, Finger, FingerSet, Joint, JointPositions, Side};
use crate::time::Timestamp;

/// The place of an open hand that was held still at the start (world, metres); `None` until then.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartPlace {
    /// The index fingertip of the hand itself.
    pub own: Option<Vec3>,
    /// The index fingertip of the hand that was placed first, for what either hand uses.
    pub shared: Option<Vec3>,
    /// The index knuckle of the hand itself.
    pub knuckle: Option<Vec3>,
    /// The wrist of the hand itself.
    pub wrist: Option<Vec3>,
}

impl StartPlace {
    /// Returns the place of a hand that is held still in a pose, as if it was placed first.
    pub fn from_pose(pose: &HandPose) -> Self {
        let tip = pose.fingertip(Finger::Index);
        Self {
            own: tip,
            shared: tip,
            knuckle: pose.position(Joint::IndexPhalanxProximal),
            wrist: pose.position(Joint::Wrist),
        }
    }
}

/// The poses of the joints of one arm and hand at one time, in the world.
#[derive(Clone, Copy, Debug)]
pub struct HandPose {
    /// The time stamp of the reading.
    pub time: Timestamp,
    /// The side of the body.
    pub side: Side,
    /// Fingers with a sensor fault. They press nothing.
    pub untrusted: FingerSet,
    /// `true` if the hand was re-acquired at another position. The movement in between was not seen.
    pub jumped: bool,
    /// `true` if readings are missing since the earlier pose, or a part of the arm was not seen, so that the path in between is not known.
    /// A fingertip enters no target on it.
    pub is_after_gap: bool,
    /// `true` if readings of the fingers are missing since the earlier pose, so that it is not known how they have bent. Implies
    /// `is_after_gap`.
    pub misses_bends: bool,
    /// The radius of the fingertip spheres, in metres.
    pub tip_radius: f32,
    /// The place of the hand at the start, which a new reading keeps.
    pub start: StartPlace,
    /// The position of the wrist of the other hand (world, metres), if one source measures both in one frame. A new reading keeps it.
    pub other_wrist: Option<Vec3>,
    /// The points of the body that are measured together with the hand, if the layout follows any. A new reading keeps them.
    pub body: BodyPoints,
    joints: [Pose; Joint::COUNT],
    known: u32,
}

impl HandPose {
    /// Creates a pose without known joints.
    pub fn new(time: Timestamp, side: Side, tip_radius: f32) -> Self {
        Self {
            time,
            side,
            untrusted: FingerSet::NONE,
            jumped: false,
            is_after_gap: false,
            misses_bends: false,
            tip_radius,
            start: StartPlace::default(),
            other_wrist: None,
            body: BodyPoints::default(),
            joints: [Pose::IDENTITY; Joint::COUNT],
            known: 0,
        }
    }

    /// Prepares for the next reading: no joint is known. Cheaper than a new pose.
    fn reset(&mut self, time: Timestamp, side: Side, tip_radius: f32) {
        self.time = time;
        self.side = side;
        self.untrusted = FingerSet::NONE;
        self.jumped = false;
        self.is_after_gap = false;
        self.misses_bends = false;
        self.tip_radius = tip_radius;
        self.known = 0;
    }

    /// Returns `true` if presses since the earlier pose may have been missed: of targets that fingertips enter, or of targets that fingers
    /// press by bending, which do not depend on the arm.
    pub fn may_hide_presses(&self, by_bending: bool) -> bool {
        if by_bending {
            self.misses_bends
        } else {
            self.is_after_gap
        }
    }

    /// Sets `world_from_joint` (metres).
    pub fn set(&mut self, joint: Joint, world_from_joint: Pose) {
        self.joints[joint.index()] = world_from_joint;
        self.known |= 1 << joint.index();
    }

    /// Returns `world_from_joint` (metres), or `None` if the arm model does not have the joint.
    pub fn get(&self, joint: Joint) -> Option<&Pose> {
        (self.known & (1 << joint.index()) != 0).then(|| &self.joints[joint.index()])
    }

    /// Returns the position of a joint in the world (metres), or `None` if the arm model does not have the joint.
    pub fn position(&self, joint: Joint) -> Option<Vec3> {
        self.get(joint).map(|pose| pose.translation)
    }

    /// Returns the center of a fingertip sphere in the world (metres), or `None` if the arm model does not have the
    /// finger.
    pub fn fingertip(&self, finger: Finger) -> Option<Vec3> {
        self.position(Joint::tip(finger))
    }

    /// Returns the positions of the known joints in the world, in metres.
    pub fn positions(&self) -> JointPositions {
        let mut positions = JointPositions::default();
        for (joint, pose) in self.known() {
            positions.set(joint, pose.translation.as_dvec3());
        }
        positions
    }

    /// Iterates over the known joints, in the order of [`Joint::ALL`].
    pub fn known(&self) -> impl Iterator<Item = (Joint, &Pose)> + '_ {
        Joint::ALL
            .iter()
            .filter_map(|&joint| Some((joint, self.get(joint)?)))
    }
}

#[cfg(test)]
mod tests;

//! 3 · [`JointAngles`](crate::estimate::JointAngles) → [`HandPose`].

mod anthropometry;
mod arm_model;
mod inverse;
mod joint_rotations;

pub use anthropometry::BoneLengths;
pub use arm_model::{ArmModel, ArmModelError, Link, MAX_LINKS};
pub use inverse::{IkSolution, IkVariable, MAX_IK_VARIABLES, angles_from_variables, solve_ik};

use parry3d::math::{Pose, Vec3};

use crate::hand::{Finger, FingerSet, Joint, Side};
use crate::time::Timestamp;

/// Where an arm and hand are in space at one moment.
#[derive(Clone, Copy, Debug)]
pub struct HandPose {
    /// When the reading behind it was complete.
    pub time: Timestamp,
    /// Which hand.
    pub side: Side,
    /// Fingers that cannot be believed at the moment: they press nothing.
    pub untrusted: FingerSet,
    /// Whether the hand was re-acquired in another place: what lies between was not seen.
    pub jumped: bool,
    /// Radius of the fingertip spheres, in metres.
    pub tip_radius: f32,
    joints: [Pose; Joint::COUNT],
    known: u32,
}

impl HandPose {
    /// A pose in which no joint is known yet.
    pub fn new(time: Timestamp, side: Side, tip_radius: f32) -> Self {
        Self {
            time,
            side,
            untrusted: FingerSet::NONE,
            jumped: false,
            tip_radius,
            joints: [Pose::IDENTITY; Joint::COUNT],
            known: 0,
        }
    }

    /// Sets `world_from_joint` (metres).
    pub fn set(&mut self, joint: Joint, world_from_joint: Pose) {
        self.joints[joint.index()] = world_from_joint;
        self.known |= 1 << joint.index();
    }

    /// `world_from_joint` (metres), or `None` where the arm model does not have the joint.
    pub fn get(&self, joint: Joint) -> Option<&Pose> {
        (self.known & (1 << joint.index()) != 0).then(|| &self.joints[joint.index()])
    }

    /// The joint's position in the world (metres), where the arm model has it.
    pub fn position(&self, joint: Joint) -> Option<Vec3> {
        self.get(joint).map(|pose| pose.translation)
    }

    /// The centre of the fingertip sphere in the world (metres), where the arm model has the finger.
    pub fn fingertip(&self, finger: Finger) -> Option<Vec3> {
        self.position(Joint::tip(finger))
    }

    /// The known joints, in the order of [`Joint::ALL`].
    pub fn known(&self) -> impl Iterator<Item = (Joint, &Pose)> + '_ {
        Joint::ALL
            .iter()
            .filter_map(|&joint| Some((joint, self.get(joint)?)))
    }
}

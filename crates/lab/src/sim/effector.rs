//! The fingertips that a simulated hand points with, and the joints that move them.

use super::typing_hand::REACH_TOLERANCE;
use crate::hand::{Dof, Finger};

/// A fingertip that goes to a target, and the joints that move it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Effector {
    /// The finger.
    pub(super) finger: Finger,
    /// The joints.
    pub(super) limb: Limb,
}

/// The joints that move a fingertip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Limb {
    /// Elbow, wrist and finger.
    Arm,
    /// Wrist and finger: a board at the wrist moves with the elbow.
    Hand,
    /// The finger alone.
    Finger,
}

impl Limb {
    /// Returns the largest error of inverse kinematics, in metres. A point with a larger error is out of reach. A fingertip on a
    /// board at the wrist cannot go to the center of every key.
    pub(super) fn tolerance(self) -> f64 {
        match self {
            Self::Arm => REACH_TOLERANCE,
            Self::Hand | Self::Finger => 0.01,
        }
    }
}

/// Angles of the arm that move every fingertip.
const ARM: [Dof; 3] = [Dof::ElbowFlexion, Dof::WristFlexion, Dof::WristDeviation];

impl Effector {
    /// The index finger, with the whole arm.
    pub(super) const INDEX: Self = Self {
        finger: Finger::Index,
        limb: Limb::Arm,
    };

    /// Returns `true` if the finger is half flexed before it goes to a key with the arm, as the index finger is at rest.
    pub(super) fn flexes(self) -> bool {
        let is_long = matches!(self.finger, Finger::Middle | Finger::Ring | Finger::Little);
        is_long && self.limb == Limb::Arm
    }

    /// Returns `true` if an angle moves the fingertip on purpose. The index finger with the whole arm does not move sideways.
    pub(super) fn uses(self, dof: Dof) -> bool {
        if self == Self::INDEX && dof == Dof::IndexMcpAbduction {
            return false;
        }
        match self.limb {
            _ if dof.finger() == Some(self.finger) => true,
            Limb::Arm => ARM.contains(&dof),
            Limb::Hand => dof != Dof::ElbowFlexion && ARM.contains(&dof),
            Limb::Finger => false,
        }
    }
}

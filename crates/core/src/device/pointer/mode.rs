//! Pointing modes: the relation between a hand and the position of the cursor.

use parry3d::math::Vec3;

use super::anchored_frame::AnchoredFrame;
use super::posture::HandPosture;
use super::trusted_hand::TrustedHand;

pub use super::direct::DirectPointing;
pub use super::joint::{AngleMapping, JointPointing};
pub use super::posture::HandPoint;
pub use super::rate::{Displacement, RateControl};
pub use super::ray::{RayOrigin, RayPointing};

/// The relation between a hand and the position of the cursor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointingMode {
    /// Three joint angles are the position.
    Joint(JointPointing),
    /// The position of a point of the hand in a box is the position.
    Direct(DirectPointing),
    /// The intersection of a ray from the hand with a rectangle is the position.
    Ray(RayPointing),
    /// The displacement from a rest pose is the velocity.
    Rate(RateControl),
    /// The motion of the hand drives [axes](super::ArmAxes) instead of the cursor.
    Arm(HandPoint),
}

/// The output of a pointing mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aim {
    /// A position as fractions 0..=1 of the whole range: to the right, up, towards the wearer.
    Position(Vec3),
    /// A velocity in pixels per second: to the right, up.
    Velocity(Vec3),
    /// A posture, which does not move the cursor.
    Posture(HandPosture),
}

impl Aim {
    /// Returns `true` if a position is not at a border, where one that is outside would be too.
    pub(super) fn is_in_range(self) -> bool {
        let is_inside = |fraction: f32| 0.0 < fraction && fraction < 1.0;
        match self {
            Self::Position(position) => is_inside(position.x) && is_inside(position.y),
            Self::Velocity(_) | Self::Posture(_) => true,
        }
    }
}

impl PointingMode {
    /// Returns `None` if the hand points nowhere, or if the measurements it needs are unknown.
    pub(super) fn aim(&self, hand: &TrustedHand) -> Option<Aim> {
        match self {
            Self::Joint(joint) => joint.fractions(hand).map(Aim::Position),
            Self::Direct(direct) => direct.fractions(hand).map(Aim::Position),
            Self::Ray(ray) => ray.fractions(hand).map(Aim::Position),
            Self::Rate(rate) => rate.velocity(hand).map(Aim::Velocity),
            Self::Arm(point) => point.posture(hand).map(Aim::Posture),
        }
    }

    /// Returns `true` if the cursor moves only after a velocity of 0: a broken stick can be at an end of its range.
    pub fn starts_at_rest(&self) -> bool {
        matches!(self, Self::Rate(rate) if rate.displacement == Displacement::Stick)
    }

    /// Returns the frame of the box, rectangle or rest position; `None` for a mode that depends on angles or postures only.
    pub fn frame(&self) -> Option<&AnchoredFrame> {
        match self {
            Self::Joint(_) | Self::Arm(_) => None,
            Self::Direct(DirectPointing { frame, .. }) | Self::Ray(RayPointing { frame, .. }) => {
                Some(frame)
            }
            Self::Rate(rate) => rate.frame(),
        }
    }

    /// Returns the direction of a push, away from the wearer, in the world.
    pub(super) fn forward(&self) -> Vec3 {
        self.frame().map_or(Vec3::NEG_Z, AnchoredFrame::forward)
    }
}

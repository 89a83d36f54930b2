//! How a hand says where to point.

use parry3d::math::Vec3;

use super::anchored_frame::AnchoredFrame;
use super::trusted_hand::Sight;

pub use super::direct::DirectPointing;
pub use super::joint::{AngleMapping, JointPointing};
pub use super::rate::{Displacement, RateControl};
pub use super::ray::{RayOrigin, RayPointing};

/// How a hand says where to point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointingMode {
    /// By three angles.
    Joint(JointPointing),
    /// By where the index fingertip is.
    Direct(DirectPointing),
    /// By where a ray from the hand meets a plane.
    Ray(RayPointing),
    /// By how far it is from a pose of rest: that is how fast the pointer goes.
    Rate(RateControl),
}

/// What a mode makes of a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aim {
    /// A place: shares of the whole range, 0..=1, to the right, up, and towards the wearer.
    At(Vec3),
    /// A speed in pixels a second, to the right and up.
    Goes(Vec3),
}

impl PointingMode {
    /// `None` when it is not known, or the hand points nowhere.
    pub(super) fn aim(&self, sight: &Sight) -> Option<Aim> {
        match self {
            Self::Joint(joints) => joints.shares(sight).map(Aim::At),
            Self::Direct(direct) => direct.shares(sight).map(Aim::At),
            Self::Ray(ray) => ray.shares(sight).map(Aim::At),
            Self::Rate(rate) => rate.speed(sight).map(Aim::Goes),
        }
    }

    /// The way away from the wearer in which a fingertip pushes, in the world.
    pub(super) fn forward(&self) -> Vec3 {
        match self {
            Self::Joint(_) => Vec3::NEG_Z,
            Self::Direct(DirectPointing { frame, .. }) | Self::Ray(RayPointing { frame, .. }) => {
                frame.forward()
            }
            Self::Rate(rate) => rate.frame().map_or(Vec3::NEG_Z, AnchoredFrame::forward),
        }
    }
}

//! How a hand says where to point.

use parry3d::math::Vec3;

use super::frame::Frame;
use super::sight::Sight;

pub use super::direct::Direct;
pub use super::joint::{Axis, Joints};
pub use super::rate::{Displacement, Rate};
pub use super::ray::{From, Ray};

/// How a hand says where to point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// By three angles.
    Joint(Joints),
    /// By where the index fingertip is.
    Direct(Direct),
    /// By where a ray from the hand meets a plane.
    Ray(Ray),
    /// By how far it is from a pose of rest: that is how fast the pointer goes.
    Rate(Rate),
}

/// What a mode makes of a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aim {
    /// A place: shares of the whole range, 0..=1, to the right, up, and towards the wearer.
    At(Vec3),
    /// A speed in pixels a second, to the right and up.
    Goes(Vec3),
}

impl Mode {
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
            Self::Direct(Direct { frame, .. }) | Self::Ray(Ray { frame, .. }) => frame.forward(),
            Self::Rate(rate) => rate.frame().map_or(Vec3::NEG_Z, Frame::forward),
        }
    }
}

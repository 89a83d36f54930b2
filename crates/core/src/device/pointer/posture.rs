//! The posture of a hand as a rigid body: the position of a point of it, and its rotation.

use glam::{Mat3, Quat};
use parry3d::math::Vec3;

use super::trusted_hand::TrustedHand;
use crate::hand::{Finger, Joint, Side};
use crate::kinematics::HandPose;

/// A point of the hand that a pointer follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandPoint {
    /// The index fingertip, for arms that the wrist and the fingers move.
    Index,
    /// The index knuckle, which pinching fingers do not move.
    Knuckle,
    /// The wrist, for arms that are tracked as a whole.
    Wrist,
}

/// The posture of a hand.
///
/// The frame of the hand has +X across the palm to the right, +Y out of the back of the hand and −Z towards the fingers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HandPosture {
    /// The wrist in the world, in metres.
    wrist: Vec3,
    world_from_hand: Quat,
    /// The point in the frame of the hand, in metres.
    point: Vec3,
}

/// The motion from one posture to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HandMotion {
    /// The displacement of the point in the world, without the part that comes from the rotation of the hand, in metres.
    pub(super) displacement: Vec3,
    /// The rotation vector in the frame of the first posture, in radians.
    pub(super) rotation: Vec3,
}

impl HandPoint {
    /// Returns the joint at the point.
    pub const fn joint(self) -> Joint {
        match self {
            Self::Index => Joint::IndexTip,
            Self::Knuckle => Joint::IndexPhalanxProximal,
            Self::Wrist => Joint::Wrist,
        }
    }

    /// Returns the position in the world, in metres; `None` if it is unknown, not finite, or untrusted.
    pub(super) fn position(self, hand: &TrustedHand) -> Option<Vec3> {
        match self {
            Self::Index => hand.tip(Finger::Index),
            Self::Knuckle | Self::Wrist => hand.joint(self.joint()),
        }
    }

    /// Returns the posture of a hand, or `None` if a joint that it needs is unknown.
    pub(super) fn posture(self, hand: &TrustedHand) -> Option<HandPosture> {
        let pose = hand.pose();
        let wrist = pose.position(Joint::Wrist)?;
        let world_from_hand = palm_rotation(pose, wrist)?;
        let point = match self {
            Self::Wrist => Vec3::ZERO,
            Self::Index | Self::Knuckle => {
                world_from_hand.inverse() * (self.position(hand)? - wrist)
            }
        };
        let posture = HandPosture {
            wrist,
            world_from_hand,
            point,
        };
        (wrist.is_finite() && world_from_hand.is_finite() && point.is_finite()).then_some(posture)
    }
}

impl HandPosture {
    /// Returns the motion from `start` to this posture.
    pub(super) fn motion_since(&self, start: &Self) -> HandMotion {
        let of_point = start.world_from_hand * (self.point - start.point);
        let turn = start.world_from_hand.inverse() * self.world_from_hand;
        // The shorter way round.
        let turn = if turn.w < 0.0 { -turn } else { turn };
        HandMotion {
            displacement: self.wrist - start.wrist + of_point,
            rotation: turn.to_scaled_axis(),
        }
    }
}

/// Returns the rotation of the palm, which the wrist and the knuckles of index and little finger span.
fn palm_rotation(pose: &HandPose, wrist: Vec3) -> Option<Quat> {
    let index = pose.position(Joint::IndexPhalanxProximal)?;
    let little = pose.position(Joint::LittlePhalanxProximal)?;
    let across = match pose.side {
        Side::Right => little - index,
        Side::Left => index - little,
    };
    let back = (wrist - index.midpoint(little)).try_normalize()?;
    let up = back.cross(across).try_normalize()?;
    let right = up.cross(back);
    Some(Quat::from_mat3(&Mat3::from_cols(right, up, back)))
}

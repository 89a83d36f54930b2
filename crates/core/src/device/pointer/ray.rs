//! Ray pointing: the intersection of a ray from the hand with a rectangle.

use parry3d::math::{Vec2, Vec3};

use super::anchored_frame::AnchoredFrame;
use super::trusted_hand::TrustedHand;
use crate::hand::{Finger, Joint};

/// Minimum cosine between the ray and the normal of the rectangle. At 85° and more, hand tremor would move
/// the intersection across the whole rectangle, so the hand points nowhere.
const MIN_COSINE: f32 = 0.087;

/// A rectangle in space that the hand points at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayPointing {
    /// The origin of the ray.
    pub from: RayOrigin,
    /// The center of the rectangle. Its front faces +Z.
    pub frame: AnchoredFrame,
    /// Width and height, in metres; each more than 0.
    pub size: Vec2,
}

/// The origin and direction of a pointing ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayOrigin {
    /// The index knuckle, away from the wrist.
    Hand,
    /// The index fingertip, away from the index knuckle.
    Index,
}

impl RayPointing {
    /// Returns the intersection, 0..=1 on each axis, with 0.5 for the depth; a ray that misses the rectangle
    /// meets its border. `None` if the hand points away from the plane or along it, or is behind it.
    pub(super) fn fractions(&self, hand: &TrustedHand) -> Option<Vec3> {
        let pose = hand.pose();
        let knuckle = pose.position(Joint::IndexPhalanxProximal)?;
        let (behind, origin) = match self.from {
            RayOrigin::Hand => (pose.position(Joint::Wrist)?, knuckle),
            RayOrigin::Index => (knuckle, hand.tip(Finger::Index)?),
        };
        let behind = self.frame.to_local(pose, behind)?;
        let origin = self.frame.to_local(pose, origin)?;
        let direction = (origin - behind).try_normalize()?;
        if origin.z < 0.0 || -direction.z < MIN_COSINE {
            return None;
        }
        let intersection = origin + direction * (origin.z / -direction.z);
        let fractions = intersection.truncate() / self.size + 0.5;
        Some(fractions.clamp(Vec2::ZERO, Vec2::ONE).extend(0.5))
    }
}

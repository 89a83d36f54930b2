//! A ray from the hand through a plane.

use parry3d::math::{Vec2, Vec3};

use super::anchored_frame::AnchoredFrame;
use super::trusted_hand::Sight;
use crate::hand::{Finger, Joint};

/// The least cosine between the ray and the plane's normal: at 85° and beyond a tremble of the hand goes
/// over the whole plane, so the hand points nowhere.
const LEAST_COSINE: f32 = 0.087;

/// A rectangle in space that the hand points at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayPointing {
    /// What the ray comes from.
    pub from: RayOrigin,
    /// The middle of the rectangle; its front looks along +Z.
    pub frame: AnchoredFrame,
    /// Its width and height, in metres; each more than 0.
    pub size: Vec2,
}

/// What a ray comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayOrigin {
    /// The index knuckle, away from the wrist.
    Hand,
    /// The index fingertip, away from its knuckle.
    Index,
}

impl RayPointing {
    /// Where on the rectangle, 0..=1 on each axis, half way in depth; a ray that passes it by is on its
    /// border. `None` when the hand points away from the plane or along it, or is behind it.
    pub(super) fn shares(&self, sight: &Sight) -> Option<Vec3> {
        let pose = sight.pose();
        let knuckle = pose.position(Joint::IndexPhalanxProximal)?;
        let (behind, origin) = match self.from {
            RayOrigin::Hand => (pose.position(Joint::Wrist)?, knuckle),
            RayOrigin::Index => (knuckle, sight.tip(Finger::Index)?),
        };
        let behind = self.frame.to_local(pose, behind)?;
        let origin = self.frame.to_local(pose, origin)?;
        let direction = (origin - behind).try_normalize()?;
        if origin.z < 0.0 || -direction.z < LEAST_COSINE {
            return None;
        }
        let met = origin + direction * (origin.z / -direction.z);
        let shares = met.truncate() / self.size + 0.5;
        Some(shares.clamp(Vec2::ZERO, Vec2::ONE).extend(0.5))
    }
}

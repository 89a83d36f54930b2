//! The index fingertip in a box.

use parry3d::math::Vec3;

use super::anchored_frame::AnchoredFrame;
use super::trusted_hand::Sight;
use crate::hand::Finger;

/// A box that the index fingertip moves in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectPointing {
    /// Its middle.
    pub frame: AnchoredFrame,
    /// Its width, height and depth, in metres; each more than 0.
    pub size: Vec3,
}

impl DirectPointing {
    /// Where in the box, 0..=1 on each axis; a fingertip outside is on its border.
    pub(super) fn shares(&self, sight: &Sight) -> Option<Vec3> {
        let tip = self
            .frame
            .to_local(sight.pose(), sight.tip(Finger::Index)?)?;
        Some((tip / self.size + 0.5).clamp(Vec3::ZERO, Vec3::ONE))
    }
}

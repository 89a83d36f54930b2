//! Direct pointing: the position of the index fingertip in a box.

use parry3d::math::Vec3;

use super::anchored_frame::AnchoredFrame;
use super::trusted_hand::TrustedHand;
use crate::hand::Finger;

/// A box in which the index fingertip moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectPointing {
    /// The center.
    pub frame: AnchoredFrame,
    /// Width, height and depth, in metres; each more than 0.
    pub size: Vec3,
}

impl DirectPointing {
    /// Returns the position in the box, 0..=1 on each axis; a fingertip outside is clamped to the border.
    pub(super) fn fractions(&self, hand: &TrustedHand) -> Option<Vec3> {
        let tip = self.frame.to_local(hand.pose(), hand.tip(Finger::Index)?)?;
        Some((tip / self.size + 0.5).clamp(Vec3::ZERO, Vec3::ONE))
    }
}

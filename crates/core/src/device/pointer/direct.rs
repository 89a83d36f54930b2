//! Direct pointing: the position of a point of the hand in a box.

use parry3d::math::Vec3;

use super::anchored_frame::AnchoredFrame;
use super::posture::HandPoint;
use super::trusted_hand::TrustedHand;

/// A box in which a point of the hand moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectPointing {
    /// The point.
    pub point: HandPoint,
    /// The center.
    pub frame: AnchoredFrame,
    /// Width, height and depth, in metres; each more than 0.
    pub size: Vec3,
}

impl DirectPointing {
    /// Returns the position in the box, 0..=1 on each axis; a point outside is clamped to the border.
    pub(super) fn fractions(&self, hand: &TrustedHand) -> Option<Vec3> {
        let point = self
            .frame
            .to_local(hand.pose(), self.point.position(hand)?)?;
        Some((point / self.size + 0.5).clamp(Vec3::ZERO, Vec3::ONE))
    }
}

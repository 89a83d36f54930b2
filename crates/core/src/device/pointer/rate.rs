//! Rate control: the displacement of the hand from a rest pose is the velocity of the pointer.

use parry3d::math::{Vec2, Vec3};

use super::anchored_frame::AnchoredFrame;
use super::joint::AngleMapping;
use super::trusted_hand::TrustedHand;
use crate::hand::{Finger, Input};

/// The relation between displacement and velocity.
///
/// The speed is max_speed · ((d − dead_zone) / (1 − dead_zone))^curve in the direction of the displacement,
/// whose length d is a fraction of the full displacement, 1 at most. It is 0 in the dead zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateControl {
    /// The displacement.
    pub displacement: Displacement,
    /// Radius of the dead zone, as a fraction of the full displacement: 0..1.
    pub dead_zone: f32,
    /// The speed at full displacement, in pixels per second.
    pub max_speed_px_s: f32,
    /// Exponent, more than 0. More than 1 makes small displacements slower.
    pub curve: f32,
}

/// The quantity that is displaced from its rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Displacement {
    /// The index fingertip: its rest position, and the full displacement in metres, more than 0.
    Fingertip(AnchoredFrame, f32),
    /// Two angles, to the right and up, from the middle of their ranges to the ends. Their own curves apply
    /// as well.
    Angles(AngleMapping, AngleMapping),
    /// The stick of the glove. It moves the pointer after it was seen at rest.
    Stick,
}

impl RateControl {
    /// Returns the velocity in pixels per second, to the right and up.
    pub(super) fn velocity(&self, hand: &TrustedHand) -> Option<Vec3> {
        let displacement = match &self.displacement {
            Displacement::Fingertip(frame, full) => {
                let tip = frame.to_local(hand.pose(), hand.tip(Finger::Index)?)?;
                tip.truncate() / full
            }
            Displacement::Angles(x, y) => Vec2::new(x.deflection(hand)?, y.deflection(hand)?),
            Displacement::Stick => {
                Vec2::new(hand.input(Input::StickX)?, hand.input(Input::StickY)?)
            }
        };
        let displacement = displacement.clamp_length_max(1.0);
        let t = (displacement.length() - self.dead_zone) / (1.0 - self.dead_zone);
        if t <= 0.0 {
            return Some(Vec3::ZERO);
        }
        let speed = self.max_speed_px_s * t.powf(self.curve);
        Some((displacement.normalize_or_zero() * speed).extend(0.0))
    }

    /// Returns the frame of the displacement, if it is a displacement in space.
    pub(super) fn frame(&self) -> Option<&AnchoredFrame> {
        match &self.displacement {
            Displacement::Fingertip(frame, _) => Some(frame),
            Displacement::Angles(..) | Displacement::Stick => None,
        }
    }
}

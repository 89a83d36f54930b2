//! Joint pointing: three angles as three coordinates, as in the glove that this project comes from.

use parry3d::math::Vec3;

use super::trusted_hand::TrustedHand;
use crate::hand::Dof;

/// One angle per coordinate of the position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPointing {
    /// The angle that moves it to the right.
    pub x: AngleMapping,
    /// The angle that moves it up.
    pub y: AngleMapping,
    /// The angle that moves it towards the wearer; `None` for a constant 0.5.
    pub z: Option<AngleMapping>,
}

/// The mapping from an angle to a coordinate.
///
/// The coordinate is ½ + ½ · sign(d) · |d|^curve with d = clamp(2 · (angle − from) / (to − from) − 1, −1, 1).
/// For a curve of 1 this is the linear clamp((angle − from) / (to − from), 0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleMapping {
    /// The angle.
    pub dof: Dof,
    /// The angle for 0, in radians.
    pub from: f32,
    /// The angle for 1, in radians; not equal to `from`. Less than `from` inverts the direction.
    pub to: f32,
    /// The size of the range in a selection space, in metres; 0.5 is its origin.
    pub extent: f32,
    /// Exponent, more than 0. More than 1 is finer in the middle and coarser at the ends.
    pub curve: f32,
}

impl AngleMapping {
    /// Returns the deflection from the middle of the range, −1..=1.
    pub(super) fn deflection(&self, hand: &TrustedHand) -> Option<f32> {
        let t = (hand.angle(self.dof)? - self.from) / (self.to - self.from);
        let deflection = (2.0 * t - 1.0).clamp(-1.0, 1.0);
        Some(deflection.abs().powf(self.curve).copysign(deflection))
    }

    fn fraction(&self, hand: &TrustedHand) -> Option<f32> {
        Some(0.5 + 0.5 * self.deflection(hand)?)
    }
}

impl JointPointing {
    /// Returns the position, 0..=1 on each axis.
    pub(super) fn fractions(&self, hand: &TrustedHand) -> Option<Vec3> {
        let z = match &self.z {
            Some(mapping) => mapping.fraction(hand)?,
            None => 0.5,
        };
        Some(Vec3::new(self.x.fraction(hand)?, self.y.fraction(hand)?, z))
    }

    /// Returns the point in a selection space, in metres, for a position 0..=1 on each axis.
    pub(super) fn point(&self, fractions: Vec3) -> Vec3 {
        let depth = self.z.map_or(0.0, |mapping| mapping.extent);
        (fractions - 0.5) * Vec3::new(self.x.extent, self.y.extent, depth)
    }
}

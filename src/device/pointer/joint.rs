//! Three angles as three displacements: the pointer of the glove that this project comes from.

use parry3d::math::Vec3;

use super::trusted_hand::Sight;
use crate::hand::Dof;

/// An angle for each axis of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPointing {
    /// To the right.
    pub x: AngleMapping,
    /// Up.
    pub y: AngleMapping,
    /// Towards the wearer; without it the place is half way.
    pub z: Option<AngleMapping>,
}

/// An angle that is a displacement.
///
/// share = ½ + ½ · sign(d) · |d|^curve with d = clamp(2 · (angle − from) / (to − from) − 1, −1, 1);
/// with a curve of 1 that is the line clamp((angle − from) / (to − from), 0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleMapping {
    /// The angle.
    pub dof: Dof,
    /// Where the displacement begins, in radians.
    pub from: f32,
    /// Where it ends, in radians; not the same as `from`, less turns it round.
    pub to: f32,
    /// How far that is in a space, in metres, its middle at 0.
    pub extent: f32,
    /// More than 1 makes the middle finer and the ends coarser; more than 0.
    pub curve: f32,
}

impl AngleMapping {
    /// How far from the middle of the range, −1..=1.
    pub(super) fn deflection(&self, sight: &Sight) -> Option<f32> {
        let share = (sight.angle(self.dof)? - self.from) / (self.to - self.from);
        let deflection = (2.0 * share - 1.0).clamp(-1.0, 1.0);
        Some(deflection.abs().powf(self.curve).copysign(deflection))
    }

    fn share(&self, sight: &Sight) -> Option<f32> {
        Some(0.5 + 0.5 * self.deflection(sight)?)
    }
}

impl JointPointing {
    /// The place, 0..=1 on each axis.
    pub(super) fn shares(&self, sight: &Sight) -> Option<Vec3> {
        let z = match &self.z {
            Some(axis) => axis.share(sight)?,
            None => 0.5,
        };
        Some(Vec3::new(self.x.share(sight)?, self.y.share(sight)?, z))
    }

    /// Where shares are in a space, in metres.
    pub(super) fn point(&self, shares: Vec3) -> Vec3 {
        let depth = self.z.map_or(0.0, |axis| axis.extent);
        (shares - 0.5) * Vec3::new(self.x.extent, self.y.extent, depth)
    }
}

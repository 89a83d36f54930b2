//! The frames in which the attributes of an arm are measured.
//!
//! The axes are the columns of a matrix, orthonormal and right-handed: `basis · v` takes coordinates to the image frame,
//! and `basisᵀ · v` takes a vector of the image frame to coordinates.

use glam::{DMat3, DVec3};

use super::{ArmAttributesError, ArmLandmarks, Trunk};
use crate::geometry::unit;
use crate::hand::Side;

/// The smallest sine between two vectors that span a plane.
const MIN_SINE: f64 = 1e-6;

/// The smallest length, as a fraction of the size of the trunk, that has a direction.
pub(super) const MIN_RELATIVE_LENGTH: f64 = 1e-9;

/// Returns the sign of a side in the formulas: 1 for the left, −1 for the right.
pub(super) const fn sign(side: Side) -> f64 {
    match side {
        Side::Left => 1.0,
        Side::Right => -1.0,
    }
}

/// Returns `first` × `second` for the left side and `second` × `first` for the right.
pub(super) fn sided_cross(side: Side, first: DVec3, second: DVec3) -> DVec3 {
    first.cross(second) * sign(side)
}

/// Returns the basis of a shoulder: outwards along the line of the shoulders, down to the hips, and backwards for the
/// left arm or forwards for the right arm.
pub fn shoulder_basis(trunk: &Trunk, side: Side) -> Result<DMat3, ArmAttributesError> {
    if !trunk.is_finite() {
        return Err(ArmAttributesError::NotFinite);
    }
    let shoulder = trunk.shoulders[side.index()];
    let across = shoulder - trunk.shoulders[side.opposite().index()];
    let down = trunk.hips[side.index()] - shoulder;
    let smallest = MIN_RELATIVE_LENGTH * trunk.extent();
    if across.length() <= smallest || down.length() <= smallest {
        return Err(ArmAttributesError::NoTrunk);
    }
    let outwards = unit(across).ok_or(ArmAttributesError::NoTrunk)?;
    let third = plane_normal(outwards, down).ok_or(ArmAttributesError::NoTrunk)?;
    Ok(DMat3::from_cols(outwards, third.cross(outwards), third))
}

/// Returns the basis of a hand: out of the palm, towards the little finger (left) or the thumb (right), and from the
/// wrist to the middle of the palm.
pub fn hand_basis(arm: &ArmLandmarks, side: Side) -> Result<DMat3, ArmAttributesError> {
    if !arm.is_finite() {
        return Err(ArmAttributesError::NotFinite);
    }
    let (little, index) = (arm.little - arm.wrist, arm.index - arm.wrist);
    let normal = plane_normal(little, index).ok_or(ArmAttributesError::NoHand)?;
    let palm = normal * sign(side);
    let forwards = unit((little + index) / 2.0).ok_or(ArmAttributesError::NoHand)?;
    Ok(DMat3::from_cols(palm, forwards.cross(palm), forwards))
}

/// Returns the direction of `first` × `second`; `None` if they are parallel or one is zero.
fn plane_normal(first: DVec3, second: DVec3) -> Option<DVec3> {
    let normal = unit(first)?.cross(unit(second)?);
    (normal.length() >= MIN_SINE).then(|| normal.normalize())
}

//! Samples of joint angles.

use crate::estimate::{JointLimits, Rejection};
use crate::hand::JointAngles;

/// Adds `offsets` to the angles of a sample and clamps them to the joint limits; `None` accepts every finite angle.
///
/// A sample without angles is rejected.
pub(super) fn convert(
    sample: &JointAngles,
    limits: Option<&JointLimits>,
    offsets: &JointAngles,
    angles: &mut JointAngles,
) -> Result<(), Rejection> {
    if sample.is_empty() {
        return Err(Rejection::WrongShape);
    }
    for (dof, radians) in sample.known() {
        if !radians.is_finite() {
            return Err(Rejection::NotFinite);
        }
        let radians = radians + offsets.get(dof);
        let clamped = match limits {
            Some(limits) => limits.checked_clamp(dof, radians),
            None => Some(radians),
        };
        angles.set(dof, clamped.ok_or(Rejection::OutsideLimits)?);
    }
    Ok(())
}

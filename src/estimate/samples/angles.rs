//! Samples of joint angles.

use crate::estimate::{JointLimits, Rejection};
use crate::hand::JointAngles;

/// Clamps the angles of a sample to the joint limits; `None` accepts every finite angle.
///
/// A sample without angles is rejected.
pub(super) fn convert(
    sample: &JointAngles,
    limits: Option<&JointLimits>,
    angles: &mut JointAngles,
) -> Result<(), Rejection> {
    if sample.is_empty() {
        return Err(Rejection::WrongShape);
    }
    for (dof, radians) in sample.known() {
        if !radians.is_finite() {
            return Err(Rejection::NotFinite);
        }
        let clamped = match limits {
            Some(limits) => limits.checked_clamp(dof, radians),
            None => Some(radians),
        };
        angles.set(dof, clamped.ok_or(Rejection::OutsideLimits)?);
    }
    Ok(())
}

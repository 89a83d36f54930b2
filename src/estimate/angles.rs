//! Samples of joint angles.

use super::limits::JointLimits;
use super::{JointAngles, Rejection};

/// Checks the angles of a sample and clamps them to the joint limits; `None` accepts every finite angle.
///
/// A sample without angles is rejected.
pub(super) fn convert(
    sample: &JointAngles,
    limits: Option<&JointLimits>,
) -> Result<JointAngles, Rejection> {
    if sample.is_empty() {
        return Err(Rejection::WrongShape);
    }
    let mut angles = JointAngles::default();
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
    Ok(angles)
}

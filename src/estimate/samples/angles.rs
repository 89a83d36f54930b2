//! Samples of joint angles.

use crate::estimate::{Estimate, JointLimits, Rejection};
use crate::hand::JointAngles;
use crate::time::Timestamp;

/// Clamps the angles of a sample to the joint limits; `None` accepts every finite angle.
///
/// A sample without angles is rejected.
pub(super) fn convert(
    time: Timestamp,
    sample: &JointAngles,
    limits: Option<&JointLimits>,
) -> Result<Estimate, Rejection> {
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
    Ok(Estimate::new(time, angles))
}

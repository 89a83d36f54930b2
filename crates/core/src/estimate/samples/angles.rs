//! Samples of joint angles.

use crate::estimate::limits::JointRange;
use crate::estimate::plausibility::Plausibility;
use crate::estimate::{JointLimits, Rejection};
use crate::hand::JointAngles;

/// Adds `offsets` to the angles of a sample and clamps them to the joint limits; `None` accepts every finite angle. Angles that are far
/// outside are noted, and are an error unless they are unreliable.
///
/// A sample without angles is rejected.
pub(super) fn convert(
    sample: &JointAngles,
    limits: Option<&JointLimits>,
    offsets: &JointAngles,
    plausibility: &mut Plausibility,
    angles: &mut JointAngles,
) -> Result<(), Rejection> {
    if sample.is_empty() {
        return Err(Rejection::WrongShape);
    }
    let mut outcome = Ok(());
    for (dof, radians) in sample.known() {
        let radians = radians + offsets.get(dof);
        if !radians.is_finite() {
            return Err(Rejection::NotFinite);
        }
        let range = limits.map_or(JointRange::ANY, |limits| limits.joint_range(dof));
        if range.checked_clamp(radians).is_none() && !plausibility.note_outside(dof) {
            outcome = Err(Rejection::OutsideLimits);
        }
        angles.set(dof, range.clamp(radians));
    }
    outcome
}

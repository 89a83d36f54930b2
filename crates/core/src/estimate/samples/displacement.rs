//! Samples of the displacement of an arm or a hand.

use crate::estimate::{Estimate, Rejection};
use crate::hand::{Displacement, Finger, FingerSet};

/// Largest translation along an axis, in metres. It keeps `f32` exact to 0.01 mm.
const MAX_TRANSLATION: f32 = 100.0;

/// The finger that points, with all joints at rest. The others would press what is beside it.
const POINTING: Finger = Finger::Index;

/// Writes a displacement into `estimate`.
pub(super) fn convert(
    displacement: &Displacement,
    estimate: &mut Estimate,
) -> Result<(), Rejection> {
    let translation = displacement.translation();
    if !translation.is_finite() {
        return Err(Rejection::NotFinite);
    }
    if translation.abs().max_element() > MAX_TRANSLATION {
        return Err(Rejection::OutsideLimits);
    }
    displacement.rotation().ok_or(Rejection::Collapsed)?;
    estimate.displacement = Some(*displacement);
    let others = Finger::ALL.iter().filter(|&&finger| finger != POINTING);
    estimate.untrusted = others.fold(FingerSet::NONE, |others, &finger| others.with(finger));
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

    use super::*;
    use crate::hand::{Joint, JointAngles};
    use crate::time::Timestamp;

    #[test]
    fn displacements_that_are_not_finite_far_away_or_without_a_rotation_are_rejected() {
        let convert = |translation, rotation| {
            let displacement = Displacement::new(Joint::Wrist, translation, rotation);
            let mut estimate = Estimate::new(Timestamp(0), JointAngles::default());
            super::convert(&displacement, &mut estimate).map(|()| estimate.untrusted)
        };
        let trusted = convert(Vec3::X, Quat::IDENTITY).unwrap();
        assert!(!trusted.contains(Finger::Index) && trusted.contains(Finger::Thumb));
        for (translation, rotation, rejection) in [
            (Vec3::NAN, Quat::IDENTITY, Rejection::NotFinite),
            (Vec3::X * 101.0, Quat::IDENTITY, Rejection::OutsideLimits),
            (
                Vec3::ZERO,
                Quat::from_xyzw(0.0, 0.0, 0.0, 0.0),
                Rejection::Collapsed,
            ),
            (
                Vec3::ZERO,
                Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0),
                Rejection::Collapsed,
            ),
        ] {
            assert_eq!(convert(translation, rotation), Err(rejection));
        }
    }
}

//! Samples of joint positions.

use std::time::Duration;

use crate::estimate::{Estimate, JointLimits, MeasuredJoints, Rejection, hand_angles};
use crate::hand::{Finger, FingerSet, Joint, JointPositions, Side};
use crate::time::Timestamp;

/// Largest distance of a joint from the origin along an axis, in metres. It keeps `f32` exact to 0.01 mm.
const MAX_COORDINATE: f64 = 100.0;

/// Smallest distance between the joints of a hand that are furthest apart, in metres.
const MIN_EXTENT: f64 = 1e-3;

/// The time for which an elbow or a wrist that is hidden keeps its last position before the whole hand is untrusted:
/// boards may be anchored to it.
const HOLD: Duration = Duration::from_millis(200);

/// The joints to which boards are anchored.
const ANCHORS: [Joint; 2] = [Joint::Elbow, Joint::Wrist];

/// The converter of one hand.
#[derive(Clone, Debug, Default)]
pub(super) struct JointConverter {
    /// The last position of every joint seen so far.
    last: MeasuredJoints,
    seen_at: [Timestamp; ANCHORS.len()],
}

impl JointConverter {
    /// Converts positions to measured joints and the angles between them, within the joint limits.
    ///
    /// A joint that is hidden keeps its last position. A finger whose tip is hidden is untrusted, and so are all fingers
    /// once an elbow or wrist that was seen before has been hidden for 200 ms.
    pub(super) fn convert(
        &mut self,
        positions: &JointPositions,
        side: Side,
        limits: Option<&JointLimits>,
        estimate: &mut Estimate,
    ) -> Result<(), Rejection> {
        if positions.is_empty() {
            return Err(Rejection::WrongShape);
        }
        for (_, position) in positions.known() {
            if !position.is_finite() {
                return Err(Rejection::NotFinite);
            }
            if position.abs().max_element() > MAX_COORDINATE {
                return Err(Rejection::OutsideLimits);
            }
        }
        if all_coincide(positions) {
            return Err(Rejection::Collapsed);
        }
        for (joint, position) in positions.known() {
            self.last.set(joint, position.as_vec3());
        }
        estimate.angles = hand_angles(positions, side);
        if let Some(limits) = limits {
            limits.clamp_all(&mut estimate.angles);
        }
        estimate.measured = self.last;
        estimate.untrusted = self.untrusted(estimate.time, positions);
        Ok(())
    }

    fn untrusted(&mut self, time: Timestamp, positions: &JointPositions) -> FingerSet {
        for (joint, seen_at) in ANCHORS.into_iter().zip(&mut self.seen_at) {
            if positions.get(joint).is_some() {
                *seen_at = time;
            } else if self.last.get(joint).is_some() && time.since(*seen_at) > HOLD {
                return FingerSet::ALL;
            }
        }
        let hidden = Finger::ALL
            .iter()
            .filter(|&&finger| positions.get(Joint::tip(finger)).is_none());
        hidden.fold(FingerSet::NONE, |hidden, &finger| hidden.with(finger))
    }
}

/// Returns whether two or more joints are all at one place, as a tracker reports that has lost the hand.
fn all_coincide(positions: &JointPositions) -> bool {
    let mut known = positions.known();
    let Some((_, first)) = known.next() else {
        return false;
    };
    let mut others = known.peekable();
    others.peek().is_some() && others.all(|(_, other)| other.distance(first) < MIN_EXTENT)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::hand::JointAngles;

    fn estimate_at(milliseconds: u64) -> Estimate {
        Estimate::new(Timestamp(milliseconds * 1000), JointAngles::default())
    }

    fn sample(joints: &[(Joint, DVec3)]) -> JointPositions {
        let mut positions = JointPositions::default();
        for &(joint, position) in joints {
            positions.set(joint, position);
        }
        positions
    }

    #[test]
    fn a_hidden_tip_is_untrusted_and_a_hidden_elbow_distrusts_the_hand_after_200_ms() {
        let mut converter = JointConverter::default();
        let mut convert = |milliseconds: u64, joints: &[(Joint, DVec3)]| {
            let mut estimate = estimate_at(milliseconds);
            let sample = sample(joints);
            let converted = converter.convert(&sample, Side::Right, None, &mut estimate);
            assert_eq!(converted, Ok(()));
            estimate
        };
        let (elbow, tip) = ((Joint::Elbow, DVec3::Y), (Joint::IndexTip, DVec3::X));
        let seen = convert(0, &[elbow, tip]);
        assert!(!seen.untrusted.contains(Finger::Index));
        assert!(seen.untrusted.contains(Finger::Thumb));
        let no_tip = convert(10, &[elbow]);
        assert_eq!(no_tip.untrusted, FingerSet::ALL);
        assert_eq!(no_tip.measured.get(Joint::IndexTip), Some(glam::Vec3::X));
        assert!(!convert(200, &[tip]).untrusted.contains(Finger::Index));
        assert_eq!(convert(211, &[tip]).untrusted, FingerSet::ALL);
        assert_eq!(
            convert(212, &[tip]).measured.get(Joint::Elbow),
            Some(glam::Vec3::Y)
        );
        assert!(
            !convert(213, &[elbow, tip])
                .untrusted
                .contains(Finger::Index)
        );
    }

    #[test]
    fn positions_that_are_not_finite_far_away_or_all_the_same_are_rejected() {
        let mut converter = JointConverter::default();
        let mut reject = |joints: &[(Joint, DVec3)]| {
            let sample = sample(joints);
            let converted = converter.convert(&sample, Side::Left, None, &mut estimate_at(1));
            converted.unwrap_err()
        };
        assert_eq!(reject(&[]), Rejection::WrongShape);
        let at = |x: f64| [(Joint::Wrist, DVec3::X * x)];
        assert_eq!(reject(&at(f64::NAN)), Rejection::NotFinite);
        assert_eq!(reject(&at(101.0)), Rejection::OutsideLimits);
        let together = [Joint::Elbow, Joint::Wrist, Joint::IndexTip].map(|joint| (joint, DVec3::Y));
        assert_eq!(reject(&together), Rejection::Collapsed);
    }
}

//! Samples of joint positions.

use std::time::Duration;

use super::LANDMARK_HOLD;
use crate::estimate::{Estimate, EstimatorSettings, MeasuredJoints, Rejection, hand_angles};
use crate::hand::{Finger, FingerSet, Joint, JointAngles, JointPositions, Side};
use crate::time::Timestamp;

/// Largest distance of a joint from the origin along an axis, in metres. It keeps `f32` exact to 0.01 mm.
const MAX_COORDINATE: f64 = 100.0;

/// Smallest distance between the joints of a hand that are furthest apart, in metres.
const MIN_EXTENT: f64 = 1e-3;

/// The time for which an elbow or a wrist that is hidden keeps its last position before the whole hand is untrusted:
/// boards may be anchored to it.
const HOLD: Duration = Duration::from_millis(200);

/// The longest time for which an elbow or a wrist may have no position while its movement still counts as known: one picture of a camera
/// with 25 or 30 pictures per second, which may arrive 10 ms late.
const MAX_STANDSTILL: Duration = Duration::from_millis(50);

/// The joints to which boards are anchored.
const ANCHORS: [Joint; 2] = [Joint::Elbow, Joint::Wrist];

/// The converter of one hand.
#[derive(Clone, Debug, Default)]
pub(super) struct JointConverter {
    /// The last position of every joint seen so far.
    last: MeasuredJoints,
    seen_at: [Timestamp; ANCHORS.len()],
    /// The times at which each anchor had a position last, measured or predicted; `None` before the first.
    known_at: [Option<Timestamp>; ANCHORS.len()],
    /// `true` if an elbow or wrist that was seen before is hidden for longer than the hold time.
    is_anchor_lost: bool,
    /// The last hand that was seen; `None` before the first.
    held: Option<Held>,
}

/// A hand while it is not seen.
#[derive(Clone, Copy, Debug)]
struct Held {
    time: Timestamp,
    angles: JointAngles,
    untrusted: FingerSet,
    /// `true` if it has not been seen for longer than the hold time.
    is_lost: bool,
}

impl JointConverter {
    /// Returns `true` if the hand, or the elbow or wrist that was seen before, has not been seen for longer than the hold time.
    pub(super) fn has_lost_arm(&self) -> bool {
        self.is_anchor_lost || self.held.is_some_and(|held| held.is_lost)
    }

    /// Converts positions to measured joints and the angles between them, within the joint limits.
    ///
    /// A joint that is hidden keeps its last position. A finger whose tip is hidden or predicted is untrusted, and so are all fingers
    /// once an elbow or wrist that was seen before has been hidden for 200 ms. Once it has had no position for more than 50 ms, the
    /// estimate is [after a gap](Estimate::is_after_gap), up to the sample with its next position.
    ///
    /// A sample without positions is of a hand that is not seen: it keeps its pose for the hold time. After
    /// that it is lost: its fingers are untrusted, so that they press nothing, until it is seen again.
    pub(super) fn convert(
        &mut self,
        positions: &JointPositions,
        side: Side,
        settings: &EstimatorSettings,
        estimate: &mut Estimate,
    ) -> Result<(), Rejection> {
        if positions.is_empty() {
            return self.hold(estimate);
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
        if let Some(limits) = &settings.limits {
            limits.clamp_all(&mut estimate.angles);
        }
        estimate.measured = self.last;
        estimate.untrusted = self.untrusted(estimate.time, positions);
        estimate.is_after_gap = self.has_standing_anchor(estimate.time, positions);
        estimate.jumped = self.held.is_some_and(|held| held.is_lost);
        self.held = Some(Held {
            time: estimate.time,
            angles: estimate.angles,
            untrusted: estimate.untrusted,
            is_lost: false,
        });
        Ok(())
    }

    /// Repeats the hand that was seen last.
    fn hold(&mut self, estimate: &mut Estimate) -> Result<(), Rejection> {
        let held = self.held.as_mut().ok_or(Rejection::LowConfidence)?;
        held.is_lost |= estimate.time.since(held.time) > LANDMARK_HOLD;
        estimate.angles = held.angles;
        estimate.measured = self.last;
        estimate.untrusted = if held.is_lost {
            FingerSet::ALL
        } else {
            held.untrusted
        };
        Ok(())
    }

    /// Returns `true` if an elbow or a wrist stands still because it has no position, or stood still until this sample: boards that are
    /// anchored to it have not moved with the hand.
    fn has_standing_anchor(&mut self, time: Timestamp, positions: &JointPositions) -> bool {
        let earlier = self.held.map_or(time, |held| held.time);
        let mut is_standing = false;
        for (joint, known_at) in ANCHORS.into_iter().zip(&mut self.known_at) {
            let is_known = positions.get(joint).is_some();
            let end = if is_known { earlier } else { time };
            is_standing |= known_at.is_some_and(|known_at| end.since(known_at) > MAX_STANDSTILL);
            if is_known {
                *known_at = Some(time);
            }
        }
        is_standing
    }

    fn untrusted(&mut self, time: Timestamp, positions: &JointPositions) -> FingerSet {
        self.is_anchor_lost = false;
        for (joint, seen_at) in ANCHORS.into_iter().zip(&mut self.seen_at) {
            if is_measured(positions, joint) {
                *seen_at = time;
            } else if self.last.get(joint).is_some() && time.since(*seen_at) > HOLD {
                self.is_anchor_lost = true;
                return FingerSet::ALL;
            }
        }
        let hidden = Finger::ALL
            .iter()
            .filter(|&&finger| !is_measured(positions, Joint::tip(finger)));
        hidden.fold(FingerSet::NONE, |hidden, &finger| hidden.with(finger))
    }
}

/// Returns `true` if the source sees a joint now.
fn is_measured(positions: &JointPositions, joint: Joint) -> bool {
    positions.get(joint).is_some() && !positions.is_predicted(joint)
}

/// Returns `true` if two or more joints are all at one position, as reported by a tracker that has lost the hand.
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
    use crate::estimate::Smoothing;

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
            let settings = EstimatorSettings::unchecked(Smoothing::Off);
            let converted = converter.convert(&sample, Side::Right, &settings, &mut estimate);
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
    fn an_elbow_without_a_position_for_two_pictures_makes_the_movement_unknown() {
        let mut converter = JointConverter::default();
        let mut is_after_gap = |milliseconds: u64, joints: &[(Joint, DVec3)]| {
            let mut estimate = estimate_at(milliseconds);
            let settings = EstimatorSettings::unchecked(Smoothing::Off);
            let sample = sample(joints);
            let converted = converter.convert(&sample, Side::Right, &settings, &mut estimate);
            assert_eq!(converted, Ok(()));
            estimate.is_after_gap
        };
        let (elbow, tip) = ((Joint::Elbow, DVec3::Y), (Joint::IndexTip, DVec3::X));
        assert!(!is_after_gap(0, &[tip]), "none was seen yet");
        assert!(!is_after_gap(300, &[elbow, tip]));
        assert!(!is_after_gap(333, &[tip]), "one picture");
        assert!(!is_after_gap(366, &[elbow, tip]));
        assert!(!is_after_gap(399, &[tip]));
        assert!(is_after_gap(432, &[tip]), "two pictures");
        assert!(is_after_gap(465, &[elbow, tip]), "it may have moved");
        assert!(!is_after_gap(498, &[elbow, tip]));
        assert!(!is_after_gap(548, &[tip]), "one late picture");
        assert!(!is_after_gap(571, &[elbow, tip]));
    }

    #[test]
    fn a_hand_that_is_not_seen_is_held_then_lost_and_its_way_back_is_unknown() {
        let mut converter = JointConverter::default();
        let settings = EstimatorSettings::unchecked(Smoothing::Off);
        let hold = LANDMARK_HOLD.as_millis() as u64;
        let mut convert = |milliseconds: u64, joints: &[(Joint, DVec3)]| {
            let mut estimate = estimate_at(milliseconds);
            let sample = sample(joints);
            let converted = converter.convert(&sample, Side::Right, &settings, &mut estimate);
            assert_eq!(converted, Ok(()));
            estimate
        };
        let hand = [(Joint::Wrist, DVec3::Y), (Joint::IndexTip, DVec3::X)];
        let seen = convert(0, &hand);
        let held = convert(hold, &[]);
        assert_eq!(
            (held.untrusted, held.measured),
            (seen.untrusted, seen.measured)
        );
        assert!(!convert(hold, &hand).jumped, "seen again in time");
        assert_eq!(convert(2 * hold + 1, &[]).untrusted, FingerSet::ALL);
        assert!(convert(2 * hold + 2, &hand).jumped);
        assert!(!convert(2 * hold + 3, &hand).jumped);
    }

    #[test]
    fn positions_that_are_not_finite_far_away_or_all_the_same_are_rejected() {
        let mut converter = JointConverter::default();
        let mut reject = |joints: &[(Joint, DVec3)]| {
            let sample = sample(joints);
            let settings = EstimatorSettings::unchecked(Smoothing::Off);
            let converted = converter.convert(&sample, Side::Left, &settings, &mut estimate_at(1));
            converted.unwrap_err()
        };
        assert_eq!(reject(&[]), Rejection::LowConfidence);
        let at = |x: f64| [(Joint::Wrist, DVec3::X * x)];
        assert_eq!(reject(&at(f64::NAN)), Rejection::NotFinite);
        assert_eq!(reject(&at(101.0)), Rejection::OutsideLimits);
        let together = [Joint::Elbow, Joint::Wrist, Joint::IndexTip].map(|joint| (joint, DVec3::Y));
        assert_eq!(reject(&together), Rejection::Collapsed);
    }
}

//! Hand and forearm length from measured positions.

use super::{MIN_READINGS, PositionError};
use crate::calibrate::capture::percentile;
use crate::hand::{Joint, JointPositions};
use crate::kinematics::BoneLengths;

/// The joints from the wrist to the end of the middle finger. The sum of their distances is the hand length in any pose.
const HAND: [Joint; 5] = [
    Joint::Wrist,
    Joint::MiddlePhalanxProximal,
    Joint::MiddlePhalanxIntermediate,
    Joint::MiddlePhalanxDistal,
    Joint::MiddleTip,
];

/// The joints at the ends of the forearm.
const FOREARM: [Joint; 2] = [Joint::Elbow, Joint::Wrist];

/// Forearm length as a multiple of hand length, where only one is measured.
const USUAL_FOREARM: f64 = 0.25 / 0.18;

/// The largest range of a length, from the 10th to the 90th percentile, as a fraction of its median.
const STEADY: f64 = 0.15;

/// Lengths of a hand and forearm, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandLengths {
    /// The hand length: wrist crease to the end of the middle finger. `None` if the source does not measure these joints.
    pub hand: Option<f64>,
    /// The forearm length: elbow to wrist. `None` if the source does not measure these joints.
    pub forearm: Option<f64>,
}

impl HandLengths {
    /// Checks that a person has the known lengths. One that is not known is not a reason to refuse the other one.
    ///
    /// # Errors
    /// Fails if one is outside the range of people, or if no person has both.
    pub fn check(&self) -> Result<(), PositionError> {
        let assumed_hand = |forearm: f64| (forearm / USUAL_FOREARM).clamp(0.1, 0.3);
        let (hand, forearm) = match (self.hand, self.forearm) {
            (None, None) => return Ok(()),
            (Some(hand), Some(forearm)) => (hand, forearm),
            (Some(hand), None) => (hand, USUAL_FOREARM * hand),
            (None, Some(forearm)) => (assumed_hand(forearm), forearm),
        };
        let bones = BoneLengths::from_hand_and_forearm(hand, forearm);
        let checked = bones.map_err(|reason| PositionError::NotHuman { reason });
        checked.map(drop)
    }
}

/// Measures hand and forearm length in readings of any poses, such as the flat hand and the pinch: each length is the median over
/// the readings, so that a few wrong ones do not count.
///
/// # Errors
/// Fails if neither is seen, if one is unsteady, or if a person does not have [these lengths](HandLengths::check).
pub fn measure_lengths(readings: &[JointPositions]) -> Result<HandLengths, PositionError> {
    let hand = length(readings, &HAND, "hand")?;
    let forearm = length(readings, &FOREARM, "forearm")?;
    if hand.is_none() && forearm.is_none() {
        return Err(PositionError::NotSeen {
            part: "hand",
            readings: seen(readings, &HAND).len(),
        });
    }
    let lengths = HandLengths { hand, forearm };
    lengths.check()?;
    Ok(lengths)
}

/// Returns the median length of a chain of joints, or `None` if too few readings show all of it.
fn length(
    readings: &[JointPositions],
    chain: &[Joint],
    part: &'static str,
) -> Result<Option<f64>, PositionError> {
    let lengths = seen(readings, chain);
    if lengths.len() < MIN_READINGS {
        return Ok(None);
    }
    let median = percentile(&lengths, 0.5);
    let range = percentile(&lengths, 0.9) - percentile(&lengths, 0.1);
    if range <= STEADY * median {
        Ok(Some(median))
    } else {
        Err(PositionError::Unsteady {
            part,
            percent: 100.0 * range / median,
        })
    }
}

/// Returns the length of a chain in each reading that shows all of it.
fn seen(readings: &[JointPositions], chain: &[Joint]) -> Vec<f64> {
    let length = |positions: &JointPositions| {
        let bones = chain.windows(2);
        bones
            .map(|bone| Some(positions.get(bone[0])?.distance(positions.get(bone[1])?)))
            .sum::<Option<f64>>()
            .filter(|length| length.is_finite())
    };
    readings.iter().filter_map(length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::CalibrationPose;
    use crate::estimate::Estimate;
    use crate::hand::Side;
    use crate::kinematics::ArmModel;
    use crate::time::Timestamp;
    use glam::DVec3;

    /// Readings of a person in the flat hand and the pinch, with 2 mm of noise, and every 20th at another position.
    fn readings(hand: f64, forearm: f64, noise: f64) -> Vec<JointPositions> {
        let bones = BoneLengths::from_hand_and_forearm(hand, forearm).unwrap();
        let arm = ArmModel::anthropometric(Side::Right, &bones).unwrap();
        let mut random = fastrand::Rng::with_seed(7);
        let mut offset = move || noise * (random.f64() - 0.5) * 3.4;
        let mut readings = Vec::new();
        for index in 0..120 {
            let pose = match index % 2 {
                0 => CalibrationPose::Flat,
                _ => CalibrationPose::Pinch,
            };
            let posed = arm.forward(&Estimate::new(Timestamp(0), pose.angles()));
            let mut positions = JointPositions::default();
            for (joint, joint_pose) in posed.known() {
                let scatter = DVec3::new(offset(), offset(), offset());
                let scale = if index % 20 == 19 { 1.5 } else { 1.0 };
                positions.set(joint, joint_pose.translation.as_dvec3() * scale + scatter);
            }
            readings.push(positions);
        }
        readings
    }

    #[test]
    fn hands_of_all_sizes_are_measured_to_3_percent() {
        for (hand, forearm) in [(0.153, 0.207), (0.176, 0.238), (0.199, 0.269)] {
            let found = measure_lengths(&readings(hand, forearm, 0.002)).unwrap();
            let error =
                |measured: Option<f64>, length: f64| (measured.unwrap() / length - 1.0).abs();
            assert!(error(found.hand, hand) < 0.03, "{found:?}");
            assert!(error(found.forearm, forearm) < 0.01, "{found:?}");
        }
    }

    #[test]
    fn a_hand_without_an_elbow_has_no_forearm_length() {
        let without = readings(0.18, 0.25, 0.0).into_iter().map(|positions| {
            let mut seen = JointPositions::default();
            for (joint, position) in positions.known() {
                if joint.index() >= Joint::Wrist.index() {
                    seen.set(joint, position);
                }
            }
            seen
        });
        let found = measure_lengths(&without.collect::<Vec<_>>()).unwrap();
        assert!(found.hand.is_some() && found.forearm.is_none());
    }

    #[test]
    fn unusable_positions_are_refused_with_the_reason() {
        let error = |readings: &[JointPositions]| measure_lengths(readings).unwrap_err();
        let few = readings(0.18, 0.25, 0.002);
        assert!(matches!(
            error(&few[..5]),
            PositionError::NotSeen { readings: 5, .. }
        ));
        let shaky = error(&readings(0.18, 0.25, 0.03));
        assert!(matches!(shaky, PositionError::Unsteady { .. }), "{shaky}");
        let scaled = readings(0.18, 0.25, 0.0).into_iter().map(|positions| {
            let mut larger = JointPositions::default();
            for (joint, position) in positions.known() {
                larger.set(joint, position * 1000.0);
            }
            larger
        });
        let scaled = error(&scaled.collect::<Vec<_>>());
        assert!(scaled.to_string().contains("check the unit"), "{scaled}");
    }
}

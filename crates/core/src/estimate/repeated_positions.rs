//! Positions that a source repeats, the hand that is lost if it repeats them for long, and the jump of the hand when it measures again.

use std::time::Duration;

use parry3d::math::Vec3;

use super::{Estimate, MeasuredJoints};
use crate::hand::{Displacement, InputValues};
use crate::time::Timestamp;

/// The time after which a source that repeats all positions exactly counts as stuck. Noise changes at least the last bits of the positions
/// of a hand at rest.
const MIN_REPEATED: Duration = Duration::from_millis(150);

/// The longest time for which a hand whose source repeats everything exactly may hold keys. Filters with a dead zone repeat the positions
/// of a hand that rests or holds a key.
const MAX_REPEATED: Duration = Duration::from_secs(5);

/// The shortest distance, in metres, that shows that a hand has moved while its positions were repeated.
const MIN_DISTANCE: f32 = 0.04;

/// The acceleration with which a fast reach starts, in m/s².
const MAX_ACCELERATION: f32 = 32.0;

/// Returns the longest distance that a hand that was at rest goes in `period`, in metres: 40 mm in 50 ms, 160 mm in 100 ms.
fn reach(period: Duration) -> f32 {
    let seconds = period.as_secs_f32();
    (0.5 * MAX_ACCELERATION * seconds * seconds).max(MIN_DISTANCE)
}

/// The last measured positions of a hand, and the time since which its source repeats them.
#[derive(Clone, Debug, Default)]
pub(super) struct RepeatedPositions {
    joints: MeasuredJoints,
    displacement: Option<Displacement>,
    since: Timestamp,
    last: Timestamp,
    inputs: InputValues,
    /// The last time at which the positions or the inputs changed, or the hand was not seen.
    changed: Timestamp,
    is_stuck: bool,
}

impl RepeatedPositions {
    /// Adds an accepted estimate with unfiltered positions. Returns `true` if it shows the hand elsewhere after its positions were
    /// repeated, or after the source was stuck, so that it is not known how the hand got there. Always `false` for a source that measures
    /// no positions, such as a glove. `is_seen` is `false` while the source does not show the hand, and its last positions stay.
    pub(super) fn push(&mut self, estimate: &Estimate, is_seen: bool) -> bool {
        let Estimate {
            time,
            measured,
            displacement,
            inputs,
            ..
        } = estimate;
        if measured.is_empty() && displacement.is_none() {
            self.is_stuck = false;
            return false;
        }
        let has_repeated = self.last.since(self.since) > MIN_REPEATED;
        let limit = reach(time.since(self.last));
        self.last = *time;
        let is_same = self.joints == *measured && self.displacement == *displacement;
        if !is_same || !is_seen || self.inputs != *inputs {
            self.inputs = *inputs;
            self.changed = *time;
        }
        let is_stuck = time.since(self.changed) > MAX_REPEATED && has_positions(estimate);
        let was_stuck = std::mem::replace(&mut self.is_stuck, is_stuck);
        if is_same {
            return false;
        }
        let has_jumped = was_stuck || has_repeated && self.distance(estimate) > limit;
        self.joints = *measured;
        self.displacement = *displacement;
        self.since = *time;
        has_jumped
    }

    /// Returns `true` if the source has repeated all positions of the hand and its inputs exactly for so long that it is not known
    /// where the hand is.
    pub(super) fn is_stuck(&self) -> bool {
        self.is_stuck
    }

    /// Returns the longest distance of a position from the last one, in metres.
    fn distance(&self, estimate: &Estimate) -> f32 {
        let of_joint = |(joint, to): (_, Vec3)| Some(self.joints.get(joint)?.distance(to));
        let of_joints = estimate.measured.iter().filter_map(of_joint);
        let translation =
            |displacement: Option<Displacement>| displacement.map(|it| it.translation());
        let of_displacement = translation(self.displacement)
            .zip(translation(estimate.displacement))
            .map(|(from, to)| from.distance(to));
        of_joints.chain(of_displacement).fold(0.0, f32::max)
    }
}

/// Returns `true` if positions were measured. An inertial sensor displaces the hand by a rotation only, which it may repeat, as a glove its
/// counts.
fn has_positions(estimate: &Estimate) -> bool {
    let is_translated = |it: Displacement| it.translation() != Vec3::ZERO;
    !estimate.measured.is_empty() || estimate.displacement.is_some_and(is_translated)
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::hand::{Input, Joint, JointAngles};

    /// Returns `true` if a tip that is measured at 0 for a time, in readings of a period in milliseconds, and then at a distance in
    /// metres, has jumped.
    fn has_jumped(repeated: u64, period: u64, distance: f32) -> bool {
        let mut positions = RepeatedPositions::default();
        let mut push = |milliseconds: u64, x: f32| {
            let mut estimate = estimate_at(milliseconds);
            estimate.measured.set(Joint::Wrist, Vec3::Y);
            estimate.measured.set(Joint::IndexTip, Vec3::X * x);
            positions.push(&estimate, true)
        };
        let end = 1_000 + repeated;
        for time in (1_000..=end).step_by(10) {
            assert!(!push(time, 0.0), "{time} ms");
        }
        let has_jumped = push(end + period, distance);
        assert!(!push(end + 2 * period, 0.0), "it was not repeated");
        has_jumped
    }

    fn estimate_at(milliseconds: u64) -> Estimate {
        Estimate::new(Timestamp(milliseconds * 1_000), JointAngles::default())
    }

    #[test]
    fn a_hand_that_is_elsewhere_after_its_positions_were_repeated_has_jumped() {
        assert!(has_jumped(160, 10, 0.05));
        assert!(has_jumped(160, 50, 0.05));
        assert!(!has_jumped(150, 10, 0.05), "repeated for a short time");
        assert!(!has_jumped(160, 60, 0.05), "the hand may have moved since");
        assert!(has_jumped(160, 60, 0.07), "a picture was lost");
        assert!(!has_jumped(160, 100, 0.15), "the hand may have moved since");
        assert!(has_jumped(160, 100, 0.17), "two pictures were lost");
        assert!(!has_jumped(160, 10_000, 1.0), "the hand was not seen");
        assert!(!has_jumped(160, 10, 0.03), "a tap");
    }

    #[test]
    fn noise_in_one_coordinate_is_no_repetition() {
        let mut positions = RepeatedPositions::default();
        let mut push = |milliseconds: u64, tip: Vec3| {
            let mut estimate = estimate_at(milliseconds);
            estimate.measured.set(Joint::Wrist, Vec3::Y);
            estimate.measured.set(Joint::IndexTip, tip);
            positions.push(&estimate, true)
        };
        for time in (10..=500).step_by(10) {
            let noise = 1e-6 * (time % 3) as f32;
            assert!(!push(time, Vec3::Z * noise));
        }
        assert!(!push(510, Vec3::X));
    }

    #[test]
    fn a_repeated_displacement_jumps_by_its_translation_and_angles_never_do() {
        for (translation, expected) in [(Vec3::X, true), (Vec3::ZERO, false)] {
            let mut positions = RepeatedPositions::default();
            let mut push = |milliseconds: u64, to: Vec3, angle: f32| {
                let mut estimate = estimate_at(milliseconds);
                let rotation = Quat::from_rotation_z(angle);
                estimate.displacement = Some(Displacement::new(Joint::Wrist, to, rotation));
                positions.push(&estimate, true)
            };
            for time in (10..=500).step_by(10) {
                assert!(!push(time, Vec3::ZERO, 0.0));
            }
            assert_eq!(push(510, translation, 1.0), expected);
        }
        let mut positions = RepeatedPositions::default();
        assert!((1..100).all(|time| !positions.push(&estimate_at(10 * time), true)));
    }

    /// Returns the times, in milliseconds, at which a source counts as stuck that measures every 10 ms from 1 s to 13 s. `change` may
    /// change the estimate of a time, and returns `false` for a hand that is not seen.
    fn stuck_times(change: impl Fn(u64, &mut Estimate) -> bool) -> Vec<u64> {
        let mut positions = RepeatedPositions::default();
        let mut times = Vec::new();
        for time in (1_000..=13_000).step_by(10) {
            let mut estimate = estimate_at(time);
            estimate.measured.set(Joint::Wrist, Vec3::Y);
            let is_seen = change(time, &mut estimate);
            positions.push(&estimate, is_seen);
            if positions.is_stuck() {
                times.push(time);
            }
        }
        times
    }

    #[test]
    fn a_source_that_repeats_everything_for_more_than_5_s_is_stuck_until_something_changes() {
        let tip_at = |height: f32| {
            move |time: u64, estimate: &mut Estimate| {
                let is_elsewhere = time >= 8_000;
                let height = if is_elsewhere { height } else { 0.0 };
                estimate.measured.set(Joint::IndexTip, Vec3::Y * height);
                true
            }
        };
        let until_8_s: Vec<_> = (6_010..8_000).step_by(10).collect();
        assert_eq!(stuck_times(tip_at(1e-6))[..until_8_s.len()], until_8_s);
        assert!(!stuck_times(tip_at(1e-6)).contains(&8_000));
        assert!(!stuck_times(tip_at(1e-6)).contains(&13_000));
        assert_eq!(stuck_times(tip_at(0.0)).last(), Some(&13_000));
        let trembling = stuck_times(|time, estimate| {
            let noise = 1e-6 * (time / 10 % 2) as f32;
            estimate.measured.set(Joint::IndexTip, Vec3::Y * noise);
            true
        });
        assert_eq!(trembling, [0; 0]);
    }

    #[test]
    fn a_hand_that_is_not_seen_and_one_with_an_input_that_changes_are_not_stuck() {
        let seen = stuck_times(|time, _| !(2_000..8_500).contains(&time));
        assert_eq!(seen, [0; 0], "4.5 s before the end");
        let input = stuck_times(|time, estimate| {
            estimate.inputs.set(Input::Trigger, (time / 3_000) as f32);
            true
        });
        assert_eq!(input, [0; 0]);
    }

    #[test]
    fn only_a_source_of_positions_is_stuck() {
        for (translation, expected) in [(Vec3::X, Some(&13_000)), (Vec3::ZERO, None)] {
            let stuck = stuck_times(|_, estimate| {
                *estimate = Estimate::new(estimate.time, JointAngles::default());
                let displacement = Displacement::new(Joint::Wrist, translation, Quat::IDENTITY);
                estimate.displacement = Some(displacement);
                true
            });
            assert_eq!(stuck.last(), expected, "{translation}");
        }
        let angles_at_the_end = stuck_times(|time, estimate| {
            if time >= 10_000 {
                *estimate = Estimate::new(estimate.time, JointAngles::default());
            }
            true
        });
        assert_eq!(angles_at_the_end.last(), Some(&9_990));
    }
}

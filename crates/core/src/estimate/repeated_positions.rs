//! Positions that a source repeats, and the jump of the hand when it measures again.

use std::time::Duration;

use parry3d::math::Vec3;

use super::{Estimate, MeasuredJoints};
use crate::hand::Displacement;
use crate::time::Timestamp;

/// The time after which a source that repeats all positions exactly counts as stuck. Noise changes at least the last bits of the positions
/// of a hand at rest.
const MIN_REPEATED: Duration = Duration::from_millis(150);

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
}

impl RepeatedPositions {
    /// Adds an accepted estimate with unfiltered positions. Returns `true` if it shows the hand elsewhere after its positions were
    /// repeated, so that it is not known how it got there. Always `false` for a source that measures no positions, such as a glove.
    pub(super) fn push(&mut self, estimate: &Estimate) -> bool {
        let Estimate {
            time,
            measured,
            displacement,
            ..
        } = estimate;
        if measured.is_empty() && displacement.is_none() {
            return false;
        }
        let has_repeated = self.last.since(self.since) > MIN_REPEATED;
        let limit = reach(time.since(self.last));
        self.last = *time;
        if self.joints == *measured && self.displacement == *displacement {
            return false;
        }
        let has_jumped = has_repeated && self.distance(estimate) > limit;
        self.joints = *measured;
        self.displacement = *displacement;
        self.since = *time;
        has_jumped
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

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::hand::{Joint, JointAngles};

    /// Returns `true` if a tip that is measured at 0 for a time, in readings of a period in milliseconds, and then at a distance in
    /// metres, has jumped.
    fn has_jumped(repeated: u64, period: u64, distance: f32) -> bool {
        let mut positions = RepeatedPositions::default();
        let mut push = |milliseconds: u64, x: f32| {
            let mut estimate = estimate_at(milliseconds);
            estimate.measured.set(Joint::Wrist, Vec3::Y);
            estimate.measured.set(Joint::IndexTip, Vec3::X * x);
            positions.push(&estimate)
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
            positions.push(&estimate)
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
                positions.push(&estimate)
            };
            for time in (10..=500).step_by(10) {
                assert!(!push(time, Vec3::ZERO, 0.0));
            }
            assert_eq!(push(510, translation, 1.0), expected);
        }
        let mut positions = RepeatedPositions::default();
        assert!((1..100).all(|time| !positions.push(&estimate_at(10 * time))));
    }
}

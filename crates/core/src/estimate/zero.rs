//! Zeroing: offsets that turn the present angles of a resting hand into the angles of its rest pose.

use std::fmt;
use std::time::Duration;

use crate::hand::{Dof, FingerSet, JointAngles};
use crate::time::Timestamp;

/// The largest offset of an angle, in degrees. A glove that slips on the hand or warms up changes an angle by a few degrees; a
/// larger change is another pose or a broken sensor.
const MAX_OFFSET_DEG: f64 = 20.0;

/// The time for which a hand must be still.
const STILL_TIME: Duration = Duration::from_millis(500);

/// The largest change of an angle of a still hand, in radians: 3°, four counts of an 8-bit converter.
const STILL_RANGE: f64 = 0.052;

/// Reason why a hand cannot be zeroed. Nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ZeroError {
    /// The source gives positions or displacements, whose zero says nothing about the zero of a joint.
    #[error(
        "the source measures positions, not joint angles, and has no zero; use `recenter` to move the boards"
    )]
    NoAngles,
    /// No angle of the rest pose is measured.
    #[error(
        "the source measures no joint of the rest pose; add the joints to `rest_deg` of the glove file"
    )]
    NoRestPose,
    /// The hand moved within the last half second.
    #[error("the hand is not still; hold it at rest for half a second and try again")]
    Moving,
    /// An angle is too far from the rest pose.
    #[error(
        "{dof} is {degrees}° from the rest pose, and a slipped glove explains at most 20°; relax the hand and try again, or calibrate the glove"
    )]
    TooFar {
        /// The angle with the largest difference.
        dof: Dof,
        /// The difference in whole degrees.
        degrees: u16,
    },
    /// Nothing was zeroed.
    #[error("nothing was zeroed in this run")]
    NothingToUndo,
}

/// The effect of zeroing a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zeroed {
    /// The number of angles with an offset.
    pub count: usize,
    /// The angle with the largest offset.
    pub largest: Dof,
    /// The offset, in radians.
    pub radians: f64,
}

/// The offsets of one hand, and the detection of a resting hand, from whose angles they are derived.
#[derive(Clone, Debug)]
pub(super) struct Zero {
    rest_pose: JointAngles,
    /// The offsets that are added to the measured angles, in radians; known for angles that were zeroed.
    offsets: JointAngles,
    rest: Rest,
}

/// The angles of a hand since it has been still.
#[derive(Clone, Debug, Default)]
struct Rest {
    since: Option<Timestamp>,
    latest: Timestamp,
    /// The angles at `since`.
    first: JointAngles,
    /// Fingers with a sensor fault in the latest reading.
    untrusted: FingerSet,
    sums: [f64; Dof::COUNT],
    count: u32,
}

impl Zero {
    pub(super) fn new(rest_pose: JointAngles) -> Self {
        Self {
            rest_pose,
            offsets: JointAngles::default(),
            rest: Rest::default(),
        }
    }

    /// Adopts the offsets of the same hand from another estimator.
    pub(super) fn adopt_offsets(&mut self, other: &Self) {
        self.offsets = other.offsets;
    }

    /// Returns the offsets of the measured angles, in radians; 0 for an angle that was not zeroed.
    pub(super) fn offsets(&self) -> &JointAngles {
        &self.offsets
    }

    /// Updates the detection of rest with the angles of the latest reading. Does not allocate.
    pub(super) fn update(&mut self, time: Timestamp, angles: &JointAngles, untrusted: FingerSet) {
        self.rest.update(time, angles, untrusted);
    }

    /// Restarts the detection of rest.
    pub(super) fn reset(&mut self) {
        self.rest.since = None;
    }

    /// Sets the offsets that give the resting hand the angles of the rest pose, and returns their changes in radians.
    pub(super) fn zero(&mut self) -> Result<JointAngles, ZeroError> {
        let mut offsets = self.offsets;
        let mut changes = JointAngles::default();
        let mut farthest: Option<(Dof, f64)> = None;
        let is_trusted = |dof: Dof| {
            let finger = dof.finger();
            finger.is_none_or(|finger| !self.rest.untrusted.contains(finger))
        };
        let is_measured = |dof: Dof| self.rest.first.is_known(dof) && is_trusted(dof);
        for (dof, target) in self.rest_pose.known().filter(|(dof, _)| is_measured(*dof)) {
            let change = target - self.rest.mean(dof);
            let offset = self.offsets.get(dof) + change;
            changes.set(dof, change);
            offsets.set(dof, offset);
            if farthest.is_none_or(|(_, largest)| offset.abs() > largest.abs()) {
                farthest = Some((dof, offset));
            }
        }
        let (dof, offset) = farthest.ok_or(ZeroError::NoRestPose)?;
        if !self.rest.is_still() {
            return Err(ZeroError::Moving);
        }
        let degrees = offset.abs().to_degrees();
        if degrees > MAX_OFFSET_DEG {
            let degrees = degrees.round() as u16;
            return Err(ZeroError::TooFar { dof, degrees });
        }
        self.offsets = offsets;
        self.reset();
        Ok(changes)
    }

    /// Removes the offsets, and returns the changes of the angles in radians.
    pub(super) fn undo(&mut self) -> Result<JointAngles, ZeroError> {
        if self.offsets.is_empty() {
            return Err(ZeroError::NothingToUndo);
        }
        let mut changes = JointAngles::default();
        for (dof, offset) in self.offsets.known() {
            changes.set(dof, -offset);
        }
        self.offsets = JointAngles::default();
        self.reset();
        Ok(changes)
    }

    /// Returns the effect of the offsets, if there are any.
    pub(super) fn zeroed(&self) -> Option<Zeroed> {
        let largest = |a: &(Dof, f64), b: &(Dof, f64)| a.1.abs().total_cmp(&b.1.abs());
        let (largest, radians) = self.offsets.known().max_by(largest)?;
        Some(Zeroed {
            count: self.offsets.known().count(),
            largest,
            radians,
        })
    }
}

impl Rest {
    fn update(&mut self, time: Timestamp, angles: &JointAngles, untrusted: FingerSet) {
        let is_still = |first: &JointAngles| {
            first.has_same_dofs(angles) && first.is_within(STILL_RANGE, angles)
        };
        if self.since.is_none() || !is_still(&self.first) {
            *self = Self {
                since: Some(time),
                first: *angles,
                ..Self::default()
            };
        }
        self.latest = time;
        self.untrusted = untrusted;
        self.count = self.count.saturating_add(1);
        for (sum, radians) in self.sums.iter_mut().zip(angles.radians()) {
            *sum += radians;
        }
    }

    fn is_still(&self) -> bool {
        self.since
            .is_some_and(|since| self.latest.since(since) >= STILL_TIME)
    }

    /// Returns the mean of an angle since the hand has been still, in radians.
    fn mean(&self, dof: Dof) -> f64 {
        self.sums[dof.index()] / f64::from(self.count.max(1))
    }
}

/// A clause for the user: "20 joints zeroed, the largest change is +4.2° (index-pip-flexion)".
impl fmt::Display for Zeroed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let degrees = self.radians.to_degrees();
        let (count, largest) = (self.count, self.largest);
        let joints = if count == 1 { "joint" } else { "joints" };
        write!(
            f,
            "{count} {joints} zeroed, the largest change is {degrees:+.1}° ({largest})"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Reading, Sample};
    use crate::estimate::{Estimate, Estimator, EstimatorSettings, Smoothing};

    const LOOSE: Dof = Dof::IndexMcpFlexion;
    const STILL: Dof = Dof::MiddleMcpFlexion;

    /// A hand that rests with two joints at 0.1 rad, whose rest pose is 0.
    struct Hand {
        estimator: Estimator,
        time: Timestamp,
    }

    impl Hand {
        fn new() -> Self {
            let mut rest_pose = JointAngles::default();
            rest_pose.set(LOOSE, 0.0);
            rest_pose.set(STILL, 0.0);
            Self {
                estimator: Estimator::new(EstimatorSettings {
                    smoothing: Smoothing::Off,
                    rest_pose,
                    ..EstimatorSettings::default()
                }),
                time: Timestamp::default(),
            }
        }

        /// Rests for a second, and returns the last estimate.
        fn rest(&mut self, is_loose: bool) -> Estimate {
            let mut last = None;
            for number in 0..100 {
                self.time.0 += 10_000;
                let mut angles = JointAngles::default();
                let is_off = is_loose && number % 2 == 1;
                angles.set(LOOSE, if is_off { 1.0 } else { 0.1 });
                angles.set(STILL, 0.1);
                let reading = Reading::new(self.time, None, Sample::Angles { angles });
                last = self.estimator.update(&reading).ok().copied();
            }
            last.expect("an accepted reading")
        }
    }

    #[test]
    fn an_angle_that_is_unreliable_is_not_zeroed_and_the_others_are() {
        let mut hand = Hand::new();
        hand.rest(false);
        let loose = hand.rest(true);
        assert!(!loose.angles.is_known(LOOSE));
        hand.estimator.zero().expect("a still hand");
        let zeroed = hand.estimator.zeroed().expect("an offset");
        assert_eq!((zeroed.count, zeroed.largest), (1, STILL));
        let repaired = hand.rest(false).angles;
        assert_eq!(repaired.get(LOOSE), 0.1);
        assert!(repaired.get(STILL).abs() < 1e-9);
        // It is trusted only near the end of that second.
        hand.rest(false);
        hand.estimator.zero().expect("a still hand");
        let zeroed_again = hand.estimator.zeroed().expect("offsets");
        assert_eq!(zeroed_again.count, 2);
    }

    #[test]
    fn the_offset_of_an_angle_that_becomes_unreliable_stays() {
        let mut hand = Hand::new();
        hand.rest(false);
        hand.estimator.zero().expect("a still hand");
        hand.rest(true);
        hand.estimator.zero().expect("the other angles are still");
        assert_eq!(hand.estimator.zeroed().map(|zeroed| zeroed.count), Some(2));
        let repaired = hand.rest(false).angles;
        assert!(repaired.get(LOOSE).abs() < 1e-9);
    }
}

//! Fusion of an arm and its fingers, which two sources measure.

use std::time::Duration;

use super::last_seen::LastSeen;
use super::{Estimate, Estimator, Implausible, MeasuredJoints, Rejection};
use crate::capture::Reading;
use crate::hand::{Dof, FingerSet, HandPart, Joint, JointAngles};
use crate::time::Timestamp;

/// The joints that the source of the arm places.
const ARM_JOINTS: [Joint; 3] = [Joint::Shoulder, Joint::Elbow, Joint::Wrist];

/// Returns the longest gap between two readings of the fingers in which they may enter a target: three quarters of the stall timeout.
pub(crate) fn max_sweep(stall_timeout: Duration) -> Duration {
    stall_timeout / 4 * 3
}

/// The estimator of a hand whose arm and fingers are measured by two sources.
///
/// Each part has an estimator, and so filters, of its own. An estimate combines the latest state of both: the source of
/// the arm provides the root, the angles up to the wrist and the positions of shoulder, elbow and wrist; the other source
/// provides the fingers, and the angles of the arm that the first does not measure. Measured positions of fingers move with
/// the wrist. The sources are aligned in time by `MergedSource`.
///
/// A part without a reading for longer than the timeout is lost: without the arm the [position](Estimate::is_placed) of the hand is
/// unknown, without the fingers all fingers are untrusted. The other part stays. An arm that its source no longer sees is lost too. While
/// readings of a part are late, and at the first one after that, the estimate is [after a gap](Estimate::is_after_gap).
#[derive(Clone, Debug)]
pub struct FusedEstimator {
    parts: [Part; HandPart::COUNT],
    timeout: Duration,
    /// The time of the latest reading of either part.
    last: Option<Timestamp>,
    /// The estimate of the latest reading, updated in place.
    estimate: Estimate,
}

/// The estimator of one part.
#[derive(Clone, Debug)]
struct Part {
    estimator: Estimator,
    /// Its latest reading, unless it is lost.
    seen: LastSeen,
    /// The latest state, which counts unless the part is lost.
    latest: Estimate,
}

impl Part {
    fn new(estimator: Estimator) -> Self {
        Self {
            estimator,
            seen: LastSeen::default(),
            latest: Estimate::new(Timestamp::default(), JointAngles::default()),
        }
    }

    /// Returns the latest state unless the part is lost.
    fn state(&self) -> Option<&Estimate> {
        self.seen.time().map(|_| &self.latest)
    }
}

impl FusedEstimator {
    /// Creates an estimator of two parts. A part is lost after `timeout` without a reading.
    pub fn new(arm: Estimator, fingers: Estimator, timeout: Duration) -> Self {
        let mut estimate = Estimate::new(Timestamp::default(), JointAngles::default());
        estimate.lose_hand();
        Self {
            parts: [arm, fingers].map(Part::new),
            timeout,
            last: None,
            estimate,
        }
    }

    /// Converts a reading of its [part](Reading::part), or of the fingers if it has none. A rejected reading, such as one that is not
    /// later than the last reading of either part, changes nothing. Does not allocate.
    pub fn update(&mut self, reading: &Reading) -> Result<&Estimate, Rejection> {
        if self.last.is_some_and(|last| reading.time <= last) {
            return Err(Rejection::OutOfOrder);
        }
        let index = reading.part.unwrap_or(HandPart::Fingers).index();
        let [arm_seen, fingers_seen] = self.parts.each_ref().map(|part| part.seen);
        let is_arm_late = arm_seen.is_late(reading.time);
        let are_fingers_late = fingers_seen.age(reading.time) > max_sweep(self.timeout);
        let part = &mut self.parts[index];
        part.latest = *part.estimator.update(reading)?;
        self.last = Some(reading.time);
        let is_back = part.seen.time().is_none();
        part.seen.see(reading.time);
        let mut jumped = is_back || part.latest.jumped;
        let other = &mut self.parts[1 - index];
        if other.seen.age(reading.time) > self.timeout {
            other.seen.lose();
            jumped = true;
        }
        self.fuse(reading.time, jumped);
        let mut states = self.parts.iter().filter_map(Part::state);
        let is_part_late = is_arm_late || are_fingers_late;
        self.estimate.is_after_gap = is_part_late || states.any(|state| state.is_after_gap);
        let fingers = self.parts[HandPart::Fingers.index()].state();
        let are_bends_missing = fingers.is_some_and(|fingers| fingers.misses_bends);
        self.estimate.misses_bends = are_fingers_late || are_bends_missing;
        Ok(&self.estimate)
    }

    /// Sets the time without a reading after which a part is lost.
    pub fn set_timeout(&mut self, timeout: Duration) {
        self.timeout = timeout;
    }

    /// Forgets a part whose source was lost. Returns the other part, or `None` if that is lost too.
    pub fn lose(&mut self, part: HandPart) -> Option<&Estimate> {
        self.parts[part.index()].seen.lose();
        self.fuse(self.estimate.time, true);
        let is_seen = self.parts.iter().any(|it| it.seen.time().is_some());
        is_seen.then_some(&self.estimate)
    }

    /// Forgets both parts.
    pub fn lose_all(&mut self) {
        for part in &mut self.parts {
            part.seen.lose();
        }
        self.estimate.lose_hand();
    }

    /// Returns `true` if the sources of all parts that are seen have repeated all positions for so long that it is not known where the
    /// hand is. A part that a glove measures, or that moves, shows that the hand leaves a key; a part that is not seen does not.
    pub(super) fn is_stuck(&self) -> bool {
        let is_seen = |part: &&Part| {
            let is_placed = part.state().is_some_and(|state| state.is_placed);
            is_placed && !part.estimator.has_lost_arm()
        };
        let mut seen = self.parts.iter().filter(is_seen).peekable();
        seen.peek().is_some() && seen.all(|part| part.estimator.is_stuck())
    }

    /// Returns the parts of the hand that are not trusted because their readings are implausible.
    pub(super) fn implausible(&self) -> Implausible {
        let parts = self.parts.iter();
        parts.fold(Implausible::default(), |all, part| {
            all.union(part.estimator.implausible())
        })
    }

    /// Returns the sensor channel of an angle that is implausible, if a glove measures it.
    pub(super) fn channel_of(&self, dof: Dof) -> Option<usize> {
        let mut parts = self.parts.iter();
        let part = parts.find(|part| part.estimator.implausible().angles.contains(dof))?;
        part.estimator.channel_of(dof)
    }

    /// Returns the estimator of the arm, unless its source is lost.
    pub(super) fn arm(&self) -> Option<&Estimator> {
        let arm = &self.parts[HandPart::Arm.index()];
        arm.seen.time().map(|_| &arm.estimator)
    }

    /// Returns the estimator of the fingers.
    pub(super) fn fingers(&self) -> &Estimator {
        &self.parts[HandPart::Fingers.index()].estimator
    }

    /// Returns the estimator of the fingers, to zero it.
    pub(super) fn fingers_mut(&mut self) -> &mut Estimator {
        &mut self.parts[HandPart::Fingers.index()].estimator
    }

    /// Combines the latest states of both parts.
    fn fuse(&mut self, time: Timestamp, jumped: bool) {
        let Self {
            parts, estimate, ..
        } = self;
        let is_arm_seen = !parts[HandPart::Arm.index()].estimator.has_lost_arm();
        let [arm, fingers] = parts.each_ref().map(Part::state);
        let is_placed = is_arm_seen && arm.is_some_and(|arm| arm.is_placed);
        let was_placed = estimate.is_placed;
        estimate.reset(time);
        estimate.jumped = jumped || is_placed && !was_placed;
        estimate.is_placed = is_placed;
        estimate.untrusted = fingers.map_or(FingerSet::ALL, |fingers| fingers.untrusted);
        if let Some(arm) = arm {
            estimate.inputs = arm.inputs;
            if is_arm_seen {
                add_arm(arm, estimate);
            }
        }
        if let Some(fingers) = fingers {
            add_fingers(fingers, estimate);
        }
    }
}

/// Adds the position, the angles and the joints of an arm.
fn add_arm(arm: &Estimate, estimate: &mut Estimate) {
    estimate.root = arm.root;
    estimate.displacement = arm.displacement;
    for (dof, radians) in arm.angles.known() {
        if dof.finger().is_none() {
            estimate.angles.set(dof, radians);
        }
    }
    for joint in ARM_JOINTS {
        if let Some(position) = arm.measured.get(joint) {
            estimate.measured.set(joint, position);
        }
    }
}

/// Adds the fingers to an arm, and the angles of the arm that only their source measures.
fn add_fingers(fingers: &Estimate, estimate: &mut Estimate) {
    for (dof, radians) in fingers.angles.known() {
        let is_free =
            |candidate: Dof| candidate.finger().is_some() || !estimate.angles.is_known(candidate);
        if is_free(dof) {
            estimate.angles.set(dof, radians);
        }
    }
    let of_arm = std::mem::replace(&mut estimate.inputs, fingers.inputs);
    estimate.inputs.add_angles_of(&of_arm);
    let wrist = |measured: &MeasuredJoints| measured.get(Joint::Wrist);
    let (Some(to), Some(from)) = (wrist(&estimate.measured), wrist(&fingers.measured)) else {
        return;
    };
    for (joint, position) in fingers.measured.iter() {
        if !ARM_JOINTS.contains(&joint) {
            estimate.measured.set(joint, position + (to - from));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::capture::Sample;
    use crate::estimate::{EstimatorSettings, Smoothing};
    use crate::hand::{Finger, JointPositions};

    /// A hand at rest, of whose angles one may jump with each reading.
    struct Hand {
        estimator: FusedEstimator,
        time: Timestamp,
        /// The angles that each part measures.
        measured: [&'static [Dof]; HandPart::COUNT],
    }

    impl Hand {
        fn new(arm: &'static [Dof], fingers: &'static [Dof]) -> Self {
            let settings = EstimatorSettings {
                smoothing: Smoothing::Off,
                ..EstimatorSettings::default()
            };
            let part = || Estimator::new(settings);
            Self {
                estimator: FusedEstimator::new(part(), part(), Duration::from_millis(200)),
                time: Timestamp::default(),
                measured: [arm, fingers],
            }
        }

        /// Takes readings of both parts for a second, in which an angle of one of them is loose. Returns the last estimate, and
        /// `true` if one jumped.
        fn take_second(&mut self, loose: Option<(HandPart, Dof)>) -> (Estimate, bool) {
            let mut jumped = false;
            for number in 0..200 {
                self.time.0 += 5_000;
                let part = HandPart::ALL[number % HandPart::COUNT];
                let mut angles = JointAngles::default();
                for &dof in self.measured[part.index()] {
                    let is_off = loose == Some((part, dof)) && number / 2 % 2 == 1;
                    angles.set(dof, if is_off { 1.0 } else { 0.1 });
                }
                let mut reading = Reading::new(self.time, None, Sample::Angles { angles });
                reading.part = Some(part);
                jumped |= self
                    .estimator
                    .update(&reading)
                    .is_ok_and(|estimate| estimate.jumped);
            }
            (self.estimator.estimate, jumped)
        }
    }

    #[test]
    fn an_unreliable_angle_of_the_arm_leaves_the_hand_nowhere_until_it_is_back() {
        let wrist = Dof::WristFlexion;
        // The second source of the fingers measures the wrist, too.
        for fingers in [
            &[Dof::IndexMcpFlexion] as &[Dof],
            &[Dof::IndexMcpFlexion, Dof::WristFlexion],
        ] {
            let mut hand = Hand::new(&[Dof::ElbowFlexion, Dof::WristFlexion], fingers);
            let (rest, _) = hand.take_second(None);
            assert!(rest.is_placed && rest.untrusted == FingerSet::NONE);
            let (loose, _) = hand.take_second(Some((HandPart::Arm, wrist)));
            assert!(!loose.is_placed);
            assert_eq!(loose.angles.is_known(wrist), fingers.contains(&wrist));
            assert!(loose.angles.is_known(Dof::ElbowFlexion));
            assert!(loose.angles.is_known(Dof::IndexMcpFlexion));
            let implausible = hand.estimator.implausible();
            assert!(implausible.angles.contains(wrist) && implausible.concerns_hand());
            let (repaired, jumped) = hand.take_second(None);
            assert!(repaired.is_placed && jumped);
            assert_eq!(repaired.angles, rest.angles);
        }
    }

    #[test]
    fn an_unreliable_angle_of_the_arm_that_the_source_of_the_fingers_measures_leaves_no_finger_trusted()
     {
        let wrist = Dof::WristFlexion;
        let mut hand = Hand::new(
            &[Dof::ElbowFlexion],
            &[Dof::IndexMcpFlexion, Dof::WristFlexion],
        );
        let (rest, _) = hand.take_second(None);
        assert!(rest.angles.is_known(wrist));
        let (loose, _) = hand.take_second(Some((HandPart::Fingers, wrist)));
        assert_eq!(loose.untrusted, FingerSet::ALL);
        assert!(!loose.angles.is_known(wrist));
        let (repaired, jumped) = hand.take_second(None);
        assert!(repaired.untrusted == FingerSet::NONE && jumped);
        assert_eq!(repaired.angles, rest.angles);
    }

    #[test]
    fn an_arm_that_its_source_no_longer_sees_leaves_the_hand_nowhere_until_it_is_back() {
        let estimator = || Estimator::new(EstimatorSettings::default());
        let mut hand = FusedEstimator::new(estimator(), estimator(), Duration::from_millis(200));
        let mut show = |milliseconds: u64, wrist: Option<DVec3>| {
            let mut positions = JointPositions::default();
            if let Some(position) = wrist {
                positions.set(Joint::Wrist, position);
            }
            let mut angles = JointAngles::default();
            angles.set(Dof::IndexMcpFlexion, 0.1);
            let samples = [Sample::Joints { positions }, Sample::Angles { angles }];
            let parts = [HandPart::Arm, HandPart::Fingers];
            let mut shown = Vec::new();
            for (sample, part) in samples.into_iter().zip(parts) {
                let time = Timestamp(1000 * milliseconds + part.index() as u64);
                let mut reading = Reading::new(time, None, sample);
                reading.part = Some(part);
                let estimate = hand.update(&reading).expect("a plausible reading");
                shown.push((estimate.is_placed, estimate.jumped));
            }
            shown
        };
        let still = [(true, false); HandPart::COUNT];
        show(1000, Some(DVec3::Y));
        assert_eq!(show(1050, Some(DVec3::Y)), still);
        assert_eq!(show(1100, None), still, "held");
        assert_eq!(show(1150, None), still, "held");
        for time in [1200, 1250] {
            assert_eq!(show(time, None), [(false, false); HandPart::COUNT]);
        }
        let back = show(1300, Some(DVec3::Y));
        assert_eq!(back, [(true, true), (true, false)]);
    }

    #[test]
    fn fingers_without_readings_make_the_movement_unknown_although_the_arm_is_seen() {
        for (missing, is_unknown) in [(140, false), (160, true)] {
            let estimator = || Estimator::new(EstimatorSettings::default());
            let timeout = Duration::from_millis(200);
            let mut hand = FusedEstimator::new(estimator(), estimator(), timeout);
            let mut is_after_gap = |part: HandPart, milliseconds: u64| {
                let mut angles = JointAngles::default();
                angles.set(Dof::IndexMcpFlexion, 0.1);
                let time = Timestamp(1000 * milliseconds);
                let mut reading = Reading::new(time, None, Sample::Angles { angles });
                reading.part = Some(part);
                let estimate = hand.update(&reading).expect("a plausible reading");
                assert_eq!(estimate.misses_bends, estimate.is_after_gap);
                estimate.is_after_gap
            };
            assert!(!is_after_gap(HandPart::Fingers, 5));
            for time in (10..missing).step_by(10) {
                assert!(!is_after_gap(HandPart::Arm, time), "{time} ms");
            }
            let end = 5 + missing;
            assert_eq!(is_after_gap(HandPart::Fingers, end), is_unknown);
            assert!(!is_after_gap(HandPart::Arm, end + 5));
            assert!(!is_after_gap(HandPart::Fingers, end + 10));
        }
    }

    #[test]
    fn a_hand_of_two_sources_is_stuck_if_both_repeat_positions_and_none_is_a_glove() {
        let arm_and_fingers = |is_glove: bool, trembling: Option<HandPart>| {
            let estimator = || Estimator::new(EstimatorSettings::default());
            let timeout = Duration::from_millis(200);
            let mut hand = FusedEstimator::new(estimator(), estimator(), timeout);
            for number in 0..700_u64 {
                let part = HandPart::ALL[number as usize % HandPart::COUNT];
                let tremor = if trembling == Some(part) { 1e-6 } else { 0.0 };
                let mut positions = JointPositions::default();
                positions.set(Joint::Wrist, DVec3::Y);
                positions.set(Joint::IndexTip, DVec3::X * tremor * (number / 2 % 2) as f64);
                let sample = if is_glove && part == HandPart::Fingers {
                    let mut angles = JointAngles::default();
                    angles.set(Dof::IndexMcpFlexion, 0.1);
                    Sample::Angles { angles }
                } else {
                    Sample::Joints { positions }
                };
                let time = Timestamp(1_000_000 + 10_000 * number);
                let mut reading = Reading::new(time, None, sample);
                reading.part = Some(part);
                hand.update(&reading).expect("a plausible reading");
                let is_before_limit = number * 10 <= 5_000;
                assert!(!(is_before_limit && hand.is_stuck()), "{number}");
            }
            hand.is_stuck()
        };
        assert!(arm_and_fingers(false, None));
        assert!(!arm_and_fingers(false, Some(HandPart::Arm)));
        assert!(!arm_and_fingers(false, Some(HandPart::Fingers)));
        assert!(!arm_and_fingers(true, None));
        let mut hand = Hand::new(&[Dof::ElbowFlexion], &[Dof::IndexMcpFlexion]);
        hand.take_second(None);
        assert!(!hand.estimator.is_stuck());
    }

    #[test]
    fn a_part_that_is_not_seen_does_not_hide_that_the_source_of_the_other_one_is_stuck() {
        for (seen, is_stuck) in [
            (Some(HandPart::Arm), true),
            (Some(HandPart::Fingers), true),
            (None, false),
        ] {
            let estimator = || Estimator::new(EstimatorSettings::default());
            let timeout = Duration::from_millis(200);
            let mut hand = FusedEstimator::new(estimator(), estimator(), timeout);
            for number in 0..700_u64 {
                let part = HandPart::ALL[number as usize % HandPart::COUNT];
                let mut positions = JointPositions::default();
                if number < 100 || seen == Some(part) {
                    positions.set(Joint::Wrist, DVec3::Y);
                    positions.set(Joint::IndexTip, DVec3::ZERO);
                }
                let time = Timestamp(1_000_000 + 10_000 * number);
                let mut reading = Reading::new(time, None, Sample::Joints { positions });
                reading.part = Some(part);
                hand.update(&reading).expect("a plausible reading");
            }
            assert_eq!(hand.is_stuck(), is_stuck, "{seen:?}");
        }
    }

    #[test]
    fn an_unreliable_angle_of_a_finger_concerns_that_finger_only() {
        let mut hand = Hand::new(
            &[Dof::ElbowFlexion],
            &[Dof::IndexMcpFlexion, Dof::MiddleMcpFlexion],
        );
        hand.take_second(None);
        let (loose, _) = hand.take_second(Some((HandPart::Fingers, Dof::IndexMcpFlexion)));
        assert_eq!(loose.untrusted, FingerSet::NONE.with(Finger::Index));
        assert!(loose.is_placed);
        assert!(!loose.angles.is_known(Dof::IndexMcpFlexion));
        assert!(loose.angles.is_known(Dof::MiddleMcpFlexion));
    }
}

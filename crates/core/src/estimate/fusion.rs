//! Fusion of an arm and its fingers, which two sources measure.

use std::time::Duration;

use super::{Estimate, Estimator, Implausible, MeasuredJoints, Rejection};
use crate::capture::Reading;
use crate::hand::{Dof, FingerSet, HandPart, Joint, JointAngles};
use crate::time::Timestamp;

/// The joints that the source of the arm places.
const ARM_JOINTS: [Joint; 3] = [Joint::Shoulder, Joint::Elbow, Joint::Wrist];

/// The estimator of a hand whose arm and fingers are measured by two sources.
///
/// Each part has an estimator, and so filters, of its own. An estimate combines the latest state of both: the source of
/// the arm provides the root, the angles up to the wrist and the positions of shoulder, elbow and wrist; the other source
/// provides the fingers, and the angles of the arm that the first does not measure. Measured positions of fingers move with
/// the wrist. The sources are aligned in time by `MergedSource`.
///
/// A part without a reading for longer than the timeout is lost: without the arm the hand is [nowhere](Estimate::is_placed),
/// without the fingers all of them are untrusted. The other part stays.
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
    /// The time of its latest reading; `None` while it is lost.
    seen_at: Option<Timestamp>,
    /// The latest state, which counts unless the part is lost.
    latest: Estimate,
}

impl Part {
    fn new(estimator: Estimator) -> Self {
        Self {
            estimator,
            seen_at: None,
            latest: Estimate::new(Timestamp::default(), JointAngles::default()),
        }
    }

    /// Returns the latest state unless the part is lost.
    fn state(&self) -> Option<&Estimate> {
        self.seen_at.map(|_| &self.latest)
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

    /// Converts a reading of its [part](Reading::part); one without a part is of the fingers. A rejected reading, such as one
    /// that is not later than the last of either part, changes nothing. Does not allocate.
    pub fn update(&mut self, reading: &Reading) -> Result<&Estimate, Rejection> {
        if self.last.is_some_and(|last| reading.time <= last) {
            return Err(Rejection::OutOfOrder);
        }
        let index = reading.part.unwrap_or(HandPart::Fingers).index();
        let part = &mut self.parts[index];
        part.latest = *part.estimator.update(reading)?;
        self.last = Some(reading.time);
        let is_back = part.seen_at.replace(reading.time).is_none();
        let mut jumped = is_back || part.latest.jumped;
        let other = &mut self.parts[1 - index];
        let timeout = self.timeout;
        let is_overdue = |seen_at: Timestamp| reading.time.since(seen_at) > timeout;
        jumped |= other
            .seen_at
            .take_if(|seen_at| is_overdue(*seen_at))
            .is_some();
        self.fuse(reading.time, jumped);
        Ok(&self.estimate)
    }

    /// Sets the time without a reading after which a part is lost.
    pub fn set_timeout(&mut self, timeout: Duration) {
        self.timeout = timeout;
    }

    /// Forgets a part whose source was lost. Returns the other part, or `None` if that is lost too.
    pub fn lose(&mut self, part: HandPart) -> Option<&Estimate> {
        self.parts[part.index()].seen_at = None;
        self.fuse(self.estimate.time, true);
        let is_seen = self.parts.iter().any(|it| it.seen_at.is_some());
        is_seen.then_some(&self.estimate)
    }

    /// Forgets both parts.
    pub fn lose_all(&mut self) {
        for part in &mut self.parts {
            part.seen_at = None;
        }
        self.estimate.lose_hand();
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
        arm.seen_at.map(|_| &arm.estimator)
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
        let [arm, fingers] = parts.each_ref().map(Part::state);
        estimate.reset(time);
        estimate.jumped = jumped;
        estimate.is_placed = arm.is_some_and(|arm| arm.is_placed);
        estimate.untrusted = fingers.map_or(FingerSet::ALL, |fingers| fingers.untrusted);
        if let Some(arm) = arm {
            estimate.root = arm.root;
            estimate.displacement = arm.displacement;
            estimate.inputs = arm.inputs;
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
        if let Some(fingers) = fingers {
            add_fingers(fingers, estimate);
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

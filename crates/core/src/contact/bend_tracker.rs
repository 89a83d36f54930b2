//! Contact by bending: fingers that press their targets wherever the hand is.

use parry3d::math::Vec2;

use super::surface::{Scene, Target};
use super::{Phase, TargetId, Touch, Touches};
use crate::estimate::FingerBends;
use crate::hand::{Finger, FingerSet, Side};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// A tracker of the bends of the fingers of one hand, for the targets that a finger presses by bending.
///
/// A finger presses its target when its bend reaches the press point, and releases it when it is back at the release point;
/// in between nothing changes. A finger that is bent when it is first seen (new layout, [`reset`](Self::reset), jump, trusted
/// again) must be straight once, at the release point or below, before it presses.
#[derive(Clone, Debug, Default)]
pub struct BendTracker {
    side: Option<Side>,
    /// The time of the last pose.
    time: Timestamp,
    fingers: [FingerState; Finger::COUNT],
}

#[derive(Clone, Copy, Debug, Default)]
struct FingerState {
    /// The last bend; of no meaning while the finger is not known.
    bend: f32,
    contact: Contact,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Contact {
    /// Not seen straight since it was lost.
    #[default]
    Unknown,
    Straight,
    Pressed(TargetId),
}

/// The data of one step that the fingers share.
struct StepContext<'a> {
    side: Side,
    start: Timestamp,
    end: Timestamp,
    touches: &'a mut Touches,
}

impl BendTracker {
    /// Processes the bends at the next pose and appends the changes to `touches`: at most 3 for each finger, in order of time
    /// for each finger. Does not allocate.
    pub fn update(
        &mut self,
        scene: &Scene,
        pose: &HandPose,
        bends: &FingerBends,
        touches: &mut Touches,
    ) {
        let mut step = StepContext {
            side: pose.side,
            start: self.time,
            end: pose.time,
            touches,
        };
        self.side = Some(pose.side);
        self.time = pose.time;
        for (state, &finger) in self.fingers.iter_mut().zip(Finger::ALL) {
            let bend = trusted_bend(pose, bends, finger).filter(|_| !pose.jumped);
            match (scene.bend_target(pose.side, finger), bend) {
                (Some((id, target)), Some(bend)) => {
                    state.update(finger, id, target, bend, &mut step)
                }
                _ => state.lose(finger, &mut step),
            }
        }
    }

    /// Cancels every touch at `time`, appends the cancellations to `touches`, and forgets the last bends.
    pub fn reset(&mut self, time: Timestamp, touches: &mut Touches) {
        let mut step = StepContext {
            side: self.side.unwrap_or(Side::Right),
            start: time,
            end: time,
            touches,
        };
        for (state, &finger) in self.fingers.iter_mut().zip(Finger::ALL) {
            state.lose(finger, &mut step);
        }
        self.time = time;
    }

    /// Returns `true` if no finger presses a target.
    pub fn is_idle(&self) -> bool {
        self.pressed().next().is_none()
    }

    /// Iterates over the targets that fingers press.
    pub fn pressed(&self) -> impl Iterator<Item = TargetId> + '_ {
        self.fingers.iter().filter_map(|state| match state.contact {
            Contact::Pressed(target) => Some(target),
            Contact::Unknown | Contact::Straight => None,
        })
    }
}

impl FingerState {
    fn update(
        &mut self,
        finger: Finger,
        id: TargetId,
        target: &Target,
        bend: f32,
        step: &mut StepContext,
    ) {
        let before = std::mem::replace(&mut self.bend, bend);
        // The fraction of the step at which the finger passed a bend.
        let at = |level: f32| ((level - before) / (bend - before)).clamp(0.0, 1.0);
        match self.contact {
            Contact::Unknown | Contact::Straight if bend <= target.release_at => {
                self.contact = Contact::Straight;
            }
            Contact::Straight if bend >= target.press_at => {
                self.contact = Contact::Pressed(id);
                let t = at(target.press_at);
                step.emit(t, finger, id, Phase::Touched, 0.0);
                step.emit(t, finger, id, Phase::Pressed, target.press_at);
                step.emit(1.0, finger, id, Phase::Moved, bend);
            }
            Contact::Pressed(pressed) if bend <= target.release_at => {
                self.contact = Contact::Straight;
                let t = at(target.release_at);
                step.emit(t, finger, pressed, Phase::Released, target.release_at);
                step.emit(t, finger, pressed, Phase::Left, 0.0);
            }
            Contact::Pressed(pressed) if bend != before => {
                step.emit(1.0, finger, pressed, Phase::Moved, bend);
            }
            Contact::Unknown | Contact::Straight | Contact::Pressed(_) => {}
        }
    }

    fn lose(&mut self, finger: Finger, step: &mut StepContext) {
        if let Contact::Pressed(id) = std::mem::take(&mut self.contact) {
            step.emit(1.0, finger, id, Phase::Cancelled, 0.0);
        }
    }
}

impl StepContext<'_> {
    fn emit(&mut self, t: f32, finger: Finger, target: TargetId, phase: Phase, depth: f32) {
        // There is room for 6 per finger, and a finger has 3 at most.
        let _ = self.touches.try_push(Touch {
            time: self.start.lerp(self.end, t),
            side: self.side,
            finger,
            target,
            phase,
            depth,
            position: Vec2::ZERO,
        });
    }
}

/// Returns the fingers of a hand that are bent beyond the release point of their target, and `true` if the bend of any finger is
/// known.
pub fn bent_fingers(scene: &Scene, pose: &HandPose, bends: &FingerBends) -> (FingerSet, bool) {
    let (mut bent, mut is_seen) = (FingerSet::NONE, false);
    for &finger in Finger::ALL {
        let Some(bend) = trusted_bend(pose, bends, finger) else {
            continue;
        };
        is_seen = true;
        let target = scene.bend_target(pose.side, finger);
        if target.is_some_and(|(_, target)| bend > target.release_at) {
            bent = bent.with(finger);
        }
    }
    (bent, is_seen)
}

/// Returns the bend of a finger that may press, or `None` if it is not known or untrusted.
fn trusted_bend(pose: &HandPose, bends: &FingerBends, finger: Finger) -> Option<f32> {
    let bend = bends.get(finger).filter(|bend| bend.is_finite());
    bend.filter(|_| !pose.untrusted.contains(finger))
}

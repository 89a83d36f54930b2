//! The depth of analog keys.

use arrayvec::ArrayVec;

use crate::contact::{Phase, TargetId, Touch};
use crate::device::{DeviceOutput, EventKind};
use crate::hand::{FINGERS_OF_BOTH_HANDS, Finger};
use crate::time::Timestamp;

/// Emits the depth of each analog key when it changes.
#[derive(Clone, Debug, Default)]
pub(super) struct DepthReporter {
    /// The target of each finger and its depth, as a fraction of the travel.
    fingers: [Option<(TargetId, f32)>; FINGERS_OF_BOTH_HANDS],
    /// The depths emitted last, other than 0; at most one target per finger.
    emitted: ArrayVec<(TargetId, f32), FINGERS_OF_BOTH_HANDS>,
}

impl DepthReporter {
    /// Updates the depth of a touch of an analog key.
    pub(super) fn update(&mut self, touch: &Touch) {
        let finger = &mut self.fingers[touch.side.index() * Finger::COUNT + touch.finger.index()];
        let is_on_target = finger.is_some_and(|(target, _)| target == touch.target);
        match touch.phase {
            Phase::Touched | Phase::Pressed => *finger = Some((touch.target, touch.depth)),
            Phase::Moved | Phase::Released if is_on_target => {
                *finger = Some((touch.target, touch.depth));
            }
            Phase::Left | Phase::Cancelled if is_on_target => *finger = None,
            // A touch that began before the last reset does not count.
            _ => {}
        }
    }

    /// Forgets all fingers. The next [`emit`](Self::emit) emits depth 0 for their targets.
    pub(super) fn reset(&mut self) {
        self.fingers = [None; FINGERS_OF_BOTH_HANDS];
    }

    /// Emits each depth that has changed, depths of 0 first. A depth that does not fit into the event list is retried
    /// by the next call.
    pub(super) fn emit(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let fingers = self.fingers;
        let mut emit =
            |target: TargetId, depth: f32| out.emit(time, EventKind::Depth(target, depth));
        self.emitted
            .retain(|(target, _)| max_depth(&fingers, *target) > 0.0 || !emit(*target, 0.0));
        for &(target, _) in fingers.iter().flatten() {
            let depth = max_depth(&fingers, target);
            let emitted = self.emitted.iter_mut().find(|(other, _)| *other == target);
            if let Some((_, emitted)) = emitted {
                if *emitted != depth && emit(target, depth) {
                    *emitted = depth;
                }
            } else if depth > 0.0 && !self.emitted.is_full() && emit(target, depth) {
                self.emitted.push((target, depth));
            }
        }
    }
}

/// Returns the depth of the deepest finger on a target.
fn max_depth(fingers: &[Option<(TargetId, f32)>], target: TargetId) -> f32 {
    let on_target = fingers
        .iter()
        .flatten()
        .filter(|(other, _)| *other == target);
    on_target.fold(0.0, |max, &(_, depth)| max.max(depth))
}

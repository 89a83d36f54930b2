//! How far analogue keys are pushed in.

use arrayvec::ArrayVec;

use crate::contact::{Phase, TargetId, Touch};
use crate::device::{DeviceOutput, EventKind};
use crate::hand::{FINGERS_OF_BOTH_HANDS, Finger};
use crate::time::Timestamp;

/// The depth of each analogue target that is pushed in, and what was told of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Depths {
    /// The target that each finger pushes in, and its share of the travel.
    fingers: [Option<(TargetId, f32)>; FINGERS_OF_BOTH_HANDS],
    /// The depths other than 0 that went out last: a target for each finger.
    told: ArrayVec<(TargetId, f32), FINGERS_OF_BOTH_HANDS>,
}

impl Depths {
    /// Takes note of a touch of an analogue target.
    pub(super) fn take(&mut self, touch: &Touch) {
        let finger = &mut self.fingers[touch.side.index() * Finger::COUNT + touch.finger.index()];
        let is_on_it = finger.is_some_and(|(target, _)| target == touch.target);
        match touch.phase {
            Phase::Touched | Phase::Pressed => *finger = Some((touch.target, touch.depth)),
            Phase::Moved | Phase::Released if is_on_it => {
                *finger = Some((touch.target, touch.depth));
            }
            Phase::Left | Phase::Cancelled if is_on_it => *finger = None,
            // A touch that began before everything was let go of counts for nothing.
            _ => {}
        }
    }

    /// Forgets every finger.
    pub(super) fn forget(&mut self) {
        self.fingers = [None; FINGERS_OF_BOTH_HANDS];
    }

    /// Sends each depth that is new, those that became 0 first. What finds no room is tried again
    /// next time.
    pub(super) fn tell(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let fingers = self.fingers;
        let mut send =
            |target: TargetId, depth: f32| out.emit(time, EventKind::Depth(target, depth));
        self.told
            .retain(|(target, _)| deepest(&fingers, *target) > 0.0 || !send(*target, 0.0));
        for &(target, _) in fingers.iter().flatten() {
            let depth = deepest(&fingers, target);
            let told = self.told.iter_mut().find(|(other, _)| *other == target);
            if let Some((_, told)) = told {
                if *told != depth && send(target, depth) {
                    *told = depth;
                }
            } else if depth > 0.0 && !self.told.is_full() && send(target, depth) {
                self.told.push((target, depth));
            }
        }
    }
}

/// Of several fingers on one target the deepest counts.
fn deepest(fingers: &[Option<(TargetId, f32)>], target: TargetId) -> f32 {
    let on_it = fingers
        .iter()
        .flatten()
        .filter(|(other, _)| *other == target);
    on_it.fold(0.0, |deepest, &(_, depth)| deepest.max(depth))
}

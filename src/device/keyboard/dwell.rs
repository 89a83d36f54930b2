//! Keys that fire when a fingertip rests on them.

use super::{Activation, KeyBinding, Keyboard, PressSource};
use crate::contact::{Phase, Touch};
use crate::device::DeviceOutput;
use crate::time::Timestamp;

/// A fingertip that rests on a key and has not fired it yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dwell {
    owner: PressSource,
    /// The place of the key's binding.
    place: usize,
    due: Timestamp,
}

impl Keyboard {
    /// Takes note of fingertips that come to rest on keys or leave them. One that leaves late enough has
    /// rested long enough; one that slides off or is lost has not.
    pub(super) fn take_dwells(&mut self, touches: &[Touch], out: &mut DeviceOutput) {
        for touch in touches {
            let owner = PressSource::from_touch(touch);
            match touch.phase {
                Phase::Touched => self.begin_dwell(touch, owner),
                Phase::Left | Phase::Cancelled => {
                    if touch.phase == Phase::Left {
                        self.dwell_where(touch.time, |dwell| dwell.owner == owner, out);
                    }
                    self.dwells.retain(|dwell| dwell.owner != owner);
                }
                _ => {}
            }
        }
    }

    /// Fires what has been rested on long enough by `time`.
    pub(super) fn dwell_by(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.dwell_where(time, |_| true, out);
    }

    fn begin_dwell(&mut self, touch: &Touch, owner: PressSource) {
        let Some(place) = self.places.of(touch.target) else {
            return;
        };
        if let KeyBinding {
            activation: Activation::Dwell(after),
            ..
        } = self.bindings[place]
        {
            // Each finger is on one target at most, so there is room.
            let _ = self.dwells.try_push(Dwell {
                owner,
                place,
                due: touch.time + after,
            });
        }
    }

    fn dwell_where(
        &mut self,
        time: Timestamp,
        is_meant: impl Fn(&Dwell) -> bool,
        out: &mut DeviceOutput,
    ) {
        let is_due = |dwell: &Dwell| dwell.due <= time && is_meant(dwell);
        while let Some(at) = self.dwells.iter().position(is_due) {
            let Dwell { owner, place, due } = self.dwells.remove(at);
            let KeyBinding {
                target,
                debounce: repress,
                ..
            } = self.bindings[place];
            if self.bounces.is_bounce(place, due, repress) {
                continue;
            }
            self.press_gathered(due, out);
            self.hold_for_another_key(due, out);
            if let Some(action) = self.action(target, out.arbiter.active_layer()) {
                out.tap(owner, action, due);
                self.bounces.came_up(place, due);
            }
        }
    }
}

//! Keys that fire when a fingertip rests on them.

use super::{Fires, KeyBinding, Keyboard, Owner};
use crate::contact::{Phase, Touch};
use crate::device::Out;
use crate::time::Timestamp;

/// A fingertip that rests on a key and has not fired it yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dwell {
    owner: Owner,
    /// The place of the key's binding.
    place: usize,
    due: Timestamp,
}

impl Keyboard {
    /// Takes note of fingertips that come to rest on keys or leave them. One that leaves late enough has
    /// rested long enough; one that slides off or is lost has not.
    pub(super) fn take_dwells(&mut self, touches: &[Touch], out: &mut Out) {
        for touch in touches {
            let owner = Owner::of(touch);
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
    pub(super) fn dwell_by(&mut self, time: Timestamp, out: &mut Out) {
        self.dwell_where(time, |_| true, out);
    }

    fn begin_dwell(&mut self, touch: &Touch, owner: Owner) {
        let Some(place) = self.places.of(touch.target) else {
            return;
        };
        if let KeyBinding {
            fires: Fires::Dwell(after),
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

    fn dwell_where(&mut self, time: Timestamp, is_meant: impl Fn(&Dwell) -> bool, out: &mut Out) {
        let is_due = |dwell: &Dwell| dwell.due <= time && is_meant(dwell);
        while let Some(at) = self.dwells.iter().position(is_due) {
            let Dwell { owner, place, due } = self.dwells.remove(at);
            let KeyBinding {
                target, repress, ..
            } = self.bindings[place];
            if self.bounces.is_bounce(place, due, repress) {
                continue;
            }
            self.press_gathered(due, out);
            self.hold_for_another_key(due, out);
            if let Some(action) = self.action(target, out.switchboard.layer()) {
                out.tap(owner, action, due);
                self.bounces.came_up(place, due);
            }
        }
    }
}

//! Keys that fire when a fingertip rests on them.

use super::{Activation, KeyBinding, Keyboard, PressSource};
use crate::contact::{Phase, Touch};
use crate::device::DeviceOutput;
use crate::time::Timestamp;

/// A fingertip that rests on a key and has not fired it yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingDwell {
    source: PressSource,
    /// The index of the key's binding.
    key: usize,
    due: Timestamp,
}

impl Keyboard {
    /// Starts and ends dwells. A fingertip that leaves a key after its dwell time fires it; one that slides
    /// off or is lost does not.
    pub(super) fn update_dwells(&mut self, touches: &[Touch], out: &mut DeviceOutput) {
        for touch in touches {
            let source = PressSource::from_touch(touch);
            match touch.phase {
                Phase::Touched => self.begin_dwell(touch, source),
                Phase::Left | Phase::Cancelled => {
                    if touch.phase == Phase::Left {
                        self.fire_dwells_where(
                            |_, dwell| dwell.source == source && dwell.due <= touch.time,
                            out,
                        );
                    }
                    self.dwells.retain(|dwell| dwell.source != source);
                }
                _ => {}
            }
        }
    }

    /// Fires the dwells that are due by the latest pose of their hand.
    pub(super) fn fire_due_dwells(&mut self, out: &mut DeviceOutput) {
        self.fire_dwells_where(
            |keyboard, dwell| dwell.due <= keyboard.seen_until(dwell.source),
            out,
        );
    }

    fn begin_dwell(&mut self, touch: &Touch, source: PressSource) {
        let Some(key) = self.index.get(touch.target) else {
            return;
        };
        if let Activation::Dwell(dwell_time) = self.bindings[key].activation {
            // Each finger is on one target at most, so there is room.
            let _ = self.dwells.try_push(PendingDwell {
                source,
                key,
                due: touch.time + dwell_time,
            });
        }
    }

    fn fire_dwells_where(
        &mut self,
        is_due: impl Fn(&Self, &PendingDwell) -> bool,
        out: &mut DeviceOutput,
    ) {
        let next = |keyboard: &Self| {
            let mut dwells = keyboard.dwells.iter();
            dwells.position(|dwell| is_due(keyboard, dwell))
        };
        while let Some(index) = next(self) {
            let PendingDwell { source, key, due } = self.dwells.remove(index);
            let KeyBinding {
                target, debounce, ..
            } = self.bindings[key];
            if self.debouncer.is_bounce(key, due, debounce) {
                continue;
            }
            self.press_gathered(due, out);
            self.hold_pending(due, out);
            if let Some(action) = self.action_of_press(source, target, due, out) {
                out.tap(source, action, due);
                self.debouncer.record_release(key, due);
            }
        }
    }
}

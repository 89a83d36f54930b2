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
                        self.fire_dwells_where(touch.time, |dwell| dwell.source == source, out);
                    }
                    self.dwells.retain(|dwell| dwell.source != source);
                }
                _ => {}
            }
        }
    }

    /// Fires the dwells that are due by `time`.
    pub(super) fn fire_due_dwells(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.fire_dwells_where(time, |_| true, out);
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
        time: Timestamp,
        matches: impl Fn(&PendingDwell) -> bool,
        out: &mut DeviceOutput,
    ) {
        let is_due = |dwell: &PendingDwell| dwell.due <= time && matches(dwell);
        while let Some(index) = self.dwells.iter().position(is_due) {
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

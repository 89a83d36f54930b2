//! Presses that are pending: not yet known to be a tap, a hold, or nothing.

use super::{Activation, KeyAction, Keyboard, PressSource, TapHold};
use crate::contact::Touch;
use crate::device::{DeviceOutput, Latch};
use crate::time::Timestamp;

/// A press that has not fired yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingPress {
    pub(super) source: PressSource,
    /// The action of a tap.
    tap: KeyAction,
    /// The time at which it becomes a hold, and the action then.
    hold: Option<(Timestamp, KeyAction)>,
}

impl PendingPress {
    /// Returns the pending press at `time`, or `None` if the action is active at once.
    pub(super) fn new(
        source: PressSource,
        action: KeyAction,
        activation: Activation,
        time: Timestamp,
    ) -> Option<Self> {
        let hold = match (action, activation) {
            (action, _) if is_active_while_pressed(action) => return None,
            (_, Activation::OnPress | Activation::Dwell(_)) => return None,
            (_, Activation::OnRelease) => None,
            (
                _,
                Activation::TapHold(TapHold {
                    hold_action,
                    hold_after,
                }),
            ) => Some((time + hold_after, momentary(hold_action))),
        };
        Some(Self {
            source,
            tap: action,
            hold,
        })
    }

    /// Returns the layer that it holds when it becomes a hold, if any.
    pub(super) fn held_layer(&self) -> Option<usize> {
        match self.hold?.1 {
            KeyAction::Layer(layer, _) => Some(layer),
            _ => None,
        }
    }
}

/// Returns `true` if an action only has an effect while it is pressed, so that it cannot be pending.
fn is_active_while_pressed(action: KeyAction) -> bool {
    !matches!(
        action,
        KeyAction::Key(_)
            | KeyAction::Text(_)
            | KeyAction::Multitap(_)
            | KeyAction::Sequence(_)
            | KeyAction::Command(_)
    )
}

/// Returns the action with its latch, if any, set to [`Latch::Momentary`].
fn momentary(action: KeyAction) -> KeyAction {
    match action {
        KeyAction::Modifier(code, _) => KeyAction::Modifier(code, Latch::Momentary),
        KeyAction::Layer(layer, _) => KeyAction::Layer(layer, Latch::Momentary),
        action => action,
    }
}

impl Keyboard {
    /// Returns `true` if a press from this source is pending.
    fn is_pending(&self, source: PressSource) -> bool {
        self.pending.iter().any(|press| press.source == source)
    }

    /// Returns `true` if the press of a touch is pending, or would be if it began now.
    pub(super) fn is_or_would_be_pending(&self, touch: &Touch, out: &DeviceOutput) -> bool {
        let source = PressSource::from_touch(touch);
        let binding = self.binding(touch.target);
        let would_be = binding.is_some_and(|it| it.activation != Activation::OnPress)
            || self.chords.is_or_would_be_gathered(touch, source);
        let chord = self.chords.source_of_chord(source);
        if self.is_pending(chord.unwrap_or(source)) {
            return true;
        }
        would_be && !out.arbiter.has_press_from(source)
    }

    /// Turns the pending presses that are due by the latest poses of their fingers into holds.
    pub(super) fn hold_due(&mut self, out: &mut DeviceOutput) {
        self.hold_where(
            |keyboard, source, due| (due <= keyboard.seen_until(source)).then_some(due),
            out,
        );
    }

    /// Turns all pending tap-hold presses into holds because another key is pressed at `time`.
    pub(super) fn hold_pending(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.hold_where(|_, _, due| Some(due.min(time)), out);
    }

    /// Turns pending presses into holds: each at the time that `hold_time` returns for its source and its due time, unless that is
    /// `None`.
    fn hold_where(
        &mut self,
        hold_time: impl Fn(&Self, PressSource, Timestamp) -> Option<Timestamp>,
        out: &mut DeviceOutput,
    ) {
        let mut index = 0;
        while let Some(press) = self.pending.get(index) {
            let source = press.source;
            let hold = press
                .hold
                .and_then(|(due, action)| Some((hold_time(self, source, due)?, action)));
            let is_fired = hold.is_some_and(|(time, action)| self.fire(index, action, time, out));
            index += usize::from(!is_fired);
        }
    }

    /// Fires the pending press of a source that is released at `time`: as a tap, or as a hold that was due
    /// since the last step.
    pub(super) fn fire_on_release(
        &mut self,
        source: PressSource,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let Some(index) = self.pending.iter().position(|it| it.source == source) else {
            return;
        };
        match self.pending[index].hold {
            Some((due, action)) if due <= time => self.fire(index, action, due, out),
            _ => self.fire(index, self.pending[index].tap, time, out),
        };
    }

    /// Presses the action of a pending press. If it does not fit into the event list, the press stays
    /// pending and the result is `false`.
    fn fire(
        &mut self,
        index: usize,
        action: KeyAction,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) -> bool {
        let is_pressed = out.press(self.pending[index].source, action, time);
        if is_pressed {
            self.pending.remove(index);
        }
        is_pressed
    }
}

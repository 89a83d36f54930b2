//! Presses that do nothing until it is known what they are: a tap, a hold, or nothing.

use super::{Activation, KeyAction, Keyboard, PressSource, TapHold};
use crate::contact::Touch;
use crate::device::{DeviceOutput, Latch};
use crate::time::Timestamp;

/// A press that waits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    pub(super) owner: PressSource,
    /// What it does when it is let go of in time.
    tap: KeyAction,
    /// When it becomes a hold, and of what.
    hold: Option<(Timestamp, KeyAction)>,
}

impl Waiting {
    /// What a press at `time` waits for; `None` if it is in force at once.
    pub(super) fn of(
        owner: PressSource,
        action: KeyAction,
        fires: Activation,
        time: Timestamp,
    ) -> Option<Self> {
        let hold = match (action, fires) {
            (action, _) if acts_while_pressed(action) => return None,
            (_, Activation::OnPress | Activation::Dwell(_)) => return None,
            (_, Activation::OnRelease) => None,
            (
                _,
                Activation::TapHold(TapHold {
                    hold_action: action,
                    hold_after: after,
                }),
            ) => Some((time + after, while_pressed(action))),
        };
        Some(Self {
            owner,
            tap: action,
            hold,
        })
    }
}

/// Whether there is nothing to wait for: it means something only as long as it is pressed.
fn acts_while_pressed(action: KeyAction) -> bool {
    !matches!(
        action,
        KeyAction::Key(_) | KeyAction::Text(_) | KeyAction::Ask(_)
    )
}

fn while_pressed(action: KeyAction) -> KeyAction {
    match action {
        KeyAction::Modifier(code, _) => KeyAction::Modifier(code, Latch::Momentary),
        KeyAction::Layer(layer, _) => KeyAction::Layer(layer, Latch::Momentary),
        action => action,
    }
}

impl Keyboard {
    /// Whether a press of this owner waits.
    pub(super) fn is_pending(&self, owner: PressSource) -> bool {
        self.waiting.iter().any(|press| press.owner == owner)
    }

    /// Whether the press of a touch waits, or would if it began now.
    pub(super) fn is_waiting(&self, touch: &Touch, out: &DeviceOutput) -> bool {
        let owner = PressSource::from_touch(touch);
        let binding = self.binding(touch.target);
        let would_wait = binding.is_some_and(|binding| binding.activation != Activation::OnPress)
            || self.chords.is_waiting(touch, owner);
        self.is_pending(owner) || would_wait && !out.arbiter.has_press_from(owner)
    }

    /// Holds what has been pressed long enough by `time`.
    pub(super) fn hold_by(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.hold_where(|due| (due <= time).then_some(due), out);
    }

    /// Another key is pressed at `time`: what can be held is held from now on.
    pub(super) fn hold_for_another_key(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.hold_where(|due| Some(due.min(time)), out);
    }

    /// Holds each press at the time that `when` gives for the time that it is due.
    fn hold_where(
        &mut self,
        when: impl Fn(Timestamp) -> Option<Timestamp>,
        out: &mut DeviceOutput,
    ) {
        let mut place = 0;
        while let Some(press) = self.waiting.get(place) {
            let due = press
                .hold
                .and_then(|(due, action)| Some((when(due)?, action)));
            let is_decided =
                due.is_some_and(|(time, action)| self.decide(place, action, time, out));
            place += usize::from(!is_decided);
        }
    }

    /// Fires the press of a finger that lets go at `time`, if it waits: a tap, or a hold that was
    /// due since the frame before.
    pub(super) fn fire(&mut self, owner: PressSource, time: Timestamp, out: &mut DeviceOutput) {
        let Some(place) = self.waiting.iter().position(|press| press.owner == owner) else {
            return;
        };
        match self.waiting[place].hold {
            Some((due, action)) if due <= time => self.decide(place, action, due, out),
            _ => self.decide(place, self.waiting[place].tap, time, out),
        };
    }

    /// Puts an action in force for a press that waits. Without room it waits on, and `false` comes back.
    fn decide(
        &mut self,
        place: usize,
        action: KeyAction,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) -> bool {
        let is_pressed = out.press(self.waiting[place].owner, action, time);
        if is_pressed {
            self.waiting.remove(place);
        }
        is_pressed
    }
}

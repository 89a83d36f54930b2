//! The events of one step, as a text decoder changes them.

use crate::Edit;

use super::burst;
use super::keys::TextKeys;
use ademan_core::device::pressed_keys::PressedKeys;
use ademan_core::device::{EventKind, Events, KeyCode, OutputEvent};
use ademan_core::time::Timestamp;

/// The events of a step.
pub(super) struct Step {
    /// The keys that are down at this event.
    held: PressedKeys,
    /// The keys among them whose events are taps: they are up.
    pub(super) tapped: PressedKeys,
    /// The number of events that follow.
    pub(super) waiting: usize,
    pub(super) events: Events,
}

impl Step {
    /// Creates a step without events; `held` are the keys that controls hold before it.
    pub(super) fn new(held: &PressedKeys, tapped: &PressedKeys, waiting: usize) -> Self {
        let mut step = Self {
            held: PressedKeys::default(),
            tapped: PressedKeys::default(),
            waiting,
            events: Events::new(),
        };
        for key in held.release_order() {
            if tapped.contains(key) {
                step.tapped.press(key)
            } else {
                step.held.press(key)
            };
        }
        step
    }

    /// Appends an event as it is.
    pub(super) fn push(&mut self, event: OutputEvent) {
        match event.kind {
            EventKind::KeyDown(key) => _ = self.held.press(key),
            EventKind::KeyUp(key) => {
                self.held.release(key);
                self.tapped.release(key);
            }
            _ => {}
        }
        let _ = self.events.try_push(event);
    }

    /// Appends an event, and the release of its key unless that is held by another control.
    pub(super) fn tap(&mut self, event: OutputEvent) {
        match event.kind {
            EventKind::KeyDown(key) if self.held.contains(key) => {}
            EventKind::KeyDown(key) if self.events.remaining_capacity() > self.waiting + 1 => {
                let kind = EventKind::KeyUp(key);
                self.events.push(event);
                self.events.push(OutputEvent { kind, ..event });
                self.tapped.press(key);
            }
            _ => self.push(event),
        }
    }

    /// Leaves the press of an event out. Its release is left out too.
    pub(super) fn swallow(&mut self, event: OutputEvent) {
        if let EventKind::KeyDown(key) = event.kind {
            self.tapped.press(key);
        }
    }

    /// Appends the edits of a pressed character, the first of which types it. Returns `false`, and appends nothing, if they cannot be
    /// typed.
    pub(super) fn append_press(
        &mut self,
        edits: &[Edit],
        keys: &TextKeys,
        event: OutputEvent,
    ) -> bool {
        let (tail, is_typed) = match edits {
            [_] => (&[][..], true),
            // The new tail ends with the pressed character, which need not be typed twice.
            [pressed, Edit::Backspace, tail @ .., last] if last == pressed => (tail, true),
            [_, Edit::Backspace, tail @ ..] => (tail, false),
            // Letters follow the pressed one, which comes before them.
            [_, Edit::Type(_), ..] => (edits, false),
            _ => return false,
        };
        if !self.append(tail, keys, event.time) {
            return false;
        }
        if is_typed {
            self.tap(event);
        } else {
            self.swallow(event);
        }
        true
    }

    /// Appends edits; before a Shift that goes down in this step for what follows.
    pub(super) fn append(&mut self, edits: &[Edit], keys: &TextKeys, time: Timestamp) -> bool {
        let shift = match self.events.last().map(|event| event.kind) {
            Some(EventKind::KeyDown(key)) if key.is_shift() => {
                self.held.release(key);
                self.events.pop()
            }
            _ => None,
        };
        let waiting = self.waiting + usize::from(shift.is_some());
        let is_appended = burst::append(edits, keys, &self.held, time, waiting, &mut self.events);
        if let Some(event) = shift {
            self.push(event);
        }
        is_appended
    }

    pub(super) fn is_shifted(&self) -> bool {
        self.held.release_order().any(KeyCode::is_shift)
    }

    /// Returns `true` if a modifier other than Shift is down.
    pub(super) fn has_shortcut(&self) -> bool {
        let mut held = self.held.release_order();
        held.any(|key| key.is_modifier() && !key.is_shift())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::contact::TargetId;
    use ademan_core::layout::Layout;

    fn key(name: &str) -> KeyCode {
        name.parse().expect("the name of a key")
    }

    fn phone_keys() -> TextKeys {
        let mut shipped = Layout::shipped().expect("valid layouts").into_iter();
        let found = shipped.find(|(name, _)| *name == "phone-pad");
        let (_, layout) = found.expect("a layout");
        TextKeys::new(&layout, false).expect("letters")
    }

    #[test]
    fn letters_after_the_pressed_one_are_typed_with_it() {
        let keys = phone_keys();
        let [first, second] = ["M", "A"].map(key);
        let none = PressedKeys::default();
        let mut step = Step::new(&none, &none, 0);
        let press = OutputEvent {
            time: Timestamp(1_000),
            kind: EventKind::KeyDown(first),
        };
        // `diplom` is read as `diploma`.
        assert!(step.append_press(&['m', 'a'].map(Edit::Type), &keys, press));
        let kinds: Vec<EventKind> = step.events.iter().map(|event| event.kind).collect();
        let tap = |code| [EventKind::KeyDown(code), EventKind::KeyUp(code)];
        assert_eq!(kinds, [tap(first), tap(second)].concat());
        assert!(step.tapped.contains(first), "its release is left out");
    }

    #[test]
    fn a_shift_that_is_held_comes_up_for_edits_after_values_but_not_after_presses() {
        let keys = phone_keys();
        let mut held = PressedKeys::default();
        held.press(KeyCode::SHIFT_LEFT);
        let time = Timestamp(1_000);
        for (kind, is_appended) in [
            (EventKind::Value(TargetId(0), 0.5), true),
            (EventKind::Depth(TargetId(0), 0.5), true),
            (EventKind::KeyDown(key("X")), false),
        ] {
            let mut step = Step::new(&held, &PressedKeys::default(), 0);
            step.push(OutputEvent { time, kind });
            let edits = [Edit::Backspace, Edit::Type('a')];
            assert_eq!(step.append(&edits, &keys, time), is_appended, "{kind:?}");
            assert_eq!(step.events.len() > 1, is_appended, "{kind:?}");
        }
    }
}

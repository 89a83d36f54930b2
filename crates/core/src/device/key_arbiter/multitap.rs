//! Multitap keys: taps in a row choose one of several letters.

use std::time::Duration;

use arrayvec::ArrayVec;

use super::one_shots::ArmedModifier;
use super::sequence::Performer;
use super::{KeyAction, KeyArbiter, MODIFIER_COUNT, Press, PressSource, SequenceHand};
use crate::device::{Capabilities, Capability, EventKind, Events, KeyCode};
use crate::hand::Side;
use crate::time::Timestamp;

/// The letters of one key.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Multitap {
    /// The letters as displays write them.
    pub label: String,
    /// The letters, at least one, in the order of the taps: [`KeyAction::Key`] with a key that types a character, or
    /// [`KeyAction::Text`] with one character.
    pub letters: Vec<KeyAction>,
}

impl Multitap {
    /// Returns `true` if the first two taps type letters of words, and not signs.
    pub fn has_word_letters(&self) -> bool {
        let mut first = self.letters.iter().take(2);
        self.letters.len() > 1 && first.all(|letter| letter.types_letter())
    }

    /// Returns the characters that one tap may mean if a text decoder finds the letters: all letters of a key of letters, or else the
    /// first sign. `character` returns the character of an action.
    pub fn characters_of_tap(&self, character: impl Fn(KeyAction) -> Option<char>) -> Vec<char> {
        let characters = self.letters.iter().copied().filter_map(character);
        if self.has_word_letters() {
            characters.filter(|letter| letter.is_alphabetic()).collect()
        } else {
            characters.take(1).collect()
        }
    }
}

/// The index of a list of letters in the list of the [`KeyArbiter`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MultitapId(pub u16);

/// The multitap keys of a layout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Multitaps {
    /// The letters, indexed by [`MultitapId`].
    pub keys: Vec<Multitap>,
    /// The longest time between two taps of the same key that choose one letter.
    pub timeout: Duration,
}

impl Multitaps {
    /// Adds the capabilities that an output needs for the letters, and for the Backspace between them.
    pub fn add_capabilities(&self, required: &mut Capabilities) {
        let letters = self.keys.iter().flat_map(|key| &key.letters).copied();
        let letters = letters.filter_map(KeyAction::required_capability);
        required.extend(letters);
        if !self.keys.is_empty() {
            required.extend([Capability::Key(KeyCode::BACKSPACE)]);
        }
    }
}

/// The letter that the next tap of its key replaces.
#[derive(Clone, Debug)]
pub(super) struct Cycle {
    id: MultitapId,
    index: usize,
    source: PressSource,
    /// The one-shot modifiers of the first tap.
    one_shots: ArrayVec<ArmedModifier, MODIFIER_COUNT>,
    /// The time of the last tap.
    time: Timestamp,
    /// The layer that was active after the last tap.
    layer: usize,
    /// `true` if the first tap has used up a one-shot layer, which the further taps keep.
    has_one_shot_layer: bool,
    performer: Performer,
}

/// Returns `true` if both sources are the same control, pressed by the same finger or another one.
fn is_same_control(source: PressSource, other: PressSource) -> bool {
    match (source, other) {
        (PressSource::Touch(.., target), PressSource::Touch(.., other)) => target == other,
        (source, other) => source == other,
    }
}

impl KeyArbiter {
    /// Sets the letters of multitap keys.
    #[must_use]
    pub fn with_multitaps(self, multitaps: Multitaps) -> Self {
        Self { multitaps, ..self }
    }

    /// Makes each tap of a key with [letters of words](Multitap::has_word_letters) type the first one, or lets taps in a row choose.
    pub fn set_first_letters_only(&mut self, is_first_only: bool) {
        self.first_letters_only = is_first_only;
    }

    /// Returns `true` if taps in a row choose a letter of a key.
    fn has_choice(&self, id: MultitapId) -> bool {
        let key = self.multitaps.keys.get(usize::from(id.0));
        !self.first_letters_only || key.is_none_or(|key| !key.has_word_letters())
    }

    /// Returns the number of presses since the last call that replaced a letter. The arbiter made them, not the person.
    pub fn take_replacing_presses(&mut self) -> usize {
        std::mem::take(&mut self.replacing_presses)
    }

    /// Ends the choice of a letter when the hand that has tapped it is lost: the letter stays.
    pub fn watch_multitap(&mut self, hand: &SequenceHand) {
        let cycle = self.cycle.as_mut();
        if cycle.is_some_and(|cycle| cycle.performer.is_lost(hand) == Some(true)) {
            self.cycle = None;
        }
    }

    /// Returns the action of a press at `time` that chooses another letter of a one-shot layer: the first tap has used the layer up,
    /// and the letter belongs to it.
    pub fn repeated_tap(&self, source: PressSource, time: Timestamp) -> Option<KeyAction> {
        let cycle = self.cycle.as_ref()?;
        let is_repeated = cycle.has_one_shot_layer && self.continues(cycle, source, time);
        is_repeated.then_some(KeyAction::Multitap(cycle.id))
    }

    /// Returns `true` if a tap chooses another letter: it is on the same control, in the same layer and in time.
    fn continues(&self, cycle: &Cycle, source: PressSource, time: Timestamp) -> bool {
        self.has_choice(cycle.id)
            && is_same_control(cycle.source, source)
            && cycle.layer == self.active_layer()
            && time.since(cycle.time) <= self.multitaps.timeout
    }

    /// Types the first letter of a key, or in place of the letter of `before` the next one. Returns `false`, and has no effect, if there
    /// is no room. Everything that it presses besides Shift is released at once, so that no receiver repeats a letter.
    pub(super) fn tap_multitap(
        &mut self,
        id: MultitapId,
        source: PressSource,
        before: Option<Cycle>,
        time: Timestamp,
        events: &mut Events,
    ) -> bool {
        // Shift is released and pressed again, Backspace and the letter are tapped.
        let room = 2 * MODIFIER_COUNT + 4;
        if events.remaining_capacity() < room + 2 * (1 + MODIFIER_COUNT) + self.pressed_keys.len() {
            self.cycle = before;
            return false;
        }
        let side = self.hand.side_of(source);
        let layer = self.active_layer();
        let before = before.filter(|cycle| {
            cycle.id == id && self.continues(cycle, source, time) && self.can_replace(events)
        });
        let mut cycle = before.unwrap_or(Cycle {
            id,
            index: usize::MAX,
            source,
            one_shots: ArrayVec::new(),
            time,
            layer,
            has_one_shot_layer: false,
            performer: Performer::new(side),
        });
        let Some(key) = self.multitaps.keys.get(usize::from(cycle.id.0)) else {
            return false;
        };
        let is_first = cycle.index == usize::MAX;
        let index = cycle.index.wrapping_add(1) % key.letters.len().max(1);
        let Some(&letter) = key.letters.get(index) else {
            return false;
        };
        if !is_first {
            if matches!(letter, KeyAction::Key(code) if self.is_down(code)) {
                // A control holds the key of the next letter, so that it cannot be typed: the present one stays.
                self.cycle = Some(cycle);
                return true;
            }
            self.delete_letter(side, time, events);
        }
        cycle.index = index;
        let is_typed = match letter {
            KeyAction::Text(text) => {
                self.use_layers();
                self.write(text, side, time, events)
            }
            KeyAction::Key(code) => {
                if !is_first {
                    self.one_shots.armed = cycle.one_shots;
                }
                let is_typed = self.tap_letter(code, source, time, events);
                cycle.one_shots = self.one_shots.active.clone();
                is_typed
            }
            _ => false,
        };
        cycle.time = time;
        cycle.layer = self.active_layer();
        cycle.has_one_shot_layer |= cycle.layer != layer;
        self.cycle = (is_typed && !self.holds_shortcut()).then_some(cycle);
        true
    }

    /// Returns `true` if a Backspace would delete a letter: no key that changes its meaning is down. A Shift is released for it, which
    /// must not follow a press of the same step.
    fn can_replace(&self, events: &Events) -> bool {
        let mut keys = self.pressed_keys.iter();
        let has_backspace = keys.any(|key| key.code == KeyCode::BACKSPACE);
        let mut events = events.iter();
        !has_backspace
            && !self.holds_shortcut()
            && !events.any(|event| matches!(event.kind, EventKind::KeyDown(_)))
    }

    /// Returns `true` if a modifier other than Shift is down: a letter is then a shortcut and types nothing.
    fn holds_shortcut(&self) -> bool {
        let mut keys = self.pressed_keys.iter();
        keys.any(|key| key.is_modifier && !key.code.is_shift())
    }

    /// Taps Backspace without Shift, which the letter after it presses again.
    fn delete_letter(&mut self, side: Side, time: Timestamp, events: &mut Events) {
        for index in (0..self.pressed_keys.len()).rev() {
            let code = self.pressed_keys[index].code;
            if code.is_shift() && self.push_event(time, EventKind::KeyUp(code), events) {
                self.pressed_keys.remove(index);
                self.replacing_presses += 1;
            }
        }
        self.push_press(side, time, EventKind::KeyDown(KeyCode::BACKSPACE), events);
        self.push_event(time, EventKind::KeyUp(KeyCode::BACKSPACE), events);
        self.replacing_presses += 1;
    }

    /// Taps a key with the modifiers that are down, locked or armed. Returns `true` if it went down: not if a control holds it.
    fn tap_letter(
        &mut self,
        code: KeyCode,
        source: PressSource,
        time: Timestamp,
        events: &mut Events,
    ) -> bool {
        let was_down = self.is_down(code);
        self.apply_one_shots(source);
        self.presses.push(Press {
            source,
            side: self.hand.side_of(source),
            action: KeyAction::Key(code),
            is_used: false,
            latches: false,
            is_suppressed: false,
        });
        self.emit_changes(time, events);
        let is_typed = !was_down && self.is_down(code);
        self.presses.pop();
        self.emit_changes(time, events);
        is_typed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::TargetId;
    use crate::device::key_arbiter::words;
    use crate::device::{OutputEvent, TextId};
    use crate::hand::Finger;

    const ABC: KeyAction = KeyAction::Multitap(MultitapId(0));

    fn key(name: &str) -> KeyAction {
        KeyAction::Key(name.parse().expect("the name of a key"))
    }

    /// Returns an arbiter with the letters A, ñ and 2, between which taps choose for 800 ms.
    fn arbiter() -> KeyArbiter {
        let letters = vec![key("A"), KeyAction::Text(TextId(0)), key("2")];
        let label = "Añ2".to_owned();
        KeyArbiter::new(vec!["ñ".to_owned()]).with_multitaps(Multitaps {
            keys: vec![Multitap { label, letters }],
            timeout: Duration::from_millis(800),
        })
    }

    fn finger(finger: Finger, target: u32) -> PressSource {
        PressSource::Touch(Side::Right, finger, TargetId(target))
    }

    /// Taps with a source and returns the events.
    fn tap(arbiter: &mut KeyArbiter, source: PressSource, action: KeyAction, ms: u64) -> String {
        let (mut events, time) = (Events::new(), Timestamp(ms * 1_000));
        assert!(arbiter.press(source, action, time, &mut events));
        arbiter.emit_changes(time, &mut events);
        arbiter.release(|other| other == source);
        arbiter.emit_changes(time, &mut events);
        words(&events)
    }

    fn tap_index(arbiter: &mut KeyArbiter, ms: u64) -> String {
        tap(arbiter, finger(Finger::Index, 0), ABC, ms)
    }

    fn hand(side: Side, is_placed: bool, is_seen: bool) -> SequenceHand {
        SequenceHand {
            side,
            time: Timestamp(0),
            is_placed,
            is_seen,
            press_gap: Duration::ZERO,
        }
    }

    #[test]
    fn each_tap_within_the_time_out_replaces_the_letter() {
        let mut arbiter = arbiter();
        assert_eq!(tap_index(&mut arbiter, 0), "+A -A");
        assert_eq!(tap_index(&mut arbiter, 800), "+Backspace -Backspace ñ");
        assert_eq!(
            tap_index(&mut arbiter, 1_600),
            "+Backspace -Backspace +2 -2"
        );
        assert_eq!(arbiter.take_replacing_presses(), 2);
        assert_eq!(tap_index(&mut arbiter, 2_401), "+A -A");
        assert_eq!(arbiter.take_replacing_presses(), 0);
    }

    #[test]
    fn releasing_everything_keeps_the_letter() {
        let mut arbiter = arbiter();
        tap_index(&mut arbiter, 0);
        arbiter.release_all(Timestamp(100_000), &mut Events::new());
        assert_eq!(tap_index(&mut arbiter, 200), "+A -A");
    }

    #[test]
    fn another_finger_may_tap_the_same_key_and_another_key_starts_over() {
        let mut arbiter = arbiter();
        tap_index(&mut arbiter, 0);
        let thumb = tap(&mut arbiter, finger(Finger::Thumb, 0), ABC, 100);
        assert_eq!(thumb, "+Backspace -Backspace ñ");
        let other = tap(&mut arbiter, finger(Finger::Index, 1), ABC, 200);
        assert_eq!(other, "+A -A");
    }

    #[test]
    fn a_lost_hand_and_a_lost_finger_keep_the_letter() {
        for lost in [
            hand(Side::Right, false, true),
            hand(Side::Right, true, false),
        ] {
            let mut arbiter = arbiter();
            tap_index(&mut arbiter, 0);
            arbiter.watch_multitap(&hand(Side::Right, true, true));
            arbiter.watch_multitap(&hand(Side::Left, false, false));
            assert_eq!(tap_index(&mut arbiter, 100), "+Backspace -Backspace ñ");
            arbiter.watch_multitap(&lost);
            assert_eq!(tap_index(&mut arbiter, 200), "+A -A");
        }
        let mut arbiter = arbiter();
        let source = finger(Finger::Index, 0);
        assert!(arbiter.press(source, ABC, Timestamp(0), &mut Events::new()));
        arbiter.cancel(|other| other == source);
        assert_eq!(tap_index(&mut arbiter, 100), "+A -A");
    }

    #[test]
    fn a_hand_without_a_position_is_not_lost() {
        let mut arbiter = arbiter();
        tap_index(&mut arbiter, 0);
        arbiter.watch_multitap(&hand(Side::Right, false, true));
        assert_eq!(tap_index(&mut arbiter, 100), "+Backspace -Backspace ñ");
    }

    #[test]
    fn a_tap_without_room_changes_nothing() {
        let mut arbiter = arbiter();
        tap_index(&mut arbiter, 0);
        let kind = EventKind::MoveBy(1, 0);
        let time = Timestamp(0);
        let full: Events = (0..160).map(|_| OutputEvent { time, kind }).collect();
        let mut events = full.clone();
        let source = finger(Finger::Index, 0);
        assert!(!arbiter.press(source, ABC, Timestamp(1_000), &mut events));
        assert_eq!(events, full);
        assert_eq!(tap_index(&mut arbiter, 100), "+Backspace -Backspace ñ");
    }

    #[test]
    fn a_letter_that_a_control_holds_is_neither_typed_nor_deleted() {
        let mut arbiter = arbiter();
        let held = PressSource::Part(TargetId(9), 0);
        let mut events = Events::new();
        assert!(arbiter.press(held, key("A"), Timestamp(0), &mut events));
        arbiter.emit_changes(Timestamp(0), &mut events);
        assert_eq!(words(&events), "+A");
        assert_eq!(tap_index(&mut arbiter, 100), "");
        assert_eq!(tap_index(&mut arbiter, 200), "");
    }

    #[test]
    fn a_letter_stays_while_a_control_holds_the_next_one() {
        let letters = vec![key("A"), key("B")];
        let label = "AB".to_owned();
        let mut arbiter = KeyArbiter::default().with_multitaps(Multitaps {
            keys: vec![Multitap { label, letters }],
            timeout: Duration::from_millis(800),
        });
        let held = PressSource::Part(TargetId(9), 0);
        let mut events = Events::new();
        assert!(arbiter.press(held, key("B"), Timestamp(0), &mut events));
        arbiter.emit_changes(Timestamp(0), &mut events);
        assert_eq!(tap_index(&mut arbiter, 100), "+A -A");
        assert_eq!(tap_index(&mut arbiter, 200), "");
        arbiter.release(|source| source == held);
        arbiter.emit_changes(Timestamp(300_000), &mut Events::new());
        assert_eq!(tap_index(&mut arbiter, 400), "+Backspace -Backspace +B -B");
    }
}

//! Bursts: taps and characters of one time, which are executed entirely or not at all.
//!
//! A correction of the text decoder is a burst, and so is another letter of a multitap key: Backspaces, and what is typed in place
//! of the deleted text. Backspaces without the rest would destroy text.

use ademan_core::device::pressed_keys::{KeyDirection, PressedKeys};
use ademan_core::device::{EventKind, KeyCode, KeyKind, OutputEvent};

/// A part of a burst.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// A key of the keyboard goes down or comes up.
    Key(KeyCode, KeyDirection),
    /// A character, independent of the keymap.
    Character(char),
}

impl Stroke {
    /// Returns the stroke of an event, if it is one.
    pub fn from_event(event: &OutputEvent) -> Option<Self> {
        let of_keyboard = |key: KeyCode, direction| {
            (key.kind() == KeyKind::Keyboard).then_some(Self::Key(key, direction))
        };
        match event.kind {
            EventKind::KeyDown(key) => of_keyboard(key, KeyDirection::Press),
            EventKind::KeyUp(key) => of_keyboard(key, KeyDirection::Release),
            EventKind::Character(character) => Some(Self::Character(character)),
            _ => None,
        }
    }

    /// Returns the key that goes down, if one does.
    pub fn pressed_key(&self) -> Option<KeyCode> {
        match *self {
            Self::Key(key, KeyDirection::Press) => Some(key),
            _ => None,
        }
    }

    /// Returns the character, if it is one.
    pub fn character(&self) -> Option<char> {
        match *self {
            Self::Character(character) => Some(character),
            Self::Key(..) => None,
        }
    }

    /// Returns `true` if it counts as a press: a key that goes down, or a character.
    pub fn is_press(&self) -> bool {
        !matches!(self, Self::Key(_, KeyDirection::Release))
    }
}

/// Returns the number of events of the burst that `events` begin with: neighboring ones of one time, with two presses or a character
/// at least. Each key of a burst goes down and comes up in it, but for a Shift, which may stay down; none is `held` before, and none is
/// down while a character is typed.
/// Returns 0 if they do not begin with a burst.
pub fn length(events: &[OutputEvent], held: &PressedKeys) -> usize {
    let mut down = PressedKeys::default();
    let (mut presses, mut has_character, mut length) = (0, false, 0);
    for (event, count) in events.iter().zip(1..) {
        let is_part = event.time == events[0].time
            && match Stroke::from_event(event) {
                Some(Stroke::Key(key, KeyDirection::Press)) => {
                    !held.contains(key) && down.press(key)
                }
                Some(Stroke::Key(key, KeyDirection::Release)) => down.release(key),
                Some(Stroke::Character(_)) => down.is_empty(),
                None => false,
            };
        if !is_part {
            break;
        }
        has_character |= matches!(event.kind, EventKind::Character(_));
        presses += usize::from(!matches!(event.kind, EventKind::KeyUp(_)));
        let is_complete = down.release_order().all(KeyCode::is_shift);
        if is_complete && (has_character || presses > 1) {
            length = count;
        }
    }
    length
}

/// Returns the number of presses and characters of a burst.
pub fn count_presses(burst: &[Stroke]) -> usize {
    burst.iter().filter(|stroke| stroke.is_press()).count()
}

/// Returns the characters of a burst.
pub fn text(burst: &[Stroke]) -> String {
    burst.iter().filter_map(Stroke::character).collect()
}

/// Returns `true` if a burst has a Backspace: it replaces text that was typed before.
pub fn replaces(burst: &[Stroke]) -> bool {
    let mut pressed = burst.iter().filter_map(Stroke::pressed_key);
    pressed.any(|key| key == KeyCode::BACKSPACE)
}

/// Returns `true` if a burst that was executed leaves a key down.
pub fn leaves_down(burst: &[Stroke], key: KeyCode) -> bool {
    let of_key = |stroke: &&Stroke| matches!(stroke, Stroke::Key(own, _) if *own == key);
    let last = burst.iter().rev().find(of_key);
    last.is_some_and(Stroke::is_press)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::{down, event, key, up};

    fn tap(name: &str) -> [OutputEvent; 2] {
        [down(1, name), up(1, name)]
    }

    fn character(time: u64, character: char) -> OutputEvent {
        event(time, EventKind::Character(character))
    }

    fn length_of(parts: &[&[OutputEvent]]) -> usize {
        length(&parts.concat(), &PressedKeys::default())
    }

    #[test]
    fn taps_and_characters_of_one_time_are_a_burst() {
        let shifted = [
            &[down(1, "ShiftLeft")][..],
            &tap("A"),
            &[up(1, "ShiftLeft")],
        ];
        assert_eq!(length_of(&[&tap("Backspace"), &shifted.concat()]), 6);
        assert_eq!(length_of(&[&tap("Backspace"), &[character(1, 'é')]]), 3);
        assert_eq!(length_of(&[&[character(1, 'a'), character(1, 'b')]]), 2);
        assert_eq!(length_of(&[&[character(1, 'a')]]), 1);
    }

    #[test]
    fn a_burst_ends_before_another_time_and_before_a_key_that_stays_down() {
        assert_eq!(length_of(&[&[character(1, 'a'), character(2, 'b')]]), 1);
        let taps = [tap("Backspace"), tap("A")].concat();
        assert_eq!(length_of(&[&taps, &[down(1, "Space")]]), 4);
        assert_eq!(length_of(&[&taps, &[event(1, EventKind::MoveBy(1, 0))]]), 4);
        let in_front = [&[down(1, "ControlLeft"), character(1, 'a')][..]];
        assert_eq!(length_of(&in_front), 0, "a shortcut");
    }

    #[test]
    fn a_shift_that_the_person_holds_stays_down() {
        // The next letter of a multitap key under a locked Shift.
        let backspace = tap("Backspace");
        let letter = [&[down(1, "ShiftLeft")][..], &tap("B")].concat();
        let events = [&backspace[..], &letter].concat();
        assert_eq!(length_of(&[&events]), 5);
        let burst: Vec<Stroke> = events.iter().filter_map(Stroke::from_event).collect();
        assert!(leaves_down(&burst, key("ShiftLeft")));
        assert!(!leaves_down(&burst, key("B")) && !leaves_down(&burst, key("C")));
        assert_eq!(
            length_of(&[&backspace, &[down(1, "ControlLeft")], &tap("B")]),
            0
        );
    }

    #[test]
    fn one_tap_and_keys_that_are_held_are_no_burst() {
        assert_eq!(length_of(&[&tap("A")]), 0);
        assert_eq!(length_of(&[&tap("A"), &[down(1, "B")]]), 0);
        assert_eq!(length_of(&[&tap("MouseLeft"), &tap("MouseLeft")]), 0);
        let mut held = PressedKeys::default();
        held.press(key("A"));
        assert_eq!(length(&[tap("B"), tap("A")].concat(), &held), 0);
        assert_eq!(length(&[], &held), 0);
    }

    #[test]
    fn a_burst_with_a_backspace_replaces_text() {
        let strokes = |events: &[OutputEvent]| -> Vec<Stroke> {
            events.iter().filter_map(Stroke::from_event).collect()
        };
        let burst = strokes(&[&tap("Backspace")[..], &[character(1, 'é')]].concat());
        assert!(replaces(&burst));
        assert_eq!((count_presses(&burst), text(&burst)), (2, "é".to_owned()));
        let after_a_letter = [tap("A"), tap("Backspace")].concat();
        assert!(replaces(&strokes(&after_a_letter)));
        assert!(!replaces(&strokes(&[tap("A"), tap("B")].concat())));
    }
}

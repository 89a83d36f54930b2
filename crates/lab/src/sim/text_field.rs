//! A text field that receives key events.

use crate::device::pressed_keys::PressedKeys;
use crate::device::{EventKind, KeyCode, OutputEvent};

/// A text field with a US keymap: characters, Backspace and Shift. Shortcuts with Control, Alt or Meta write nothing.
#[derive(Clone, Debug)]
pub struct UsTextField {
    text: String,
    /// The largest length of the text, in bytes.
    max_bytes: usize,
    pressed: PressedKeys,
}

impl Default for UsTextField {
    fn default() -> Self {
        Self::new()
    }
}

impl UsTextField {
    /// Creates an empty text field.
    pub fn new() -> Self {
        Self {
            text: String::new(),
            max_bytes: usize::MAX,
            pressed: PressedKeys::default(),
        }
    }

    /// Creates an empty text field that keeps the end of the text, at most `max_bytes` bytes. It never allocates again.
    pub fn with_capacity(max_bytes: usize) -> Self {
        Self {
            text: String::with_capacity(max_bytes),
            max_bytes,
            ..Self::new()
        }
    }

    /// Handles an event. Events other than key events are ignored.
    pub fn handle(&mut self, event: &OutputEvent) {
        match event.kind {
            EventKind::KeyDown(key) => {
                self.edit(key);
                self.pressed.press(key);
            }
            EventKind::KeyUp(key) => _ = self.pressed.release(key),
            EventKind::Character(character) => self.push(character),
            _ => {}
        }
    }

    fn edit(&mut self, key: KeyCode) {
        let is_shortcut = |held: KeyCode| held.is_modifier() && !held.is_shift();
        if self.pressed.release_order().any(is_shortcut) {
            return;
        }
        if key == KeyCode::BACKSPACE {
            self.text.pop();
        }
        let is_shifted = self.pressed.release_order().any(KeyCode::is_shift);
        if let Some(character) = key.us_character(is_shifted) {
            self.push(character);
        }
    }

    /// Adds a character at the end, and removes from the beginning what has no room beside it.
    fn push(&mut self, character: char) {
        let room = self.max_bytes.saturating_sub(character.len_utf8());
        let excess = self.text.len().saturating_sub(room);
        if excess > 0 {
            let kept = self.text.ceil_char_boundary(excess);
            self.text.drain(..kept);
        }
        if character.len_utf8() <= self.max_bytes {
            self.text.push(character);
        }
    }

    /// Empties the text. Keys that are down stay down: a Shift that is held continues to make capitals.
    pub fn clear(&mut self) {
        self.text.clear();
    }

    /// Returns the text so far.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the keys that are pressed.
    pub fn pressed(&self) -> &PressedKeys {
        &self.pressed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::Timestamp;

    /// Presses (`+`) and releases (`-`) keys, and writes single characters.
    fn play(field: &mut UsTextField, script: &str) {
        for token in script.split(' ') {
            let kind = match (token.strip_prefix('+'), token.strip_prefix('-')) {
                (Some(name), _) => EventKind::KeyDown(name.parse().unwrap()),
                (_, Some(name)) => EventKind::KeyUp(name.parse().unwrap()),
                _ => EventKind::Character(token.parse().unwrap()),
            };
            field.handle(&OutputEvent {
                time: Timestamp(0),
                kind,
            });
        }
    }

    #[test]
    fn shift_types_capitals_and_backspace_deletes() {
        let mut field = UsTextField::new();
        let script = "+H -H +ShiftLeft +1 -1 -ShiftLeft +A -A +Backspace -Backspace +Enter -Enter";
        play(&mut field, script);
        assert_eq!(field.text(), "h!\n");
        assert!(field.pressed().is_empty());
    }

    #[test]
    fn characters_are_written_and_shortcuts_are_not() {
        let mut field = UsTextField::new();
        play(
            &mut field,
            "ñ +ControlLeft +C -C +Backspace -Backspace -ControlLeft é",
        );
        assert_eq!(field.text(), "ñé");
        play(&mut field, "+Backspace -Backspace");
        assert_eq!(field.text(), "ñ");
    }

    #[test]
    fn a_bounded_field_keeps_the_end_of_the_text_and_its_memory() {
        let mut field = UsTextField::with_capacity(5);
        let memory = (field.text.as_ptr(), field.text.capacity());
        for script in ["+H -H", "ñ", "é", "+A -A", "€", "+B -B"] {
            play(&mut field, script);
            assert!(field.text().len() <= 5, "{}", field.text());
        }
        assert_eq!(field.text(), "a€b");
        assert_eq!((field.text.as_ptr(), field.text.capacity()), memory);
        let mut tiny = UsTextField::with_capacity(1);
        play(&mut tiny, "a € b");
        assert_eq!(tiny.text(), "b");
    }
}

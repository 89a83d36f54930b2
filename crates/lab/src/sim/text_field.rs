//! A text field that receives key events.

use std::collections::BTreeSet;

use crate::device::{EventKind, KeyCode, OutputEvent};

/// A text field with a US keymap: characters, Backspace and Shift.
#[derive(Clone, Debug, Default)]
pub struct UsTextField {
    text: String,
    pressed: BTreeSet<KeyCode>,
}

impl UsTextField {
    /// Creates an empty text field.
    pub fn new() -> Self {
        Self::default()
    }

    /// Handles an event. Events other than those of keys are ignored.
    pub fn handle(&mut self, event: &OutputEvent) {
        match event.kind {
            EventKind::KeyDown(key) => {
                self.edit(key);
                self.pressed.insert(key);
            }
            EventKind::KeyUp(key) => {
                self.pressed.remove(&key);
            }
            _ => {}
        }
    }

    fn edit(&mut self, key: KeyCode) {
        if key == KeyCode::BACKSPACE {
            self.text.pop();
        }
        let shifts = [KeyCode::SHIFT_LEFT, KeyCode::SHIFT_RIGHT];
        let is_shifted = shifts.iter().any(|shift| self.pressed.contains(shift));
        self.text.extend(key.us_character(is_shifted));
    }

    /// Returns the text so far.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the keys that are pressed.
    pub fn pressed(&self) -> &BTreeSet<KeyCode> {
        &self.pressed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::Timestamp;

    #[test]
    fn shift_types_capitals_and_backspace_deletes() {
        let mut field = UsTextField::new();
        let script = "+H -H +ShiftLeft +1 -1 -ShiftLeft +A -A +Backspace -Backspace +Enter -Enter";
        for token in script.split(' ') {
            let (sign, name) = token.split_at(1);
            let key = name.parse().unwrap();
            let kind = if sign == "+" {
                EventKind::KeyDown(key)
            } else {
                EventKind::KeyUp(key)
            };
            field.handle(&OutputEvent {
                time: Timestamp(0),
                kind,
            });
        }
        assert_eq!(field.text(), "h!\n");
        assert!(field.pressed().is_empty());
    }
}

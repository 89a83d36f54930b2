//! What a program with a US keymap makes of key events.

use std::collections::BTreeSet;

use crate::device::{EventKind, KeyCode, OutputEvent};

/// Reads key events as a text field would: characters, Backspace, Shift.
#[derive(Clone, Debug, Default)]
pub struct UsTextField {
    text: String,
    down: BTreeSet<KeyCode>,
}

impl UsTextField {
    /// An empty text field.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes one event; events that are not keys write nothing.
    pub fn handle(&mut self, event: &OutputEvent) {
        match event.kind {
            EventKind::KeyDown(key) => {
                self.write(key);
                self.down.insert(key);
            }
            EventKind::KeyUp(key) => {
                self.down.remove(&key);
            }
            _ => {}
        }
    }

    fn write(&mut self, key: KeyCode) {
        if key == KeyCode::BACKSPACE {
            self.text.pop();
        }
        let shifted = [KeyCode::SHIFT_LEFT, KeyCode::SHIFT_RIGHT]
            .iter()
            .any(|shift| self.down.contains(shift));
        self.text.extend(key.us_character(shifted));
    }

    /// The text so far.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The keys that are down.
    pub fn pressed(&self) -> &BTreeSet<KeyCode> {
        &self.down
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::Timestamp;

    #[test]
    fn shift_makes_capitals_and_backspace_takes_back() {
        let mut field = UsTextField::new();
        let script = "+H -H +ShiftLeft +1 -1 -ShiftLeft +A -A +Backspace -Backspace +Enter -Enter";
        for word in script.split(' ') {
            let (sign, name) = word.split_at(1);
            let key = name.parse().unwrap();
            let action = if sign == "+" {
                EventKind::KeyDown(key)
            } else {
                EventKind::KeyUp(key)
            };
            field.handle(&OutputEvent {
                time: Timestamp(0),
                kind: action,
            });
        }
        assert_eq!(field.text(), "h!\n");
        assert!(field.pressed().is_empty());
    }
}

//! The key of the keyboard that binds a control: "press the key".

use eframe::egui::{self, Event, Key};

use ademan_core::device::KeyCode;

/// Keys whose names in egui are neither names nor aliases in files.
const OTHER_NAMES: [(Key, &str); 5] = [
    (Key::OpenBracket, "BracketLeft"),
    (Key::CloseBracket, "BracketRight"),
    (Key::Plus, "Equal"),
    (Key::SuperLeft, "MetaLeft"),
    (Key::SuperRight, "MetaRight"),
];

/// Takes the next key that is pressed, and hides all keys of the frame from everything else.
pub(super) fn take_key(input: &mut egui::InputState) -> Option<KeyCode> {
    let pressed = input.events.iter().find_map(|event| match event {
        Event::Key {
            key,
            physical_key,
            pressed: true,
            repeat: false,
            ..
        } => key_code(physical_key.unwrap_or(*key)),
        _ => None,
    });
    let is_key = |event: &Event| {
        matches!(
            event,
            Event::Key { .. } | Event::Text(_) | Event::Copy | Event::Cut | Event::Paste(_)
        )
    };
    input.events.retain(|event| !is_key(event));
    pressed
}

/// Returns the key code at the position of a key; `None` for one that files cannot name.
fn key_code(key: Key) -> Option<KeyCode> {
    let other = OTHER_NAMES.iter().find(|(other, _)| *other == key);
    let name = other.map_or(key.name(), |(_, name)| name);
    name.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_keys_of_a_keyboard_have_a_code() {
        let has_code = |key: &&Key| key_code(**key).is_some();
        let count = Key::ALL.iter().filter(has_code).count();
        assert!(count >= 26 + 10 + 12 + 30, "{count}");
    }

    #[test]
    fn keys_have_the_codes_of_their_positions() {
        let expected = [
            (Key::A, "A"),
            (Key::Num1, "1"),
            (Key::ArrowUp, "ArrowUp"),
            (Key::ShiftRight, "ShiftRight"),
            (Key::Backtick, "Backquote"),
            (Key::OpenBracket, "BracketLeft"),
            (Key::CloseBracket, "BracketRight"),
            (Key::ArrowLeft, "ArrowLeft"),
            (Key::SuperLeft, "MetaLeft"),
            (Key::ControlRight, "ControlRight"),
            (Key::Equals, "Equal"),
            (Key::Menu, "ContextMenu"),
            (Key::F12, "F12"),
            (Key::PageDown, "PageDown"),
        ];
        for (key, name) in expected {
            assert_eq!(key_code(key).map(KeyCode::name), Some(name));
        }
    }
}

//! Keys by name or character, for operating systems on which `enigo` has no reliable key positions.
//!
//! The injected key is the one to which the receiver's keymap assigns the character of the US keymap. With another
//! keymap this key can be at another position, or missing.

use enigo::{Direction, Enigo, InputError, InputResult, Key, Keyboard};

use ademan_core::device::KeyCode;

/// Injects the key of this name. `codes` are the system's codes of keys that `enigo` has no common name for, by Linux
/// event code.
pub fn inject_by_name(
    enigo: &mut Enigo,
    key: KeyCode,
    direction: Direction,
    codes: &[(u16, u32)],
) -> InputResult<()> {
    let Some(key) = coded(key, codes).or_else(|| named(key)) else {
        return Err(InputError::InvalidInput(
            "this system has no such key; remove it from the layout",
        ));
    };
    enigo.key(key, direction)
}

/// Returns `true` if the system has this key.
pub fn has_named_key(key: KeyCode, codes: &[(u16, u32)]) -> bool {
    coded(key, codes).or_else(|| named(key)).is_some()
}

fn coded(key: KeyCode, codes: &[(u16, u32)]) -> Option<Key> {
    let (_, code) = codes.iter().find(|(code, _)| *code == key.event_code())?;
    Some(Key::Other(*code))
}

/// Returns the key by the name that `enigo` has for it on every system, or by its US character.
fn named(key: KeyCode) -> Option<Key> {
    let named = match key.name() {
        "Escape" => Key::Escape,
        "Backspace" => Key::Backspace,
        "Tab" => Key::Tab,
        "Enter" | "NumpadEnter" => Key::Return,
        "Space" => Key::Space,
        "CapsLock" => Key::CapsLock,
        "ShiftLeft" => Key::LShift,
        "ShiftRight" => Key::RShift,
        "ControlLeft" => Key::LControl,
        "ControlRight" => Key::RControl,
        "AltLeft" => Key::Alt,
        "MetaLeft" => Key::Meta,
        "NumpadMultiply" => Key::Multiply,
        "NumpadSubtract" => Key::Subtract,
        "NumpadAdd" => Key::Add,
        "NumpadDecimal" => Key::Decimal,
        "NumpadDivide" => Key::Divide,
        "Numpad0" => Key::Numpad0,
        "Numpad1" => Key::Numpad1,
        "Numpad2" => Key::Numpad2,
        "Numpad3" => Key::Numpad3,
        "Numpad4" => Key::Numpad4,
        "Numpad5" => Key::Numpad5,
        "Numpad6" => Key::Numpad6,
        "Numpad7" => Key::Numpad7,
        "Numpad8" => Key::Numpad8,
        "Numpad9" => Key::Numpad9,
        "Home" => Key::Home,
        "End" => Key::End,
        "PageUp" => Key::PageUp,
        "PageDown" => Key::PageDown,
        "Delete" => Key::Delete,
        "ArrowUp" => Key::UpArrow,
        "ArrowDown" => Key::DownArrow,
        "ArrowLeft" => Key::LeftArrow,
        "ArrowRight" => Key::RightArrow,
        "AudioVolumeMute" => Key::VolumeMute,
        "AudioVolumeDown" => Key::VolumeDown,
        "AudioVolumeUp" => Key::VolumeUp,
        "MediaTrackNext" => Key::MediaNextTrack,
        "MediaTrackPrevious" => Key::MediaPrevTrack,
        "MediaPlayPause" => Key::MediaPlayPause,
        "F1" => Key::F1,
        "F2" => Key::F2,
        "F3" => Key::F3,
        "F4" => Key::F4,
        "F5" => Key::F5,
        "F6" => Key::F6,
        "F7" => Key::F7,
        "F8" => Key::F8,
        "F9" => Key::F9,
        "F10" => Key::F10,
        "F11" => Key::F11,
        "F12" => Key::F12,
        "F13" => Key::F13,
        "F14" => Key::F14,
        "F15" => Key::F15,
        "F16" => Key::F16,
        "F17" => Key::F17,
        "F18" => Key::F18,
        "F19" => Key::F19,
        "F20" => Key::F20,
        _ => return key.us_character(false).map(Key::Unicode),
    };
    Some(named)
}

/// Virtual-key codes of Windows (`VK_*` of `winuser.h`), by Linux event code.
pub const WINDOWS_KEY_CODES: &[(u16, u32)] = &[
    (69, 0x90),  // NumLock
    (70, 0x91),  // ScrollLock
    (86, 0xe2),  // IntlBackslash
    (99, 0x2c),  // PrintScreen
    (100, 0xa5), // AltRight
    (110, 0x2d), // Insert
    (119, 0x13), // Pause
    (126, 0x5c), // MetaRight
    (127, 0x5d), // ContextMenu
    (166, 0xb2), // MediaStop
    (191, 0x84), // F21
    (192, 0x85), // F22
    (193, 0x86), // F23
    (194, 0x87), // F24
];

/// Virtual-key codes of macOS (`kVK_*` of `HIToolbox/Events.h`), by Linux event code.
pub const MACOS_KEY_CODES: &[(u16, u32)] = &[
    (69, 0x47),  // NumLock: the Clear key is at its position
    (86, 0x0a),  // IntlBackslash
    (96, 0x4c),  // NumpadEnter
    (100, 0x3d), // AltRight
    (110, 0x72), // Insert: the Help key is at its position
    (126, 0x36), // MetaRight
];

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::device::KeyKind;

    fn missing(codes: &[(u16, u32)]) -> Vec<&'static str> {
        KeyCode::all()
            .filter(|key| key.kind() == KeyKind::Keyboard && !has_named_key(*key, codes))
            .map(KeyCode::name)
            .collect()
    }

    #[test]
    fn windows_has_every_key_and_macos_all_but_nine() {
        assert_eq!(missing(WINDOWS_KEY_CODES), [""; 0]);
        let not_on_macos = [
            "ScrollLock",
            "PrintScreen",
            "Pause",
            "ContextMenu",
            "MediaStop",
            "F21",
            "F22",
            "F23",
            "F24",
        ];
        assert_eq!(missing(MACOS_KEY_CODES), not_on_macos);
    }

    #[test]
    fn a_letter_is_injected_by_its_unshifted_character() {
        assert_eq!(named("Q".parse().unwrap()), Some(Key::Unicode('q')));
        assert_eq!(named("Slash".parse().unwrap()), Some(Key::Unicode('/')));
        assert_eq!(named("Tab".parse().unwrap()), Some(Key::Tab));
    }
}

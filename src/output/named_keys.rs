//! Keys by name or character, for systems on which `enigo` knows no positions that can be relied on.
//!
//! What is pressed is the key that the receiver's keymap has for a character of the US keymap; with
//! another keymap it can be in another place, or nowhere.

use enigo::{Direction, Enigo, InputError, InputResult, Key, Keyboard};

use crate::device::KeyCode;

/// Presses the key of this name. `extra` are codes of the system for keys that `enigo` has no name
/// for everywhere, by Linux event code.
pub fn inject_by_name(
    enigo: &mut Enigo,
    key: KeyCode,
    direction: Direction,
    extra: &[(u16, u32)],
) -> InputResult<()> {
    let Some(key) = of_system(key, extra).or_else(|| named(key)) else {
        return Err(InputError::InvalidInput(
            "this system has no such key; leave it out of the layout",
        ));
    };
    enigo.key(key, direction)
}

/// Whether there is a key to press for this one.
pub fn has(key: KeyCode, extra: &[(u16, u32)]) -> bool {
    of_system(key, extra).or_else(|| named(key)).is_some()
}

fn of_system(key: KeyCode, extra: &[(u16, u32)]) -> Option<Key> {
    let (_, code) = extra.iter().find(|(code, _)| *code == key.event_code())?;
    Some(Key::Other(*code))
}

/// The key by the name that `enigo` has for it on every system, or by its US character.
pub fn named(key: KeyCode) -> Option<Key> {
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
];

/// Virtual-key codes of macOS (`kVK_*` of `HIToolbox/Events.h`), by Linux event code.
pub const MACOS_KEY_CODES: &[(u16, u32)] = &[
    (69, 0x47),  // NumLock: the Clear key in its place
    (86, 0x0a),  // IntlBackslash
    (96, 0x4c),  // NumpadEnter
    (100, 0x3d), // AltRight
    (110, 0x72), // Insert: the Help key in its place
    (126, 0x36), // MetaRight
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::KeyKind;

    fn missing(extra: &[(u16, u32)]) -> Vec<&'static str> {
        KeyCode::all()
            .filter(|key| key.kind() == KeyKind::Keyboard && !has(*key, extra))
            .map(KeyCode::name)
            .collect()
    }

    #[test]
    fn windows_has_every_key_and_macos_all_but_five() {
        assert_eq!(missing(WINDOWS_KEY_CODES), [""; 0]);
        let not_on_macos = [
            "ScrollLock",
            "PrintScreen",
            "Pause",
            "ContextMenu",
            "MediaStop",
        ];
        assert_eq!(missing(MACOS_KEY_CODES), not_on_macos);
    }

    #[test]
    fn a_letter_goes_by_its_unshifted_character() {
        assert_eq!(named("Q".parse().unwrap()), Some(Key::Unicode('q')));
        assert_eq!(named("Slash".parse().unwrap()), Some(Key::Unicode('/')));
        assert_eq!(named("Tab".parse().unwrap()), Some(Key::Tab));
    }
}

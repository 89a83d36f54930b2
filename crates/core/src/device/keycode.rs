//! Key codes: Linux event codes of keys, mouse buttons and gamepad buttons, with names.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::names::UnknownName;

/// The Linux event code of a key, mouse button or gamepad button (`KEY_*` and `BTN_*` of
/// `input-event-codes.h`).
///
/// A code is a position, not a character: the keymap of the receiver decides which character it types. The
/// names are the `code` values of the W3C UI Events specification, for letters and digits without prefix
/// (`Q`, `1`); the prefix (`KeyQ`, `Digit1`) and [aliases](Self::aliases) such as `Ctrl` are accepted when
/// parsing. Button names begin with `Mouse` or `Pad`; the names of gamepad buttons describe their position on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct KeyCode(u16);

/// The kind of device that has a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyKind {
    /// A keyboard.
    Keyboard,
    /// A mouse.
    Mouse,
    /// A gamepad.
    Gamepad,
}

struct KeyEntry {
    code: u16,
    name: &'static str,
    label: &'static str,
    plain: Option<char>,
    shifted: Option<char>,
}

const fn key(
    code: u16,
    name: &'static str,
    label: &'static str,
    plain: Option<char>,
    shifted: Option<char>,
) -> KeyEntry {
    KeyEntry {
        code,
        name,
        label,
        plain,
        shifted,
    }
}

/// All keys, in order of code. The characters follow a US keymap with Num Lock on.
#[rustfmt::skip]
const KEYS: &[KeyEntry] = &[
    key(1, "Escape", "Esc", None, None),
    key(2, "1", "1", Some('1'), Some('!')),
    key(3, "2", "2", Some('2'), Some('@')),
    key(4, "3", "3", Some('3'), Some('#')),
    key(5, "4", "4", Some('4'), Some('$')),
    key(6, "5", "5", Some('5'), Some('%')),
    key(7, "6", "6", Some('6'), Some('^')),
    key(8, "7", "7", Some('7'), Some('&')),
    key(9, "8", "8", Some('8'), Some('*')),
    key(10, "9", "9", Some('9'), Some('(')),
    key(11, "0", "0", Some('0'), Some(')')),
    key(12, "Minus", "-", Some('-'), Some('_')),
    key(13, "Equal", "=", Some('='), Some('+')),
    key(14, "Backspace", "⌫", None, None),
    key(15, "Tab", "⇥", Some('\t'), Some('\t')),
    key(16, "Q", "Q", Some('q'), Some('Q')),
    key(17, "W", "W", Some('w'), Some('W')),
    key(18, "E", "E", Some('e'), Some('E')),
    key(19, "R", "R", Some('r'), Some('R')),
    key(20, "T", "T", Some('t'), Some('T')),
    key(21, "Y", "Y", Some('y'), Some('Y')),
    key(22, "U", "U", Some('u'), Some('U')),
    key(23, "I", "I", Some('i'), Some('I')),
    key(24, "O", "O", Some('o'), Some('O')),
    key(25, "P", "P", Some('p'), Some('P')),
    key(26, "BracketLeft", "[", Some('['), Some('{')),
    key(27, "BracketRight", "]", Some(']'), Some('}')),
    key(28, "Enter", "⏎", Some('\n'), Some('\n')),
    key(29, "ControlLeft", "Ctrl", None, None),
    key(30, "A", "A", Some('a'), Some('A')),
    key(31, "S", "S", Some('s'), Some('S')),
    key(32, "D", "D", Some('d'), Some('D')),
    key(33, "F", "F", Some('f'), Some('F')),
    key(34, "G", "G", Some('g'), Some('G')),
    key(35, "H", "H", Some('h'), Some('H')),
    key(36, "J", "J", Some('j'), Some('J')),
    key(37, "K", "K", Some('k'), Some('K')),
    key(38, "L", "L", Some('l'), Some('L')),
    key(39, "Semicolon", ";", Some(';'), Some(':')),
    key(40, "Quote", "'", Some('\''), Some('"')),
    key(41, "Backquote", "`", Some('`'), Some('~')),
    key(42, "ShiftLeft", "⇧", None, None),
    key(43, "Backslash", "\\", Some('\\'), Some('|')),
    key(44, "Z", "Z", Some('z'), Some('Z')),
    key(45, "X", "X", Some('x'), Some('X')),
    key(46, "C", "C", Some('c'), Some('C')),
    key(47, "V", "V", Some('v'), Some('V')),
    key(48, "B", "B", Some('b'), Some('B')),
    key(49, "N", "N", Some('n'), Some('N')),
    key(50, "M", "M", Some('m'), Some('M')),
    key(51, "Comma", ",", Some(','), Some('<')),
    key(52, "Period", ".", Some('.'), Some('>')),
    key(53, "Slash", "/", Some('/'), Some('?')),
    key(54, "ShiftRight", "⇧", None, None),
    key(55, "NumpadMultiply", "*", Some('*'), Some('*')),
    key(56, "AltLeft", "Alt", None, None),
    key(57, "Space", "␣", Some(' '), Some(' ')),
    key(58, "CapsLock", "Caps", None, None),
    key(59, "F1", "F1", None, None),
    key(60, "F2", "F2", None, None),
    key(61, "F3", "F3", None, None),
    key(62, "F4", "F4", None, None),
    key(63, "F5", "F5", None, None),
    key(64, "F6", "F6", None, None),
    key(65, "F7", "F7", None, None),
    key(66, "F8", "F8", None, None),
    key(67, "F9", "F9", None, None),
    key(68, "F10", "F10", None, None),
    key(69, "NumLock", "Num", None, None),
    key(70, "ScrollLock", "Scroll", None, None),
    key(71, "Numpad7", "7", Some('7'), Some('7')),
    key(72, "Numpad8", "8", Some('8'), Some('8')),
    key(73, "Numpad9", "9", Some('9'), Some('9')),
    key(74, "NumpadSubtract", "-", Some('-'), Some('-')),
    key(75, "Numpad4", "4", Some('4'), Some('4')),
    key(76, "Numpad5", "5", Some('5'), Some('5')),
    key(77, "Numpad6", "6", Some('6'), Some('6')),
    key(78, "NumpadAdd", "+", Some('+'), Some('+')),
    key(79, "Numpad1", "1", Some('1'), Some('1')),
    key(80, "Numpad2", "2", Some('2'), Some('2')),
    key(81, "Numpad3", "3", Some('3'), Some('3')),
    key(82, "Numpad0", "0", Some('0'), Some('0')),
    key(83, "NumpadDecimal", ".", Some('.'), Some('.')),
    key(86, "IntlBackslash", "<", Some('<'), Some('>')),
    key(87, "F11", "F11", None, None),
    key(88, "F12", "F12", None, None),
    key(96, "NumpadEnter", "⏎", Some('\n'), Some('\n')),
    key(97, "ControlRight", "Ctrl", None, None),
    key(98, "NumpadDivide", "/", Some('/'), Some('/')),
    key(99, "PrintScreen", "PrtSc", None, None),
    key(100, "AltRight", "AltGr", None, None),
    key(102, "Home", "Home", None, None),
    key(103, "ArrowUp", "↑", None, None),
    key(104, "PageUp", "PgUp", None, None),
    key(105, "ArrowLeft", "←", None, None),
    key(106, "ArrowRight", "→", None, None),
    key(107, "End", "End", None, None),
    key(108, "ArrowDown", "↓", None, None),
    key(109, "PageDown", "PgDn", None, None),
    key(110, "Insert", "Ins", None, None),
    key(111, "Delete", "Del", None, None),
    key(113, "AudioVolumeMute", "Mute", None, None),
    key(114, "AudioVolumeDown", "Vol-", None, None),
    key(115, "AudioVolumeUp", "Vol+", None, None),
    key(119, "Pause", "Pause", None, None),
    key(125, "MetaLeft", "Meta", None, None),
    key(126, "MetaRight", "Meta", None, None),
    key(127, "ContextMenu", "Menu", None, None),
    key(163, "MediaTrackNext", "Next", None, None),
    key(164, "MediaPlayPause", "Play", None, None),
    key(165, "MediaTrackPrevious", "Prev", None, None),
    key(166, "MediaStop", "Stop", None, None),
    key(183, "F13", "F13", None, None),
    key(184, "F14", "F14", None, None),
    key(185, "F15", "F15", None, None),
    key(186, "F16", "F16", None, None),
    key(187, "F17", "F17", None, None),
    key(188, "F18", "F18", None, None),
    key(189, "F19", "F19", None, None),
    key(190, "F20", "F20", None, None),
    key(191, "F21", "F21", None, None),
    key(192, "F22", "F22", None, None),
    key(193, "F23", "F23", None, None),
    key(194, "F24", "F24", None, None),
    key(272, "MouseLeft", "Left", None, None),
    key(273, "MouseRight", "Right", None, None),
    key(274, "MouseMiddle", "Middle", None, None),
    key(275, "MouseBack", "Back", None, None),
    key(276, "MouseForward", "Fwd", None, None),
    key(304, "PadSouth", "South", None, None),
    key(305, "PadEast", "East", None, None),
    key(307, "PadNorth", "North", None, None),
    key(308, "PadWest", "West", None, None),
    key(310, "PadL1", "L1", None, None),
    key(311, "PadR1", "R1", None, None),
    key(312, "PadL2", "L2", None, None),
    key(313, "PadR2", "R2", None, None),
    key(314, "PadSelect", "Select", None, None),
    key(315, "PadStart", "Start", None, None),
    key(316, "PadMode", "Mode", None, None),
    key(317, "PadL3", "L3", None, None),
    key(318, "PadR3", "R3", None, None),
    key(544, "PadUp", "↑", None, None),
    key(545, "PadDown", "↓", None, None),
    key(546, "PadLeft", "←", None, None),
    key(547, "PadRight", "→", None, None),
];

impl KeyCode {
    /// The left Shift key.
    pub const SHIFT_LEFT: Self = Self(42);
    /// The right Shift key.
    pub const SHIFT_RIGHT: Self = Self(54);
    /// Backspace.
    pub const BACKSPACE: Self = Self(14);
    /// The left mouse button.
    pub const MOUSE_LEFT: Self = Self(272);
    /// The right mouse button.
    pub const MOUSE_RIGHT: Self = Self(273);

    /// Returns the key with a Linux event code, if the table contains it.
    pub fn from_event_code(code: u16) -> Option<Self> {
        find(code).map(|key| Self(key.code))
    }

    /// Returns the Linux event code.
    pub const fn event_code(self) -> u16 {
        self.0
    }

    /// Returns the key with an X11 key code, if the table contains it.
    pub fn from_x11_code(code: u8) -> Option<Self> {
        Self::from_event_code(u16::from(code).checked_sub(8)?)
    }

    /// Returns the X11 key code of a key: the event code + 8.
    pub const fn x11_code(self) -> u16 {
        self.0 + 8
    }

    /// Returns the name used in files and output.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// Returns a short label to draw on the key.
    pub fn label(self) -> &'static str {
        self.entry().label
    }

    /// Returns the character that it types on a US keymap with Num Lock on, with or without Shift.
    pub fn us_character(self, shifted: bool) -> Option<char> {
        let entry = self.entry();
        if shifted { entry.shifted } else { entry.plain }
    }

    /// Returns the keys that type `character` on a US keymap with Num Lock on, each with `true` if it needs
    /// Shift: keys without Shift first, then keys with Shift, both in order of code.
    pub fn for_us_character(character: char) -> impl Iterator<Item = (Self, bool)> {
        [false, true].into_iter().flat_map(move |shifted| {
            Self::all()
                .filter(move |key| key.us_character(shifted) == Some(character))
                .map(move |key| (key, shifted))
        })
    }

    /// Returns the kind of device that has it.
    pub const fn kind(self) -> KeyKind {
        match self.0 {
            0..0x110 => KeyKind::Keyboard,
            0x110..0x120 => KeyKind::Mouse,
            _ => KeyKind::Gamepad,
        }
    }

    /// Returns `true` if this is a modifier key.
    pub fn is_modifier(self) -> bool {
        matches!(self.0, 29 | 42 | 54 | 56 | 97 | 100 | 125 | 126)
    }

    /// Returns `true` if this is a Shift key.
    pub const fn is_shift(self) -> bool {
        matches!(self.0, 42 | 54)
    }

    /// Returns `true` if this is a Control key.
    pub const fn is_control(self) -> bool {
        matches!(self.0, 29 | 97)
    }

    /// Returns `true` if this is an Alt key. The right one is AltGr on many keymaps, and Alt on a US one.
    pub const fn is_alt(self) -> bool {
        matches!(self.0, 56 | 100)
    }

    /// Returns `true` if this key on its own acts on the system instead of the focused program: it opens the
    /// desktop menu (Meta), or sends commands to the kernel (PrintScreen, which is also SysRq).
    pub const fn is_system_key(self) -> bool {
        matches!(self.0, 99 | 125 | 126)
    }

    /// Returns `true` if this key acts on the system together with Control and Alt: F1 to F12 switch the
    /// console, Delete restarts the machine, Backspace ends an X server.
    pub const fn is_system_key_with_ctrl_alt(self) -> bool {
        matches!(self.0, 14 | 59..=68 | 83 | 87 | 88 | 111)
    }

    /// Returns all keys, in order of code.
    pub fn all() -> impl Iterator<Item = Self> {
        KEYS.iter().map(|key| Self(key.code))
    }

    fn entry(self) -> &'static KeyEntry {
        find(self.0).expect("every key code comes from the table")
    }
}

fn find(code: u16) -> Option<&'static KeyEntry> {
    let index = KEYS.binary_search_by_key(&code, |key| key.code).ok()?;
    Some(&KEYS[index])
}

impl fmt::Display for KeyCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for KeyCode {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = KEYS.iter().find(|key| key.name == text);
        named
            .map(|key| Self(key.code))
            .or_else(|| Self::from_other_name(text))
            .ok_or_else(|| Self::unknown(text))
    }
}

impl Serialize for KeyCode {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for KeyCode {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?
            .parse()
            .map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_sorted_and_every_name_parses_back() {
        assert!(KEYS.windows(2).all(|pair| pair[0].code < pair[1].code));
        for key in KeyCode::all() {
            assert_eq!(key.name().parse::<KeyCode>(), Ok(key));
            assert_eq!(KeyCode::from_event_code(key.event_code()), Some(key));
        }
    }

    #[test]
    fn the_kind_of_every_key_matches_its_name() {
        for key in KeyCode::all() {
            let by_name = match key.name() {
                name if name.starts_with("Mouse") => KeyKind::Mouse,
                name if name.starts_with("Pad") => KeyKind::Gamepad,
                _ => KeyKind::Keyboard,
            };
            assert_eq!(key.kind(), by_name, "{key}");
        }
    }

    #[test]
    fn w3c_names_with_their_prefix_parse_as_well() {
        assert_eq!("KeyQ".parse::<KeyCode>().unwrap().event_code(), 16);
        assert_eq!("Digit1".parse::<KeyCode>().unwrap().event_code(), 2);
        let error = "Entre".parse::<KeyCode>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown key `Entre`, did you mean `Enter`?"
        );
    }

    #[test]
    fn a_character_maps_to_its_keys_with_and_without_shift() {
        let text = |character| -> Vec<String> {
            let keys = KeyCode::for_us_character(character);
            keys.map(|(key, shifted)| format!("{}{key}", if shifted { "Shift+" } else { "" }))
                .collect()
        };
        assert_eq!(text('q'), ["Q"]);
        assert_eq!(text('Q'), ["Shift+Q"]);
        assert_eq!(text('!'), ["Shift+1"]);
        assert_eq!(text('*')[0], "NumpadMultiply");
        assert!(text('*').contains(&"Shift+8".to_owned()));
        assert_eq!(text('é'), Vec::<String>::new());
    }
}

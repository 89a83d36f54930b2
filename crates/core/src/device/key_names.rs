//! Other names of keys: aliases that files may use, and the names that X11 has for them.

use super::KeyCode;
use crate::names::{self, UnknownName};

/// The other names of a key.
struct OtherNames {
    /// Name in files and output.
    name: &'static str,
    /// Name of its X11 keysym on a US keymap.
    keysym: &'static str,
    /// Names that are accepted in its place.
    aliases: &'static [&'static str],
}

const fn other(
    name: &'static str,
    keysym: &'static str,
    aliases: &'static [&'static str],
) -> OtherNames {
    OtherNames {
        name,
        keysym,
        aliases,
    }
}

/// The keys other than letters, digits and F keys, whose keysym is their character or name. A modifier without a side is
/// the left one.
#[rustfmt::skip]
const OTHER_NAMES: &[OtherNames] = &[
    other("Escape", "Escape", &["Esc"]),
    other("Minus", "minus", &["-", "Hyphen"]),
    other("Equal", "equal", &["=", "Equals"]),
    other("Backspace", "BackSpace", &["BkSp", "Bksp"]),
    other("Tab", "Tab", &[]),
    other("BracketLeft", "bracketleft", &["[", "LeftBracket"]),
    other("BracketRight", "bracketright", &["]", "RightBracket"]),
    other("Enter", "Return", &["Return", "Ret"]),
    other("ControlLeft", "Control_L", &["Ctrl", "Control", "CtrlLeft", "LeftCtrl", "LCtrl"]),
    other("Semicolon", "semicolon", &[";"]),
    other("Quote", "apostrophe", &["'", "Apostrophe"]),
    other("Backquote", "grave", &["`", "Grave", "Backtick"]),
    other("ShiftLeft", "Shift_L", &["Shift", "LeftShift", "LShift"]),
    other("Backslash", "backslash", &["\\"]),
    other("Comma", "comma", &[","]),
    other("Period", "period", &[".", "Dot"]),
    other("Slash", "slash", &["/"]),
    other("ShiftRight", "Shift_R", &["RightShift", "RShift"]),
    other("NumpadMultiply", "KP_Multiply", &["NumpadStar"]),
    other("AltLeft", "Alt_L", &["Alt", "Option", "LeftAlt", "LAlt"]),
    other("Space", "space", &["Spacebar"]),
    other("CapsLock", "Caps_Lock", &["Caps"]),
    other("NumLock", "Num_Lock", &["Num"]),
    other("ScrollLock", "Scroll_Lock", &["Scroll"]),
    other("Numpad7", "KP_7", &[]),
    other("Numpad8", "KP_8", &[]),
    other("Numpad9", "KP_9", &[]),
    other("NumpadSubtract", "KP_Subtract", &["NumpadMinus"]),
    other("Numpad4", "KP_4", &[]),
    other("Numpad5", "KP_5", &[]),
    other("Numpad6", "KP_6", &[]),
    other("NumpadAdd", "KP_Add", &["NumpadPlus"]),
    other("Numpad1", "KP_1", &[]),
    other("Numpad2", "KP_2", &[]),
    other("Numpad3", "KP_3", &[]),
    other("Numpad0", "KP_0", &[]),
    other("NumpadDecimal", "KP_Decimal", &["NumpadDot"]),
    other("IntlBackslash", "less", &["<", "Less"]),
    other("NumpadEnter", "KP_Enter", &[]),
    other("ControlRight", "Control_R", &["CtrlRight", "RightCtrl", "RCtrl"]),
    other("NumpadDivide", "KP_Divide", &["NumpadSlash"]),
    other("PrintScreen", "Print", &["PrtSc", "PrtScn", "Print", "SysRq"]),
    other("AltRight", "ISO_Level3_Shift", &["AltGr", "RightAlt", "RAlt"]),
    other("Home", "Home", &[]),
    other("ArrowUp", "Up", &["Up"]),
    other("PageUp", "Prior", &["PgUp"]),
    other("ArrowLeft", "Left", &["Left"]),
    other("ArrowRight", "Right", &["Right"]),
    other("End", "End", &[]),
    other("ArrowDown", "Down", &["Down"]),
    other("PageDown", "Next", &["PgDn", "PgDown"]),
    other("Insert", "Insert", &["Ins"]),
    other("Delete", "Delete", &["Del"]),
    other("AudioVolumeMute", "XF86AudioMute", &["Mute", "VolMute", "VolumeMute"]),
    other("AudioVolumeDown", "XF86AudioLowerVolume", &["VolDown", "VolDn", "VolumeDown"]),
    other("AudioVolumeUp", "XF86AudioRaiseVolume", &["VolUp", "VolumeUp"]),
    other("Pause", "Pause", &["Break"]),
    other("MetaLeft", "Super_L", &["Win", "Windows", "Super", "Meta", "Cmd", "Command", "LeftMeta", "LWin"]),
    other("MetaRight", "Super_R", &["RightMeta", "RWin"]),
    other("ContextMenu", "Menu", &["Menu", "Apps"]),
    other("MediaTrackNext", "XF86AudioNext", &["NextTrack"]),
    other("MediaPlayPause", "XF86AudioPlay", &["Play", "PlayPause"]),
    other("MediaTrackPrevious", "XF86AudioPrev", &["PrevTrack", "PreviousTrack"]),
    other("MediaStop", "XF86AudioStop", &["StopMedia"]),
    other("MouseLeft", "Pointer_Button1", &["LMB", "LeftClick", "Button1"]),
    other("MouseRight", "Pointer_Button3", &["RMB", "RightClick", "Button3"]),
    other("MouseMiddle", "Pointer_Button2", &["MMB", "MiddleClick", "Button2"]),
    other("MouseBack", "Pointer_Button8", &["Button8"]),
    other("MouseForward", "Pointer_Button9", &["Button9"]),
];

fn find(name: &str) -> Option<&'static OtherNames> {
    OTHER_NAMES.iter().find(|other| other.name == name)
}

impl KeyCode {
    /// Returns the names that files may use in place of the [name](Self::name).
    pub fn aliases(self) -> &'static [&'static str] {
        find(self.name()).map_or(&[], |other| other.aliases)
    }

    /// Returns the name of the X11 keysym on a US keymap. A gamepad button has none.
    pub fn x11_keysym(self) -> Option<String> {
        let character = |key: Self| key.us_character(false).map(String::from);
        match find(self.name()) {
            Some(other) => Some(other.keysym.to_owned()),
            None if self.kind() == super::KeyKind::Gamepad => None,
            None => character(self).or_else(|| Some(self.name().to_owned())),
        }
    }

    /// Returns the key with this alias, W3C name with prefix (`KeyQ`, `Digit1`) or lower-case letter.
    pub(super) fn from_other_name(text: &str) -> Option<Self> {
        let prefixed = ["Key", "Digit"]
            .iter()
            .find_map(|prefix| text.strip_prefix(prefix))
            .filter(|rest| rest.len() == 1);
        let is_lower_case = text.len() == 1 && text.as_bytes()[0].is_ascii_lowercase();
        let letter = is_lower_case.then(|| text.to_ascii_uppercase());
        let name = prefixed.or(letter.as_deref());
        Self::all().find(|key| Some(key.name()) == name || key.aliases().contains(&text))
    }

    /// Returns the error for a name that no key has. It suggests the key with this X11 name, or the nearest name or alias.
    pub(super) fn unknown(text: &str) -> UnknownName {
        let with_keysym = Self::all().find(|key| key.x11_keysym().as_deref() == Some(text));
        let spellings = || {
            Self::all().flat_map(|key| {
                [key.name()]
                    .into_iter()
                    .chain(key.aliases().iter().copied())
            })
        };
        let nearest = match with_keysym {
            Some(key) => Some(key.name()),
            None => names::nearest(text, spellings()),
        };
        UnknownName {
            kind: "key",
            text: text.to_owned(),
            nearest: nearest.map(str::to_owned),
            expected: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn every_alias_means_one_key_and_is_no_name_of_another() {
        let mut keys = BTreeMap::new();
        for key in KeyCode::all() {
            for alias in key.aliases() {
                assert_eq!(keys.insert(*alias, key), None, "{alias}");
                assert_eq!(alias.parse::<KeyCode>(), Ok(key), "{alias}");
                assert!(
                    KeyCode::all().all(|other| other.name() != *alias),
                    "{alias}"
                );
            }
        }
        for other in OTHER_NAMES {
            assert!(
                KeyCode::all().any(|key| key.name() == other.name),
                "{}",
                other.name
            );
        }
    }

    #[test]
    fn usual_names_are_accepted() {
        for (alias, name) in [
            ("Ctrl", "ControlLeft"),
            ("Return", "Enter"),
            ("Up", "ArrowUp"),
            ("Win", "MetaLeft"),
            ("Alt", "AltLeft"),
            ("AltGr", "AltRight"),
            ("Esc", "Escape"),
            ("PgUp", "PageUp"),
            ("VolUp", "AudioVolumeUp"),
            ("LMB", "MouseLeft"),
            (";", "Semicolon"),
            ("q", "Q"),
            ("KeyQ", "Q"),
        ] {
            let key = alias.parse::<KeyCode>().map(KeyCode::name);
            assert_eq!(key, Ok(name), "{alias}");
        }
    }

    #[test]
    fn an_unknown_key_suggests_by_alias_and_x11_name_and_never_without_a_common_letter() {
        for (text, suggestion) in [
            ("Retrun", Some("Return")),
            ("Contrl", Some("Control")),
            ("PgUpp", Some("PgUp")),
            ("Volup", Some("VolUp")),
            ("Super_L", Some("MetaLeft")),
            ("Prior", Some("PageUp")),
            ("Wun", Some("Win")),
            ("Xyzzy", None),
            ("Foo", None),
            ("ñ", None),
        ] {
            let error = text.parse::<KeyCode>().unwrap_err();
            assert_eq!(error.nearest.as_deref(), suggestion, "{text}");
        }
    }

    #[test]
    fn keysyms_of_letters_digits_and_function_keys_follow_from_their_names() {
        let keysym = |name: &str| name.parse::<KeyCode>().unwrap().x11_keysym();
        assert_eq!(keysym("Q").as_deref(), Some("q"));
        assert_eq!(keysym("1").as_deref(), Some("1"));
        assert_eq!(keysym("F5").as_deref(), Some("F5"));
        assert_eq!(keysym("Slash").as_deref(), Some("slash"));
        assert_eq!(keysym("PadSouth"), None);
    }
}

//! Keymaps of virtual keyboards.

use std::fs::File;
use std::io::Write;
use std::os::unix::fs::FileExt;

use rustix::fs::{MemfdFlags, memfd_create};
use xkbcommon::xkb;

use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::KeyDirection;

/// The keymap format `XKB_V1`: text with a NUL at its end.
pub const FORMAT: u32 = 1;

/// The event code of the key that types the character of [`Keymap::from_character`]: `KEY_A`, which types a character
/// in every keymap and is not a shortcut.
pub const CHARACTER_KEY: u32 = 30;

/// Offset of XKB key codes from event codes.
const XKB_OFFSET: u32 = 8;

/// Maximum size of a keymap, in bytes.
const MAX_BYTES: u32 = 1 << 20;

/// A keymap in a file for the compositor, with the state of its modifiers.
pub struct Keymap {
    file: File,
    size: u32,
    state: xkb::State,
}

impl Keymap {
    /// Reads the keymap of the seat from the file and size that the compositor sent. `None` stands for a seat without
    /// a keyboard and results in the default keymap of the system.
    pub fn from_seat(sent: Option<(File, u32)>) -> Result<Self, String> {
        let context = xkb::Context::new(xkb::CONTEXT_NO_FLAGS);
        let flags = xkb::KEYMAP_COMPILE_NO_FLAGS;
        let keymap = match sent {
            Some((file, size)) => compile(&context, read_text(&file, size)?),
            None => xkb::Keymap::new_from_names(&context, "", "", "", "", None, flags),
        };
        Self::new(&keymap.ok_or("the keymap of the desktop is invalid")?)
    }

    /// Creates a keymap with one key, [`CHARACTER_KEY`], which types `character`.
    pub fn from_character(character: char) -> Result<Self, String> {
        let context = xkb::Context::new(xkb::CONTEXT_NO_FLAGS);
        let keymap =
            keysym(character).and_then(|keysym| compile(&context, single_key_keymap(&keysym)));
        Self::new(&keymap.ok_or("no key can type this character")?)
    }

    fn new(keymap: &xkb::Keymap) -> Result<Self, String> {
        let mut text = keymap
            .get_as_string(xkb::KEYMAP_FORMAT_TEXT_V1)
            .into_bytes();
        text.push(0);
        let file_error =
            |error: &dyn std::fmt::Display| format!("cannot create a keymap file: {error}");
        let file = memfd_create("ademan-keymap", MemfdFlags::CLOEXEC);
        let mut file = File::from(file.map_err(|error| file_error(&error))?);
        file.write_all(&text).map_err(|error| file_error(&error))?;
        Ok(Self {
            file,
            size: u32::try_from(text.len()).map_err(|error| file_error(&error))?,
            state: xkb::State::new(keymap),
        })
    }

    /// Returns the file with the text.
    pub fn file(&self) -> &File {
        &self.file
    }

    /// Returns the length of the text including the NUL, in bytes.
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Applies a key event. Returns the new modifier state, as depressed, latched and locked modifiers and the group,
    /// or `None` if it is unchanged.
    pub fn update(&mut self, key: KeyCode, direction: KeyDirection) -> Option<[u32; 4]> {
        let direction = match direction {
            KeyDirection::Press => xkb::KeyDirection::Down,
            KeyDirection::Release => xkb::KeyDirection::Up,
        };
        let before = self.modifiers();
        self.state.update_key(key.x11_code().into(), direction);
        let after = self.modifiers();
        (before != after).then_some(after)
    }

    fn modifiers(&self) -> [u32; 4] {
        [
            self.state.serialize_mods(xkb::STATE_MODS_DEPRESSED),
            self.state.serialize_mods(xkb::STATE_MODS_LATCHED),
            self.state.serialize_mods(xkb::STATE_MODS_LOCKED),
            self.state.serialize_layout(xkb::STATE_LAYOUT_EFFECTIVE),
        ]
    }
}

fn compile(context: &xkb::Context, text: String) -> Option<xkb::Keymap> {
    let (format, flags) = (xkb::KEYMAP_FORMAT_TEXT_V1, xkb::KEYMAP_COMPILE_NO_FLAGS);
    xkb::Keymap::new_from_string(context, text, format, flags)
}

/// Reads the text of a keymap file. Other clients share the file, so its offset stays unchanged.
fn read_text(file: &File, size: u32) -> Result<String, String> {
    let mut text = vec![0; size.min(MAX_BYTES) as usize];
    file.read_exact_at(&mut text, 0)
        .map_err(|error| format!("cannot read the keymap of the desktop: {error}"))?;
    let end = text.iter().position(|byte| *byte == 0);
    text.truncate(end.unwrap_or(text.len()));
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// Returns the name of the keysym that types a character. `None` if there is none, as for U+FFFE.
fn keysym(character: char) -> Option<String> {
    // The keysym of a line feed is Return.
    let character = if character == '\n' { '\r' } else { character };
    let keysym = xkb::utf32_to_keysym(character.into());
    (keysym != xkb::Keysym::NoSymbol).then(|| xkb::keysym_get_name(keysym))
}

/// Returns the text of a keymap in which only [`CHARACTER_KEY`] has a keysym.
fn single_key_keymap(keysym: &str) -> String {
    let code = CHARACTER_KEY + XKB_OFFSET;
    format!(
        "xkb_keymap {{
            xkb_keycodes {{ minimum = 8; maximum = 255; <CHAR> = {code}; }};
            xkb_types {{ include \"basic\" }};
            xkb_compat {{ include \"basic\" }};
            xkb_symbols {{ key <CHAR> {{ [ {keysym} ] }}; }};
        }};"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str) -> KeyCode {
        name.parse().unwrap()
    }

    fn typed_by(keymap: &Keymap) -> String {
        keymap
            .state
            .key_get_utf8((CHARACTER_KEY + XKB_OFFSET).into())
    }

    #[test]
    fn the_keymap_of_a_character_types_it() {
        for character in "aA€ß日🙂{\t ".chars() {
            let keymap = Keymap::from_character(character).unwrap();
            assert_eq!(typed_by(&keymap), character.to_string());
        }
        assert_eq!(typed_by(&Keymap::from_character('\n').unwrap()), "\r");
        assert!(Keymap::from_character('\u{fffe}').is_err());
    }

    #[test]
    fn the_keymap_of_the_seat_is_used_unchanged() {
        let sent = Keymap::from_character('ß').unwrap();
        let file = sent.file.try_clone().unwrap();
        let received = Keymap::from_seat(Some((file, sent.size))).unwrap();
        assert_eq!(typed_by(&received), "ß");
        let text = read_text(&received.file, received.size).unwrap();
        assert!(text.ends_with("};\n"), "{text}");
    }

    #[test]
    fn a_short_file_and_an_invalid_keymap_are_rejected() {
        let sent = Keymap::from_character('a').unwrap();
        let file = sent.file.try_clone().unwrap();
        let too_long = Keymap::from_seat(Some((file, sent.size + 1)));
        assert!(too_long.err().unwrap().contains("cannot read"));
        let mut invalid = tempfile::tempfile().unwrap();
        invalid.write_all(b"nonsense\0").unwrap();
        let nonsense = Keymap::from_seat(Some((invalid, 9)));
        assert!(nonsense.err().unwrap().contains("is invalid"));
    }

    #[test]
    fn a_modifier_is_active_while_pressed_and_a_lock_until_pressed_again() {
        let mut keymap = Keymap::from_seat(None).unwrap();
        let mut after = |name: &str, direction| keymap.update(key(name), direction);
        const SHIFT: u32 = 1;
        const LOCK: u32 = 2;
        assert_eq!(
            after("ShiftLeft", KeyDirection::Press),
            Some([SHIFT, 0, 0, 0])
        );
        assert_eq!(after("A", KeyDirection::Press), None);
        assert_eq!(after("A", KeyDirection::Release), None);
        assert_eq!(after("ShiftLeft", KeyDirection::Release), Some([0; 4]));
        assert_eq!(
            after("CapsLock", KeyDirection::Press),
            Some([LOCK, 0, LOCK, 0])
        );
        assert_eq!(
            after("CapsLock", KeyDirection::Release),
            Some([0, 0, LOCK, 0])
        );
    }
}

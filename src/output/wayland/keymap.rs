//! What the keys of a virtual keyboard are good for.

use std::fs::File;
use std::io::Write;
use std::os::unix::fs::FileExt;

use enigo::Direction;
use rustix::fs::{MemfdFlags, memfd_create};
use xkbcommon::xkb;

use crate::device::KeyCode;

/// The only format there is: that of XKB, as text with a NUL at its end.
pub const FORMAT: u32 = 1;

/// The event code of the key that writes the character of [`Keymap::of_character`]: one that writes in any
/// keymap, and that no program takes for something else.
pub const CHARACTER_KEY: u32 = 30;

/// More than any keymap has.
const MOST_BYTES: u32 = 1 << 20;

/// A keymap, in a file for the compositor, and what its keys do to Shift and the like.
pub struct Keymap {
    file: File,
    size: u32,
    state: xkb::State,
}

impl Keymap {
    /// That of the seat, from the file and size that the compositor gave; the usual one of the system where the
    /// seat has no keyboard.
    pub fn of_seat(given: Option<(File, u32)>) -> Result<Self, String> {
        let context = xkb::Context::new(xkb::CONTEXT_NO_FLAGS);
        let keymap = match given {
            Some((file, size)) => from_text(&context, text_in(&file, size)?),
            None => xkb::Keymap::new_from_names(
                &context,
                "",
                "",
                "",
                "",
                None,
                xkb::KEYMAP_COMPILE_NO_FLAGS,
            ),
        };
        Self::new(&keymap.ok_or("the keymap of the desktop makes no sense")?)
    }

    /// One with a single key, [`CHARACTER_KEY`], for a single character.
    pub fn of_character(character: char) -> Result<Self, String> {
        let context = xkb::Context::new(xkb::CONTEXT_NO_FLAGS);
        let keymap = from_text(&context, only_with(keysym(character)));
        Self::new(&keymap.ok_or("no key can write this character")?)
    }

    fn new(keymap: &xkb::Keymap) -> Result<Self, String> {
        let mut text = keymap
            .get_as_string(xkb::KEYMAP_FORMAT_TEXT_V1)
            .into_bytes();
        text.push(0);
        let no_file = |error: &dyn std::fmt::Display| format!("no file for a keymap: {error}");
        let file = memfd_create("ademan-keymap", MemfdFlags::CLOEXEC);
        let mut file = File::from(file.map_err(|error| no_file(&error))?);
        file.write_all(&text).map_err(|error| no_file(&error))?;
        Ok(Self {
            file,
            size: u32::try_from(text.len()).map_err(|error| no_file(&error))?,
            state: xkb::State::new(keymap),
        })
    }

    pub fn file(&self) -> &File {
        &self.file
    }

    pub fn size(&self) -> u32 {
        self.size
    }

    /// What is depressed, latched and locked, and which group counts, once a key went down or up; `None` when that
    /// changed nothing.
    pub fn modifiers_after(&mut self, key: KeyCode, direction: Direction) -> Option<[u32; 4]> {
        let direction = match direction {
            Direction::Press => xkb::KeyDirection::Down,
            Direction::Release | Direction::Click => xkb::KeyDirection::Up,
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

fn from_text(context: &xkb::Context, text: String) -> Option<xkb::Keymap> {
    let (format, flags) = (xkb::KEYMAP_FORMAT_TEXT_V1, xkb::KEYMAP_COMPILE_NO_FLAGS);
    xkb::Keymap::new_from_string(context, text, format, flags)
}

/// The text of a keymap. Others read the same file, so its place in it is left alone.
fn text_in(file: &File, size: u32) -> Result<String, String> {
    let mut text = vec![0; size.min(MOST_BYTES) as usize];
    file.read_exact_at(&mut text, 0)
        .map_err(|error| format!("the keymap of the desktop cannot be read: {error}"))?;
    let end = text.iter().position(|byte| *byte == 0);
    text.truncate(end.unwrap_or(text.len()));
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// The name of what a key has to mean to write a character.
fn keysym(character: char) -> String {
    // The key that begins a new line is Return.
    let character = if character == '\n' { '\r' } else { character };
    xkb::keysym_get_name(xkb::utf32_to_keysym(character.into()))
}

/// The text of a keymap in which [`CHARACTER_KEY`] means this and no other key means anything.
fn only_with(keysym: String) -> String {
    let code = CHARACTER_KEY + 8;
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

    fn written_by(keymap: &Keymap) -> String {
        keymap.state.key_get_utf8((CHARACTER_KEY + 8).into())
    }

    #[test]
    fn a_character_gets_a_keymap_that_writes_just_it() {
        for character in "aA€ß日🙂{\t ".chars() {
            let keymap = Keymap::of_character(character).unwrap();
            assert_eq!(written_by(&keymap), character.to_string());
        }
        assert_eq!(written_by(&Keymap::of_character('\n').unwrap()), "\r");
    }

    #[test]
    fn a_keymap_arrives_as_it_was_given() {
        let given = Keymap::of_character('ß').unwrap();
        let file = given.file.try_clone().unwrap();
        let taken = Keymap::of_seat(Some((file, given.size))).unwrap();
        assert_eq!(written_by(&taken), "ß");
        let text = text_in(&taken.file, taken.size).unwrap();
        assert!(text.ends_with("};\n"), "{text}");
    }

    #[test]
    fn a_file_that_is_too_short_or_holds_no_keymap_is_refused() {
        let given = Keymap::of_character('a').unwrap();
        let file = given.file.try_clone().unwrap();
        let too_long = Keymap::of_seat(Some((file, given.size + 1)));
        assert!(too_long.err().unwrap().contains("cannot be read"));
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(b"nonsense\0").unwrap();
        let nonsense = Keymap::of_seat(Some((file, 9)));
        assert!(nonsense.err().unwrap().contains("makes no sense"));
    }

    #[test]
    fn a_modifier_counts_while_it_is_down_and_a_lock_until_the_next_time() {
        let mut keymap = Keymap::of_seat(None).unwrap();
        let mut after = |name: &str, direction| keymap.modifiers_after(key(name), direction);
        const SHIFT: u32 = 1;
        const LOCK: u32 = 2;
        assert_eq!(after("ShiftLeft", Direction::Press), Some([SHIFT, 0, 0, 0]));
        assert_eq!(after("A", Direction::Press), None);
        assert_eq!(after("A", Direction::Release), None);
        assert_eq!(after("ShiftLeft", Direction::Release), Some([0; 4]));
        assert_eq!(
            after("CapsLock", Direction::Press),
            Some([LOCK, 0, LOCK, 0])
        );
        assert_eq!(after("CapsLock", Direction::Release), Some([0, 0, LOCK, 0]));
    }
}

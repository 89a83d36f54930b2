//! Characters on an X server: clicks of the keys that type them.
//!
//! A character that no key types without a modifier gets a key that the keymap does not use. The receiver of the event
//! looks the key up in the keymap of the server, so it stays there for a while.

use std::thread;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::errors::ReplyError;
use x11rb::protocol::xproto::{
    ConnectionExt as _, GetKeyboardMappingReply, KEY_PRESS_EVENT, KEY_RELEASE_EVENT,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// Keysym of a key without a meaning.
const NO_SYMBOL: u32 = 0;

/// Offset of the keysyms of Unicode characters.
const UNICODE: u32 = 0x0100_0000;

/// The key code that is 0 as an event code, which receivers ignore.
const RESERVED_CODE: u8 = 8;

/// Time after its last use for which a key keeps its character, at the end of the connection.
const KEYMAP_LIFETIME: Duration = Duration::from_millis(200);

/// Time after its last use before a key gets another character.
const REUSE_DELAY: Duration = Duration::from_millis(50);

/// The keys that were added to the keymap of the server, in the order of their last use.
#[derive(Default)]
pub struct CharacterKeys {
    added: Vec<AddedKey>,
}

struct AddedKey {
    code: u8,
    last_use: Instant,
}

impl CharacterKeys {
    /// Types a character and waits until the server has executed it. Returns `false` if no key can type it, as the
    /// keymap of the user uses all.
    ///
    /// Press and release are in one write: if this process is killed, the server executes both or none.
    pub fn click(
        &mut self,
        server: &RustConnection,
        root: u32,
        character: char,
    ) -> Result<bool, ReplyError> {
        let Some(code) = self.key_for(server, keysym(character))? else {
            return Ok(false);
        };
        let press = server.xtest_fake_input(KEY_PRESS_EVENT, code, 0, root, 0, 0, 0)?;
        let release = server.xtest_fake_input(KEY_RELEASE_EVENT, code, 0, root, 0, 0, 0)?;
        press.check()?;
        release.check()?;
        Ok(true)
    }

    /// Removes the added keys from the keymap, after receivers had time to look them up.
    pub fn remove_from_keymap(&mut self, server: &RustConnection) -> Result<(), ReplyError> {
        if let Some(last) = self.added.last() {
            thread::sleep(KEYMAP_LIFETIME.saturating_sub(last.last_use.elapsed()));
        }
        for key in self.added.drain(..) {
            assign(server, key.code, NO_SYMBOL)?;
        }
        Ok(())
    }

    /// Returns the key that types a keysym without a modifier; adds one to the keymap if necessary.
    fn key_for(&mut self, server: &RustConnection, keysym: u32) -> Result<Option<u8>, ReplyError> {
        let setup = server.setup();
        let (first, last) = (setup.min_keycode, setup.max_keycode);
        // Read each time, as the user may change the keymap.
        let keymap = server
            .get_keyboard_mapping(first, last - first + 1)?
            .reply()?;
        let codes = first..=last;
        if let Some(code) = codes
            .clone()
            .zip(keysyms_by_key(&keymap))
            .find_map(|(code, keysyms)| (keysyms.first() == Some(&keysym)).then_some(code))
        {
            if let Some(index) = self.added.iter().position(|key| key.code == code) {
                self.added.remove(index);
                self.remember(code);
            }
            return Ok(Some(code));
        }
        let is_unused = |(code, keysyms): &(u8, &[u32])| {
            *code != RESERVED_CODE && keysyms.iter().all(|keysym| *keysym == NO_SYMBOL)
        };
        let unused = codes.zip(keysyms_by_key(&keymap)).find(is_unused);
        let code = match unused {
            Some((code, _)) => code,
            None if self.added.is_empty() => return Ok(None),
            None => {
                let oldest = self.added.remove(0);
                thread::sleep(REUSE_DELAY.saturating_sub(oldest.last_use.elapsed()));
                oldest.code
            }
        };
        self.remember(code);
        assign(server, code, keysym)?;
        Ok(Some(code))
    }

    fn remember(&mut self, code: u8) {
        let last_use = Instant::now();
        self.added.push(AddedKey { code, last_use });
    }
}

/// Returns the keysyms of each key, without and with modifiers.
fn keysyms_by_key(keymap: &GetKeyboardMappingReply) -> impl Iterator<Item = &[u32]> {
    keymap
        .keysyms
        .chunks(usize::from(keymap.keysyms_per_keycode).max(1))
}

/// Assigns a keysym to a key and waits until the server has done so.
fn assign(server: &RustConnection, code: u8, keysym: u32) -> Result<(), ReplyError> {
    // Two keysyms: with one, the server would add its upper case for Shift.
    let keymap = server.change_keyboard_mapping(1, code, 2, &[keysym, keysym])?;
    keymap.check()
}

/// Returns the keysym that types a character (appendix A of the X11 protocol).
fn keysym(character: char) -> u32 {
    match character {
        // Backspace, Tab, Return and Escape; the keysym of a line feed is Return.
        '\u{8}' => 0xff08,
        '\t' => 0xff09,
        '\n' | '\r' => 0xff0d,
        '\u{1b}' => 0xff1b,
        // The keysyms of Latin 1 are its characters.
        ' '..='~' | '\u{a0}'..='\u{ff}' => u32::from(character),
        _ => UNICODE + u32::from(character),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn latin_1_is_its_own_keysym_and_other_characters_have_that_of_unicode() {
        let table = [
            ('a', 0x61),
            ('ß', 0xdf),
            ('\n', 0xff0d),
            ('\t', 0xff09),
            ('€', 0x0100_20ac),
            ('λ', 0x0100_03bb),
            ('🙂', 0x0101_f642),
        ];
        for (character, expected) in table {
            assert_eq!(keysym(character), expected, "{character:?}");
        }
    }
}

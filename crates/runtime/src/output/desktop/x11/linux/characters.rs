//! Characters on an X server: clicks of the keys that type them.
//!
//! A character that no key types without a modifier, or that a lock or another group would change, gets a key that the keymap
//! does not use. A receiver looks the key up in the keymap of the server when it handles the event, which may be late: the
//! key keeps its character for seconds, and it has the character in all groups and levels.

use std::thread;
use std::time::{Duration, Instant};

use x11rb::errors::ReplyError;
use x11rb::rust_connection::RustConnection;

use super::keymap::{self, Keymap};
use crate::output::character_key::{CharacterKey, KEYMAP_LIFETIME, KeymapChange};
use crate::output::desktop::key_reporter::KeyReporter;

/// Offset of the keysyms of Unicode characters.
const UNICODE: u32 = 0x0100_0000;

/// Number of key codes.
const CODES: usize = 256;

/// Time after its last use before a key gets another character.
const REUSE_DELAY: Duration = Duration::from_secs(5);

/// The keys that were added to the keymap of the server.
pub struct CharacterKeys {
    /// `true` if the server has the extension XKB, without which no key can be added.
    has_xkb: bool,
    added: Vec<CharacterKey>,
    /// The time of the last use of each key code.
    last_uses: [Option<Instant>; CODES],
}

/// The keys that type a text.
#[derive(Debug, PartialEq)]
struct Plan {
    codes: Vec<u8>,
    /// The keys to add to the keymap first.
    new: Vec<CharacterKey>,
}

impl CharacterKeys {
    /// Prepares a connection for changes of the keymap.
    pub fn new(server: &RustConnection) -> Self {
        Self::with_xkb(keymap::enable_xkb(server))
    }

    fn with_xkb(has_xkb: bool) -> Self {
        Self {
            has_xkb,
            added: Vec::new(),
            last_uses: [None; CODES],
        }
    }

    /// Adds the keys that the keymap lacks for a text, and returns the codes of the keys that type it. Returns `None` if it cannot be
    /// typed: the keymap has too few unused keys, or a pressed modifier would make shortcuts of the characters.
    pub fn prepare(
        &mut self,
        server: &RustConnection,
        root: u32,
        text: &str,
        reporter: &mut KeyReporter,
    ) -> Result<Option<Vec<u8>>, ReplyError> {
        // Read each time, as the user may change the keymap.
        let keymap = Keymap::read(server, root)?;
        self.forget_changed(&keymap, reporter);
        let Some(plan) = self.plan(&keymap, text, Instant::now()) else {
            return Ok(None);
        };
        for key in plan.new {
            reporter.report_character_key(key, KeymapChange::Added);
            self.added.retain(|other| other.code != key.code);
            self.added.push(key);
            match keymap::assign(server, key) {
                Ok(()) => {}
                Err(ReplyError::X11Error(_)) => return Ok(None),
                Err(error) => return Err(error),
            }
        }
        Ok(Some(plan.codes))
    }

    /// Stores the present time as the last use of these keys.
    pub fn note_use(&mut self, codes: &[u8]) {
        for code in codes {
            self.last_uses[usize::from(*code)] = Some(Instant::now());
        }
    }

    /// Waits until receivers have had time to look the added keys up, and removes them from the keymap.
    pub fn restore(
        &mut self,
        server: &RustConnection,
        reporter: &mut KeyReporter,
    ) -> Result<(), ReplyError> {
        let last_use = |key: &CharacterKey| self.last_uses[usize::from(key.code)];
        if let Some(last_use) = self.added.iter().filter_map(last_use).max() {
            thread::sleep(KEYMAP_LIFETIME.saturating_sub(last_use.elapsed()));
        }
        for key in self.added.drain(..) {
            keymap::remove(server, key)?;
            reporter.report_character_key(key, KeymapChange::Removed);
        }
        Ok(())
    }

    /// Forgets the keys that have another meaning by now: the user has changed the keymap.
    fn forget_changed(&mut self, keymap: &Keymap, reporter: &mut KeyReporter) {
        self.added.retain(|key| {
            let is_unchanged = keymap.has(*key);
            if !is_unchanged {
                reporter.report_character_key(*key, KeymapChange::Removed);
            }
            is_unchanged
        });
    }

    /// Chooses a key for each character. Returns `None` if a character cannot be typed.
    fn plan(&self, keymap: &Keymap, text: &str, now: Instant) -> Option<Plan> {
        if keymap.is_shortcut() {
            return None;
        }
        let keysyms: Vec<_> = text.chars().map(keysym).collect();
        let mut free = self.free_codes(keymap, &keysyms, now).into_iter();
        let is_unmodified = keymap.is_unmodified();
        let mut plan = Plan {
            codes: Vec::with_capacity(keysyms.len()),
            new: Vec::new(),
        };
        for keysym in keysyms {
            let present = is_unmodified.then(|| keymap.unmodified_key(keysym));
            let has_keysym = |key: &&CharacterKey| key.keysym == keysym;
            let added = || self.added.iter().chain(&plan.new).find(has_keysym);
            let code = present.flatten().or_else(|| added().map(|key| key.code));
            let code = match code {
                Some(code) => code,
                None => {
                    let unused = free.next()?;
                    plan.new.push(CharacterKey {
                        code: unused,
                        keysym,
                    });
                    unused
                }
            };
            plan.codes.push(code);
        }
        Some(plan)
    }

    /// Returns the keys that may be assigned another character than these, in this order: keys that were never used, then keys by the
    /// time of their last use. A late receiver would read the new character in place of the earlier one.
    fn free_codes(&self, keymap: &Keymap, keysyms: &[u32], now: Instant) -> Vec<u8> {
        if !self.has_xkb {
            return Vec::new();
        }
        let is_needed = |key: &&CharacterKey| keysyms.contains(&key.keysym);
        let added = self.added.iter().filter(|key| !is_needed(key));
        let codes = keymap.unused_codes().chain(added.map(|key| key.code));
        let last_use = |code: &u8| self.last_uses[usize::from(*code)];
        let is_free = |code: &u8| last_use(code).is_none_or(|time| now - time >= REUSE_DELAY);
        let mut free: Vec<_> = codes.filter(is_free).collect();
        free.sort_by_key(last_use);
        free
    }
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
    use super::super::keymap::tests::{LOCK, SECOND_GROUP, SHIFT, UNUSED, keymap};
    use super::*;

    fn codes(keys: &CharacterKeys, unused: usize, state: u16, text: &str) -> Option<Vec<u8>> {
        let plan = keys.plan(&keymap(unused, state), text, Instant::now());
        plan.map(|plan| plan.codes)
    }

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

    #[test]
    fn a_key_of_the_keymap_is_used_only_without_modifiers_and_in_the_first_group() {
        let keys = CharacterKeys::with_xkb(true);
        assert_eq!(codes(&keys, 1, 0, "aa"), Some(vec![9, 9]));
        for state in [SHIFT, LOCK, SECOND_GROUP] {
            assert_eq!(codes(&keys, 1, state, "aa"), Some(vec![UNUSED; 2]));
            assert_eq!(codes(&keys, 0, state, "a"), None);
        }
    }

    #[test]
    fn a_text_has_a_key_for_each_character_or_none_is_typed() {
        let keys = CharacterKeys::with_xkb(true);
        let expected = Some(vec![UNUSED, 9, UNUSED + 1, UNUSED]);
        assert_eq!(codes(&keys, 2, 0, "ñaüñ"), expected);
        assert_eq!(codes(&keys, 1, 0, "ñaüñ"), None);
        assert_eq!(codes(&keys, 0, 0, "aaa"), Some(vec![9; 3]));
        let without_xkb = CharacterKeys::with_xkb(false);
        assert_eq!(codes(&without_xkb, 1, 0, "ñ"), None);
        assert_eq!(codes(&without_xkb, 1, 0, "a"), Some(vec![9]));
    }

    #[test]
    fn a_key_gets_another_character_only_seconds_after_its_last_use() {
        let mut keys = CharacterKeys::with_xkb(true);
        let start = Instant::now();
        let used = |code: u8, character| CharacterKey {
            code,
            keysym: keysym(character),
        };
        keys.added = vec![used(UNUSED, 'ñ'), used(UNUSED + 1, 'ü')];
        keys.last_uses[usize::from(UNUSED)] = Some(start + Duration::from_secs(1));
        keys.last_uses[usize::from(UNUSED + 1)] = Some(start);
        // No key of the keymap is unused beside them.
        let plan = |text, seconds| {
            let now = start + Duration::from_secs(seconds);
            keys.plan(&keymap(0, 0), text, now).map(|plan| plan.codes)
        };
        assert_eq!(plan("ñü", 1), Some(vec![UNUSED, UNUSED + 1]));
        assert_eq!(plan("λ", 1), None);
        assert_eq!(plan("λ", 5), Some(vec![UNUSED + 1]));
        assert_eq!(plan("λü", 5), None);
        assert_eq!(plan("λμ", 6), Some(vec![UNUSED + 1, UNUSED]));
    }

    #[test]
    fn a_key_that_a_change_of_the_keymap_has_freed_keeps_its_delay() {
        let mut keys = CharacterKeys::with_xkb(true);
        keys.last_uses[usize::from(UNUSED)] = Some(Instant::now());
        assert_eq!(codes(&keys, 2, 0, "λ"), Some(vec![UNUSED + 1]));
        assert_eq!(codes(&keys, 1, 0, "λ"), None);
    }
}

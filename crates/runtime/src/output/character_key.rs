//! Keys that this program adds to the keymap of a display to type characters.

use std::time::Duration;

/// Time after its last use for which a key keeps its character, at the end of a run: a receiver may look it up late.
pub const KEYMAP_LIFETIME: Duration = Duration::from_millis(300);

/// A key that was added to a keymap. It may be removed only while it has this keysym: the user may change the keymap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CharacterKey {
    /// The X11 key code.
    pub code: u8,
    /// The keysym in all groups and levels.
    pub keysym: u32,
}

/// A change of the keymap of a display by this program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeymapChange {
    /// A key was added.
    Added,
    /// A key was removed.
    Removed,
}

/// The keys that were added and not removed, at most one for each code.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AddedKeys(Vec<CharacterKey>);

impl AddedKeys {
    /// Applies a change. A key that is added replaces a key with the same code.
    pub fn apply(&mut self, key: CharacterKey, change: KeymapChange) {
        self.0.retain(|other| other.code != key.code);
        if change == KeymapChange::Added {
            self.0.push(key);
        }
    }

    /// Returns the keys.
    pub fn as_slice(&self) -> &[CharacterKey] {
        &self.0
    }
}

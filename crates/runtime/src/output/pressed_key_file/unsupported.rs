//! The stand-in on operating systems without a runtime folder of the user.

use crate::output::character_key::{CharacterKey, KeymapChange};
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::KeyDirection;

/// A file that cannot exist.
pub enum PressedKeyFile {}

impl PressedKeyFile {
    /// Returns `None`.
    pub fn create() -> Option<Self> {
        None
    }

    pub fn is_in_memory(&self) -> bool {
        match *self {}
    }

    pub fn record(&self, _: KeyCode, _: KeyDirection) {
        match *self {}
    }

    pub fn record_character_key(&self, _: CharacterKey, _: KeymapChange) {
        match *self {}
    }

    pub fn abandon(&self) {
        match *self {}
    }
}

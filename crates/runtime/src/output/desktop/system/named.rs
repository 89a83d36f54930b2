//! Windows and macOS: keys are injected by name.

use enigo::{Direction, Enigo, InputResult};

use super::KEY_CODES;
use super::named_keys::{has_named_key, inject_by_name};
use ademan_core::device::KeyCode;

/// Injects the key of this name.
pub fn inject_key(enigo: &mut Enigo, key: KeyCode, direction: Direction) -> InputResult<()> {
    inject_by_name(enigo, key, direction, KEY_CODES)
}

/// Returns `true` if the system has this key.
pub fn has_key(key: KeyCode) -> bool {
    has_named_key(key, KEY_CODES)
}

/// Returns the message for a desktop that cannot be reached.
pub fn no_display(_: Option<&str>) -> String {
    "no desktop session found; start the program from a graphical session".into()
}

//! Systems without raw devices.

use std::path::Path;

use crate::output::midi::thread::Writer;

/// The reason and the remedy.
const REASON: &str = "this system has no raw MIDI devices; use the output `midi` without a device";

/// Fails: this system has no raw MIDI devices.
pub fn open(_: &Path) -> Result<Writer, String> {
    Err(REASON.into())
}

/// Fails as [`open`] does.
pub fn check(_: &Path) -> Result<(), String> {
    Err(REASON.into())
}

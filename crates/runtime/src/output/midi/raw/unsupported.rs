//! Systems without raw devices.

use std::path::Path;

use crate::output::midi::thread::Writer;

/// Fails: this system has no raw devices of MIDI.
pub fn open(_: &Path) -> Result<Writer, String> {
    Err("this system has no raw devices of MIDI; use the output `midi` without a device".into())
}

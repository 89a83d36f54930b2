//! Builds and systems without virtual ports.

use crate::output::midi::thread::Writer;

/// The reason and the remedy.
const REASON: &str = "this program was built without MIDI ports; build it with `--features midi` (on Linux with the package \
                      libasound2-dev), or name a raw device: midi:/dev/snd/midiC1D0";

/// Fails: this program has no virtual port.
pub fn open() -> Result<Writer, String> {
    Err(REASON.into())
}

/// Fails as [`open`] does.
pub fn check_build() -> Result<(), String> {
    Err(REASON.into())
}

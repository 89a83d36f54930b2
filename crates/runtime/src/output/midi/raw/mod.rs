//! Raw MIDI devices: character devices and pipes that take the bytes as a cable would.

#[cfg(unix)]
mod unix;
#[cfg(unix)]
pub(super) use unix::{check, open};

#[cfg(not(unix))]
mod unsupported;
#[cfg(not(unix))]
pub(super) use unsupported::{check, open};

//! A virtual port of MIDI, which other programs connect to.

#[cfg(all(feature = "midi", unix))]
mod unix;
#[cfg(all(feature = "midi", unix))]
pub(super) use unix::open;

#[cfg(not(all(feature = "midi", unix)))]
mod unsupported;
#[cfg(not(all(feature = "midi", unix)))]
pub(super) use unsupported::open;

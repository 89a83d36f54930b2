//! A virtual MIDI port, which other programs connect to.

#[cfg(all(feature = "midi", unix))]
mod unix;
#[cfg(all(feature = "midi", unix))]
pub(super) use unix::open;

/// Checks that this build has virtual ports. An error states the reason and the remedy.
#[cfg(all(feature = "midi", unix))]
pub(super) fn check_build() -> Result<(), String> {
    Ok(())
}

#[cfg(not(all(feature = "midi", unix)))]
mod unsupported;
#[cfg(not(all(feature = "midi", unix)))]
pub(super) use unsupported::{check_build, open};

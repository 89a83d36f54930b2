//! The process of the watchdog on Linux.

use std::path::PathBuf;

use crate::failure::Failure;

/// Returns the file that this process executes, also if an upgrade has replaced or deleted it.
pub fn running_image() -> Result<PathBuf, Failure> {
    Ok("/proc/self/exe".into())
}

/// Starts a session of its own, so that no signal of the terminal reaches this process.
pub fn detach() {
    // Fails only if this process leads a session already.
    let _ = rustix::process::setsid();
}

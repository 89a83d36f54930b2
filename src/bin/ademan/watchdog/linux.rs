//! The process of the watchdog on Linux.

use std::fs;
use std::path::PathBuf;

use crate::failure::Failure;

/// Returns the file that this process executes, also if an upgrade has replaced or deleted it.
pub fn running_image() -> Result<PathBuf, Failure> {
    Ok("/proc/self/exe".into())
}

/// Starts a session of its own, so that no signal of the terminal reaches this process, and takes the name of the program:
/// that of the file is `exe`.
pub fn detach() {
    // Fails only if this process leads a session already.
    let _ = rustix::process::setsid();
    let name = env!("CARGO_PKG_NAME");
    // Only lists of processes show it.
    let _ = fs::write("/proc/self/comm", name);
}

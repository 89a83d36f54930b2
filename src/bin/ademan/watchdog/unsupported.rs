//! Operating systems that have no watchdog yet.

use std::path::PathBuf;

use crate::failure::Failure;

/// Returns the path of this program.
pub fn running_image() -> Result<PathBuf, Failure> {
    std::env::current_exe().map_err(|error| {
        Failure::wrong_use(format!(
            "cannot find the path of this program, which starts itself as the watchdog: {error}; start it by its full path"
        ))
    })
}

/// Does nothing.
pub fn detach() {}

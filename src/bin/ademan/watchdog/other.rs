//! The watchdog on operating systems other than Linux.

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

/// Leaves the terminal session of the main process. On Windows the process was started without its console.
pub fn detach() {
    #[cfg(unix)]
    let _ = rustix::process::setsid();
}

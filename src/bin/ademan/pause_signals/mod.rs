//! Signals that pause a session: SIGUSR1, and Ctrl-Z (SIGTSTP), which then stops the process.

#[cfg(unix)]
mod unix;
#[cfg(not(unix))]
mod unsupported;

#[cfg(unix)]
use unix as system;
#[cfg(not(unix))]
use unsupported as system;

pub use system::{install, install_without_session};

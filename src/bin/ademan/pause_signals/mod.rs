//! Signals that pause a session: SIGUSR1, and Ctrl-Z (SIGTSTP), which then stops the process. Ctrl-\ (SIGQUIT) ends it at once.

#[cfg(unix)]
mod unix;
#[cfg(not(unix))]
mod unsupported;

#[cfg(unix)]
use unix as system;
#[cfg(not(unix))]
use unsupported as system;

#[cfg(all(unix, feature = "studio"))]
pub use system::pause;
pub use system::{install, install_without_session};

use ademan::output;
use ademan::session::SessionHandle;

use crate::failure::Failure;

/// Does nothing: without these signals there are no panic keys either.
#[cfg(all(not(unix), feature = "studio"))]
pub fn pause(_: ademan::command::CommandOrigin) {}

/// Makes Ctrl-Z give the terminal back while a simulated hand plays, or a person practices. Without an effect outside this process
/// nothing is paused, so that no part of the text is lost.
pub fn install_for(session: &SessionHandle, output: &str) -> Result<(), Failure> {
    if output::has_effect(output) {
        install(session.commands().clone())
    } else {
        install_without_session()
    }
}

//! Terminals of Unix systems.

use std::io;

use rustix::termios::tcgetwinsize;

/// Returns the columns of the terminal of standard error; `None` if it is none, or does not know its size. Does not wait.
pub fn columns() -> Option<usize> {
    let size = tcgetwinsize(io::stderr()).ok()?;
    (size.ws_col > 0).then_some(size.ws_col.into())
}

//! Terminals of Unix systems.

use std::io;
use std::os::fd::AsFd;

use rustix::termios::tcgetwinsize;

/// Returns the columns of the terminal of standard error; `None` if it is none, or does not know its size. Does not wait.
pub fn columns() -> Option<usize> {
    columns_of(io::stderr())
}

/// Returns the columns of the terminal of standard output, as [`columns`] does.
pub fn output_columns() -> Option<usize> {
    columns_of(io::stdout())
}

fn columns_of(stream: impl AsFd) -> Option<usize> {
    let size = tcgetwinsize(stream).ok()?;
    (size.ws_col > 0).then_some(size.ws_col.into())
}

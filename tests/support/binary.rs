//! The program of this package.

use std::ffi::OsStr;
use std::process::Command;

/// `ademan` with these arguments. A run gets leave to be root's, as tests are in containers.
pub fn ademan(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ademan"));
    let mut arguments = arguments.into_iter().peekable();
    let is_run = arguments
        .peek()
        .is_some_and(|first| first.as_ref() == "run");
    command.args(arguments);
    if is_run {
        command.arg("--allow-root");
    }
    command
}

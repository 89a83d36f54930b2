//! The program of this package.

use std::env;
use std::ffi::OsStr;
use std::process::Command;

/// `ademan` with these arguments. A run gets leave to be root's, as tests are in containers.
pub fn ademan(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
    // Named where it is not where it was built: in a machine of its own.
    let program = env::var_os("ADEMAN_PROGRAM");
    let program = program.unwrap_or_else(|| env!("CARGO_BIN_EXE_ademan").into());
    let mut command = Command::new(program);
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

//! The binary of this package.

use std::env;
use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;

use super::process::limit_lifetimes;

/// A folder of settings that does not exist, and that not even root can make, because it is below a file.
pub const NO_FOLDER: &str = "/dev/null/nowhere";

/// Copies the binary to `path`. Another process writes it: a file that this process had open for writing may be open in the
/// child of another test when it is started, which is an error then (ETXTBSY).
pub fn copy_binary(path: &Path) {
    let original = ademan([""; 0]);
    let copied = Command::new("cp")
        .arg(original.get_program())
        .arg(path)
        .status();
    assert!(copied.expect("`cp` starts").success(), "{}", path.display());
}

/// Returns the command `ademan` with these arguments. It may type as root, as containers run tests as root.
pub fn ademan(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
    limit_lifetimes();
    // Set in a virtual machine, where the binary is not at the path at which it was built.
    let program = env::var_os("ADEMAN_PROGRAM");
    let program = program.unwrap_or_else(|| env!("CARGO_BIN_EXE_ademan").into());
    let mut command = Command::new(program);
    let mut arguments = arguments.into_iter().peekable();
    let may_type = arguments.peek().is_some_and(|first| {
        let commands = ["run", "webcam", "replay", "demo"];
        commands.iter().any(|known| first.as_ref() == *known)
    });
    command.args(arguments);
    // The files and settings of the person who runs the tests have no effect.
    command
        .env("XDG_CONFIG_HOME", NO_FOLDER)
        .env_remove("RUST_LOG");
    if may_type {
        command.arg("--allow-root");
    }
    command
}

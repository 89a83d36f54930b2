//! Tests that change their whole process, such as its reaction to a signal: each has a process of its own.

use std::env;
use std::process::Command;

/// The environment variable of such a process.
const IS_OWN: &str = "ADEMAN_TEST_HAS_OWN_PROCESS";

/// Returns `true` in a process of its own for the test with this name. Otherwise runs the test in one, and fails if it fails there.
pub fn has_own_process(test: &str) -> bool {
    if env::var_os(IS_OWN).is_some() {
        return true;
    }
    let program = env::current_exe().expect("its path");
    let mut process = Command::new(program);
    let ended = process.args(["--exact", test]).env(IS_OWN, "1").output();
    let ended = ended.expect("this program");
    let printed = String::from_utf8_lossy(&ended.stdout);
    assert!(ended.status.success(), "{}: {printed}", ended.status);
    assert!(printed.contains("1 passed"), "{printed}");
    false
}

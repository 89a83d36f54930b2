//! The watchdog process at faults of the program that starts it.

use std::io::Write;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;

use crate::support::binary::ademan;

#[test]
fn the_watchdog_of_a_program_that_ends_while_it_starts_ends_without_a_message() {
    let (mut program, watchdog) = UnixStream::pair().expect("sockets");
    // No devices of uinput, so it needs no display.
    program.write_all(b"u\0\0\0\0\0").expect("a message");
    drop(program);
    let mut command = ademan(["watchdog"]);
    let ended = command.stdin(OwnedFd::from(watchdog)).output();
    let ended = ended.expect("the program starts");
    assert_eq!(String::from_utf8_lossy(&ended.stderr), "");
    assert_eq!(ended.status.code(), Some(0));
}

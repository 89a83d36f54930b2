//! The watchdog process at faults of the program that starts it.

use std::io::Write;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;

use crate::run_to_end;
use crate::support::binary::ademan;

#[test]
fn the_watchdog_of_a_program_that_ends_while_it_starts_ends_without_a_message() {
    let (mut program, watchdog) = UnixStream::pair().expect("sockets");
    // No devices of uinput, so it needs no display.
    program.write_all(b"u\0\0\0\0\0").expect("a message");
    drop(program);
    let mut command = ademan(["watchdog"]);
    let ended = run_to_end(command.stdin(OwnedFd::from(watchdog))).done();
    assert_eq!(ended.err, "");
}

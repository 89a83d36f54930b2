//! Faults around a session: clients, disks, files, serial lines, the watchdog.

mod blocked_streams;
mod clients;
mod disks;
mod files;
mod forged_messages;
mod line;
mod lines;
mod message_floods;
mod names;
mod watchdog;

use rustix::process::{Pid, Resource, Rlimit, getrlimit, prlimit};

/// Sets the number below which the file descriptors that a process opens from now on must be. Those that it has stay open.
fn limit_descriptors(process: u32, number: u64) {
    let limit = Rlimit {
        current: Some(number),
        ..getrlimit(Resource::Nofile)
    };
    let process = Pid::from_raw(process.cast_signed());
    prlimit(process, Resource::Nofile, limit).expect("a process of this user");
}

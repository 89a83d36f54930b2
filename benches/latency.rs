//! Latency from the write of a packet to its event, compared with the minimum: a program that reads a packet and writes an
//! event.
//!
//! Each program has a pseudo terminal with the settings of a serial port. The programs receive the same packets in turn, in
//! an order that rotates, so that other load on the machine affects all of them, and one packet is in transit at a time.
//! Each packet causes one event.
//!
//! - `null` is one thread that blocks in a read of the packet and writes the event.
//! - `null with a hop` passes the packet from the reading thread to a writing thread. It shows the cost of the second thread.
//! - `ours` is the library: capture, pipeline and loop, as in `ademan run`.
//! - `ours with a hop` is the library with a source that has to block, and so has a thread of its own.
//!
//! The rows with load share the machine with a control socket that has 64 clients, which subscribe and never read, and one
//! that sends 100 Mbit/s of noise. The control socket shows the steps of `ours` to its clients.
//!
//! Events go to a pipe, in one system call with as many bytes as an event of uinput, and to an X server, where the time
//! ends when a client has received the key. The output has a watchdog, to which it reports each press before it, as in a run.
//!
//! The last table is of a real line, from the last byte of a packet to its event. The feeder notes the time when that byte is in
//! the kernel, and sends the header of the next packet, which confirms it, as late as a line of that bit rate does. The time
//! includes that wait of the protocol, which is stated beside it.
//!
//! `-- uinput` measures to readers of kernel devices in place of these, where `/dev/uinput` is available:
//! `tests/outputs/vm/run latency`. A number sets the number of packets.
//!
//! Prints tables. Without `--bench` (as in `cargo test --benches`) it measures a few packets.

#[cfg(target_os = "linux")]
#[path = "../tests/support/mod.rs"]
mod support;

#[cfg(target_os = "linux")]
#[path = "latency/desktop.rs"]
mod desktop;

#[cfg(target_os = "linux")]
#[path = "latency/feed.rs"]
mod feed;

#[cfg(target_os = "linux")]
#[path = "latency/load.rs"]
mod load;

#[cfg(target_os = "linux")]
#[path = "support/packets.rs"]
mod packets;

#[cfg(target_os = "linux")]
#[path = "latency/programs.rs"]
mod programs;

#[cfg(target_os = "linux")]
#[path = "latency/uinput.rs"]
mod uinput;

#[cfg(target_os = "linux")]
fn main() {
    feed::main();
}

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("latency: SKIPPED: it needs Linux");
}

//! From the last byte of a frame to its event, beside the least that any program could do: read a frame, write an event.
//!
//! Every program has a pseudo terminal of its own with the settings of a serial port, and gets the same frames in turn, so that whatever
//! else the machine does falls on all of them. One frame is under way at a time. Each frame gives one event.
//!
//! - `null` is one thread that waits in a plain read of the frame and writes the event.
//! - `null with a hop` hands the frame from the thread that reads to the one that writes, through the channel that ours
//!   has between capture and loop: what the second thread costs.
//! - `ours` is the library: capture, pipeline and the loop, as `ademan run` puts them together.
//!
//! Where the event goes is a pipe that takes as many bytes as the kernel's input devices do, in one system call; and
//! an X server, where the time ends when a client of it has heard the key. Prints a table; without `--bench` (as in
//! `cargo test --benches`) a few frames.

#[cfg(target_os = "linux")]
#[path = "../tests/support/mod.rs"]
mod support;

#[cfg(target_os = "linux")]
#[path = "latency/desktop.rs"]
mod desktop;

#[cfg(target_os = "linux")]
#[path = "latency/programs.rs"]
mod programs;

#[cfg(target_os = "linux")]
fn main() {
    programs::main();
}

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("latency: SKIPPED: it needs the pseudo terminals of Linux");
}

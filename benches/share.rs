//! Cost of sharing: 1000 readings per second to 100 clients of TCP and 20 of a WebSocket.
//!
//! One session runs with two servers. In every second part of the run the clients are connected, all in one other process,
//! and read every line. Prints the processor time of the thread that shares, as a share of one core, and the time from a
//! reading to the call of the output with and without the clients, and their ratio. Without `--bench` (as in
//! `cargo test --benches`) the parts are short.

#[cfg(target_os = "linux")]
#[path = "share/session.rs"]
mod session;

#[cfg(target_os = "linux")]
#[path = "share/clients.rs"]
mod clients;

#[cfg(target_os = "linux")]
#[path = "../tests/support/process.rs"]
#[allow(dead_code)]
mod process;

#[cfg(target_os = "linux")]
fn main() {
    match std::env::var("ADEMAN_SHARE_CLIENTS") {
        Ok(addresses) => clients::read_all(&addresses),
        Err(_) => session::main(),
    }
}

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("share: SKIPPED: it needs Linux");
}

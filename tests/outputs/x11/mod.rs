//! The whole way onto a real desktop: what is typed arrives in a program that knows nothing of this one, and nothing
//! stays down, however it ends.
//!
//! An X server keeps a key down when whoever pressed it is gone. Each test has a server of its own, with a watcher
//! connected all the time, and asks it what is down.
mod doctor;
mod ends;
#[cfg(target_os = "linux")]
mod watchdog;
mod held;
mod keymaps;
#[cfg(target_os = "linux")]
mod memory;
mod panics;
mod replug;
mod sink;
mod text;
mod xev;

use std::time::{Duration, Instant};

use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::x11::{XServer, wait_at_most, wait_for};

/// Lets the wearer of a glove press until just these keys are down.
///
/// A machine that is busy with other things for 200 ms on the way makes a stall of it; then it is tried again.
fn hold(server: &XServer, glove: &Glove, press: &Press, keys: &[u16]) {
    let is_held = || {
        glove.play(&press.approach);
        wait_at_most(Duration::from_secs(5), || server.pressed_keys() == keys)
    };
    assert!(wait_for(is_held), "{:?} are down", server.pressed_keys());
}

/// Waits until no key is down, and prints the time since `start`. `benches/release.rs` measures such times; here a busy
/// machine may take any.
fn wait_for_release(server: &XServer, start: Instant, what: &str) {
    assert!(
        server.wait_for_keys(&[]),
        "{what}: {:?} stay down",
        server.pressed_keys()
    );
    println!("{what}: no key is down after {:.1?}", start.elapsed());
}

//! X11: events arrive in other programs, and no key stays pressed, however the program ends.
//!
//! An X server keeps a key pressed after its client is gone. Each test has a server of its own and queries its state.

#[cfg(target_os = "linux")]
mod blocked_streams;
#[cfg(target_os = "linux")]
mod both_killed;
#[cfg(target_os = "linux")]
mod bursts;
#[cfg(target_os = "linux")]
mod characters;
mod doctor;
mod ends;
#[cfg(target_os = "linux")]
mod focus;
mod grabs;
#[cfg(target_os = "linux")]
mod idle;
#[cfg(target_os = "linux")]
mod lost_watchdog;
#[cfg(target_os = "linux")]
mod other_devices;
#[cfg(target_os = "linux")]
pub mod output_stalls;
#[cfg(target_os = "linux")]
mod watchdog;
mod gap;
mod held;
mod home_made_glove;
mod key_log;
mod keymaps;
#[cfg(target_os = "linux")]
mod memory;
mod panics;
#[cfg(target_os = "linux")]
mod priority;
mod replug;
#[cfg(target_os = "linux")]
mod service_manager;
mod sink;
#[cfg(target_os = "linux")]
mod slow_display;
mod system_chords;
mod text;
mod webcam;
mod xev;

use std::time::{Duration, Instant};

use ademan::device::OutputEvent;
use ademan::output::{Desktop, Sink};

use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_at_most, wait_for};

/// Repeats an attempt that a busy machine may spoil until it returns `true`, at most 5 times.
pub fn repeat(mut attempt: impl FnMut() -> bool) {
    assert!((0..5).any(|_| attempt()), "the machine is too busy");
}

/// Sends events and waits until they are there. Returns `false` if a part of them is missing: a busy machine has dropped it.
fn arrives(sink: &mut Desktop, events: &[OutputEvent], mut is_there: impl FnMut() -> bool) -> bool {
    let before = sink.dropped_presses();
    sink.send(events).expect("it is open");
    let (mut has_arrived, mut dropped) = (false, 0);
    wait_at_most(Duration::from_secs(10), || {
        has_arrived = is_there();
        dropped = sink.dropped_presses() - before;
        has_arrived || dropped > 0
    });
    println!("arrived: {has_arrived}, dropped: {dropped}");
    has_arrived && dropped == 0
}

/// Repeats a press until exactly these keys are pressed.
///
/// A busy machine may cause a stall; then the press is repeated.
fn hold(server: &XServer, program: &Program, glove: &Glove, press: &Press, keys: &[u16]) {
    let is_pressed = || {
        glove.play(&press.approach);
        wait_at_most(Duration::from_secs(5), || server.pressed_keys() == keys)
    };
    let pressed = wait_for(is_pressed);
    assert!(
        pressed,
        "{:?}: {:#?}",
        server.pressed_keys(),
        program.stderr_lines()
    );
}

/// Waits until no key is pressed, and prints the time since `start`. `benches/release.rs` measures such times; here a busy
/// machine may take any.
fn wait_for_release(server: &XServer, start: Instant, what: &str) {
    assert!(
        server.wait_for_keys(&[]),
        "{what}: {:?} stay pressed",
        server.pressed_keys()
    );
    println!("{what}: no key is pressed after {:.1?}", start.elapsed());
}

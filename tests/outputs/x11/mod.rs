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
mod desktop_part;
mod doctor;
pub mod ends;
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
use crate::support::program::{Program, WATCHDOG_LOST};
use crate::support::x11::{XServer, wait_at_most, wait_for};

/// Repeats an attempt that a busy machine may spoil until it returns `true`, at most 5 times.
pub fn repeat(mut attempt: impl FnMut() -> bool) {
    assert!((0..5).any(|_| attempt()), "the machine is too busy");
}

/// Starts what a test needs until it is ready, at most 5 times. Returns `None` if it cannot be had on this machine.
pub fn start_until<T>(
    mut start: impl FnMut() -> Option<T>,
    is_ready: impl Fn(&T) -> bool,
) -> Option<T> {
    let mut started = None;
    repeat(|| {
        started = None;
        started = start();
        started.as_ref().is_none_or(&is_ready)
    });
    started
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
    let is_held = is_held_at_last(server, program, glove, press, keys);
    assert!(is_held, "{:#?}", program.stderr_lines());
}

/// Repeats a press as [`hold`] does. Returns `false` if the run loses its watchdog, as on a busy machine: no press arrives until it is
/// resumed.
fn is_held_at_last(
    server: &XServer,
    program: &Program,
    glove: &Glove,
    press: &Press,
    keys: &[u16],
) -> bool {
    let lost = program.count_lines(WATCHDOG_LOST);
    let mut is_held = false;
    let is_over = wait_for(|| {
        glove.play(&press.approach);
        wait_at_most(Duration::from_secs(5), || {
            is_held = server.pressed_keys() == keys;
            is_held || program.count_lines(WATCHDOG_LOST) > lost
        })
    });
    assert!(
        is_over,
        "{:?}: {:#?}",
        server.pressed_keys(),
        program.stderr_lines()
    );
    is_held
}

/// Waits until exactly these keys are pressed. Returns `false` if a busy machine has delayed the run before.
fn is_pressing(server: &XServer, program: &Program, keys: &[u16]) -> bool {
    let mut has_pressed = false;
    let is_over = wait_for(|| {
        has_pressed = server.pressed_keys() == keys;
        has_pressed || is_late(program)
    });
    assert!(
        is_over,
        "{:?}: {:#?}",
        server.pressed_keys(),
        program.stderr_lines()
    );
    has_pressed
}

/// Returns `true` if a run says that a busy machine has delayed it: a press may be missing.
pub fn is_late(program: &Program) -> bool {
    let has_said = |part: &str| program.count_lines(part) > 0;
    has_said(WATCHDOG_LOST) || keymaps::STALLED.into_iter().any(has_said)
}

/// Messages of a run that was armed at its start, of its watchdog and of a demo, after which keys may be missing.
const MAY_MISS_KEYS: [&str; 4] = [
    "dropped: this machine is too busy",
    "paused: hold the hand clear",
    "released its keys",
    "keys may be missing",
];

/// Returns `true` if a run or a demo says that a busy machine may have cost keys. Most such messages are of readings that no key
/// depends on.
pub fn may_miss_keys(program: &Program) -> bool {
    let has_said = |part| program.count_lines(part) > 0;
    MAY_MISS_KEYS.into_iter().any(has_said)
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

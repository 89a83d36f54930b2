//! Texts and corrections that a display cannot type, or executes slowly: they arrive entirely or not at all, and so does what belongs
//! to them.

use std::time::Duration;
use std::{fs, thread};

use ademan::device::{Capabilities, EventKind, KeyCode, OutputEvent};
use ademan::output::{Desktop, Sink};
use ademan::time::Timestamp;

use super::both_killed::in_session;
use super::characters::{KeymapClient, LAYOUT};
use super::slow_display::SlowDisplay;
use super::{arrives, repeat};
use crate::support::binary::ademan;
use crate::support::key_log::{Action, Input, KeyLog};
use crate::support::program::Program;
use crate::support::x11::{InputWindow, XServer, wait_for};

/// Codes of keys of a PC keyboard.
pub const CONTROL: Input = Input::Key(37);
pub const A: Input = Input::Key(38);

/// Number of attempts on a busy machine.
const ATTEMPTS: usize = 20;

pub fn open(display: &str) -> Desktop {
    Desktop::open(Some(display), &Capabilities::default()).expect("the server runs")
}

pub fn events(kinds: &[EventKind]) -> Vec<OutputEvent> {
    let event = |&kind| OutputEvent {
        time: Timestamp(0),
        kind,
    };
    kinds.iter().map(event).collect()
}

pub fn tap(name: &str) -> Vec<OutputEvent> {
    let key: KeyCode = name.parse().expect("the name of a key");
    events(&[EventKind::KeyDown(key), EventKind::KeyUp(key)])
}

fn text(text: &str) -> Vec<OutputEvent> {
    let characters: Vec<_> = text.chars().map(EventKind::Character).collect();
    events(&characters)
}

/// Returns what was pressed, in order.
pub fn pressed(log: &KeyLog) -> Vec<Input> {
    let events = log.events().into_iter();
    let presses = events.filter(|event| event.action == Action::Press);
    presses.map(|event| event.input).collect()
}

#[test]
fn no_enter_follows_a_text_that_a_held_control_would_make_a_shortcut() {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let (mut sink, log) = (open(server.display()), KeyLog::start(&server));
        let tapping = tap("ControlLeft");
        if !arrives(&mut sink, &tapping[..1], || server.pressed_keys() == [37]) {
            return false;
        }
        sink.send(&text("ok")).expect("it is open");
        assert!(wait_for(|| sink.dropped_presses() == 2));
        sink.send(&tap("Enter")).expect("it is open");
        sink.close().expect("the server runs");
        assert_eq!(pressed(&log), [CONTROL]);
        assert_eq!(server.pressed_keys(), [0; 0]);
        true
    });
}

#[test]
fn a_correction_that_the_keymap_cannot_type_deletes_nothing() {
    let Some(server) = XServer::start() else {
        return;
    };
    KeymapClient::connect(&server).use_all_but(0);
    let (mut sink, log) = (open(server.display()), KeyLog::start(&server));
    let backspace = tap("Backspace");
    let correction = [&backspace[..], &backspace, &tap("A"), &text("ñ")].concat();
    sink.send(&correction).expect("it is open");
    sink.close().expect("the server runs");
    assert_eq!(sink.dropped_presses(), 4);
    assert_eq!(pressed(&log), []);
}

#[test]
fn a_correction_on_a_slow_display_arrives_entirely_or_not_at_all() {
    let Some(server) = XServer::start() else {
        return;
    };
    let log = KeyLog::start(&server);
    // A key at a time, it would take longer than a press may wait.
    let slow = SlowDisplay::start(&server, Duration::from_millis(10));
    let mut sink = open(slow.display());
    let correction = [tap("Backspace").repeat(12), tap("A").repeat(12)].concat();
    let mut attempts = 0..ATTEMPTS;
    let is_executed = attempts.any(|attempt| {
        let (before, dropped) = (log.len(), sink.dropped_presses());
        sink.send(&correction).expect("it is open");
        let executed = || log.presses_after(before);
        let dropped = || (sink.dropped_presses() - dropped) as usize;
        assert!(
            wait_for(|| executed() + dropped() >= 24),
            "{} executed, {} dropped",
            executed(),
            dropped()
        );
        let counts = (executed(), dropped());
        assert!(
            [(24, 0), (0, 24)].contains(&counts),
            "{attempt}: {counts:?}"
        );
        let is_executed = dropped() == 0;
        sink.void_presses();
        is_executed
    });
    assert!(is_executed, "on a machine that is not too busy");
    sink.close().expect("the server runs");
    assert_eq!(server.pressed_keys(), [0; 0]);
}

#[test]
fn the_wheel_does_not_turn_after_a_pause_while_a_server_hangs() {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let (mut sink, log) = (open(server.display()), KeyLog::start(&server));
        server.freeze();
        for _ in 0..100 {
            sink.send(&events(&[EventKind::Scroll(0, 1200)]))
                .expect("it is open");
        }
        sink.void_presses();
        server.thaw();
        let is_typed = arrives(&mut sink, &tap("A"), || log.presses_after(0) > 0);
        sink.close().expect("the server runs");
        let arrived = pressed(&log);
        assert!([A].starts_with(&arrived), "{arrived:?}");
        is_typed
    });
}

#[test]
fn a_correction_does_not_reach_the_window_that_got_the_focus() {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let _first = InputWindow::open(&server);
        let (mut sink, log) = (open(server.display()), KeyLog::start(&server));
        if !arrives(&mut sink, &tap("A"), || log.len() == 2) {
            return false;
        }
        let generation = sink.text_field().generation;
        // The thread reads the answer to the last key.
        thread::sleep(Duration::from_millis(500));
        let _second = InputWindow::open(&server);
        let correction = [tap("Backspace"), tap("A")].concat();
        sink.send(&correction).expect("it is open");
        assert!(wait_for(|| sink.dropped_presses() == 2));
        assert_eq!(pressed(&log), [A]);
        assert_ne!(sink.text_field().generation, generation);
        sink.close().expect("the server runs");
        true
    });
}

#[test]
fn the_text_field_is_another_one_when_another_window_has_the_focus() {
    let Some(server) = XServer::start() else {
        return;
    };
    let sink = open(server.display());
    let generation = sink.text_field().generation;
    let mut windows = Vec::new();
    let is_noticed = || {
        windows.push(InputWindow::open(&server));
        thread::sleep(Duration::from_millis(500));
        sink.text_field().generation != generation
    };
    assert!(wait_for(is_noticed));
}

/// A server reads the requests of a client in parts, and drops what it has not read of a client that is gone.
#[test]
fn a_character_that_a_killed_run_has_typed_half_is_released() {
    // A key of the keymap, and one that is added to it.
    for text in ["n", "λ"] {
        let Some(server) = XServer::start() else {
            return;
        };
        let display = SlowDisplay::that_reads_half(&server);
        let folder = tempfile::tempdir_in("/dev/shm").expect("a folder in memory");
        let layout = folder.path().join("text.ron");
        fs::write(&layout, LAYOUT.replace("niño λ", text)).expect("the folder is writable");
        let source = "script:wait 800; tap text; wait 600000";
        let mut run = ademan(["run", "--output", "desktop", "--source", source]);
        run.arg("--layout").arg(layout);
        let mut run = in_session(run, &server, folder.path());
        run.env("DISPLAY", display.display());
        let mut program = Program::from_command(run);
        let is_down = || !server.pressed_keys().is_empty();
        assert!(wait_for(is_down), "{text}: {:#?}", program.stderr_lines());
        program.signal(&["KILL"]);
        assert_eq!(program.wait_for_exit().code(), None);
        let is_up = || server.pressed_keys().is_empty();
        assert!(wait_for(is_up), "{text}: {:?}", server.pressed_keys());
    }
}

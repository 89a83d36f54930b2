//! The output `desktop` on an X server: keys, characters and a pointer, as other programs receive them.

use std::thread;
use std::time::Duration;

use super::{arrives, repeat};
use crate::support::key_log::{Action, Input, KeyLog};
use crate::support::x11::{InputWindow, TerminalWindow, XServer, wait_for};
use ademan::device::{Capabilities, EventKind, KeyCode, OutputEvent};
use ademan::output::{Desktop, OutputError, Sink};
use ademan::time::Timestamp;

const NO_KEYS: [u16; 0] = [];

const NO_BUTTONS: [u8; 0] = [];

fn key(name: &str) -> KeyCode {
    name.parse().unwrap()
}

fn event(action: EventKind) -> OutputEvent {
    OutputEvent {
        time: Timestamp(0),
        kind: action,
    }
}

fn down(name: &str) -> OutputEvent {
    event(EventKind::KeyDown(key(name)))
}

fn up(name: &str) -> OutputEvent {
    event(EventKind::KeyUp(key(name)))
}

/// Returns the key events that type `text` with a US keymap, one list per character.
fn strokes(text: &str) -> Vec<Vec<OutputEvent>> {
    let stroke = |character| {
        let (key, shifted) = KeyCode::for_us_character(character).next().unwrap();
        let shift =
            |action: fn(KeyCode) -> EventKind| shifted.then(|| event(action(KeyCode::SHIFT_LEFT)));
        let mut events = Vec::from_iter(shift(EventKind::KeyDown));
        events.extend([EventKind::KeyDown(key), EventKind::KeyUp(key)].map(event));
        events.extend(shift(EventKind::KeyUp));
        events
    };
    text.chars().map(stroke).collect()
}

fn open(server: &XServer) -> Desktop {
    Desktop::open(Some(server.display()), &Capabilities::default()).unwrap()
}

/// Opens a sink that holds Shift and A.
fn holding_two_keys(server: &XServer) -> Desktop {
    let mut holding = None;
    repeat(|| {
        let mut sink = open(server);
        let keys = [down("ShiftLeft"), down("A")];
        let is_pressed = arrives(&mut sink, &keys, || server.pressed_keys() == [38, 50]);
        holding = is_pressed.then_some(sink);
        is_pressed
    });
    holding.expect("the keys are pressed")
}

/// Returns what was pressed, in order.
fn pressed(log: &KeyLog) -> Vec<Input> {
    let events = log.events().into_iter();
    let presses = events.filter(|event| event.action == Action::Press);
    presses.map(|event| event.input).collect()
}

/// Sends parts one after another to a terminal, each with the length of what is typed then, until the terminal has the whole text.
fn check_typing(text: &str, parts: &[(Vec<OutputEvent>, usize)]) {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let Some(terminal) = TerminalWindow::start(&server) else {
            return true;
        };
        let mut sink = open(&server);
        let is_typed = parts
            .iter()
            .all(|(events, end)| arrives(&mut sink, events, || terminal.typed("") == text[..*end]));
        sink.close().unwrap();
        assert_eq!(server.pressed_keys(), NO_KEYS);
        let typed = terminal.typed("");
        assert!(text.starts_with(&typed), "{typed:?}");
        assert!(!is_typed || (typed == text && sink.dropped_presses() == 0));
        is_typed
    });
}

#[test]
fn a_text_arrives_byte_for_byte_in_a_terminal() {
    let text = "Hello, World! 1+1=2 (a;b) {x} ~";
    let parts: Vec<_> = strokes(text).into_iter().zip(1..).collect();
    check_typing(text, &parts);
}

#[test]
fn all_keys_are_released_after_closing() {
    let Some(server) = XServer::start() else {
        return;
    };
    let mut sink = holding_two_keys(&server);
    sink.close().unwrap();
    assert_eq!(server.pressed_keys(), NO_KEYS);
}

#[test]
fn all_keys_are_released_after_a_drop() {
    let Some(server) = XServer::start() else {
        return;
    };
    drop(holding_two_keys(&server));
    assert_eq!(server.pressed_keys(), NO_KEYS);
}

#[test]
fn all_keys_are_released_after_a_panic_of_the_owning_thread() {
    let Some(server) = XServer::start() else {
        return;
    };
    let sink = holding_two_keys(&server);
    let holder = thread::spawn(move || {
        let _sink = sink;
        panic!("meant to happen");
    });
    assert!(holder.join().is_err());
    assert_eq!(server.pressed_keys(), NO_KEYS);
}

#[test]
fn a_release_affects_its_key_only() {
    let Some(server) = XServer::start() else {
        return;
    };
    let mut sink = holding_two_keys(&server);
    sink.send(&[up("A"), down("A"), down("A"), up("B")])
        .unwrap();
    sink.send(&[up("A")]).unwrap();
    assert!(server.wait_for_keys(&[50]));
}

#[test]
fn a_dead_server_is_an_error() {
    let Some(mut server) = XServer::start() else {
        return;
    };
    let mut sink = holding_two_keys(&server);
    server.kill();
    let mut outcome = Ok(());
    assert!(wait_for(|| {
        outcome = sink.send(&[down("B"), up("B")]);
        outcome.is_err()
    }));
    let error = outcome.unwrap_err();
    assert!(matches!(error, OutputError::Send { .. }), "{error}");
    sink.close().unwrap_err();
}

#[test]
fn characters_that_are_not_in_the_keymap_arrive_in_a_terminal() {
    let text = "é ñß Łж€ aé!";
    let part = |(start, character): (usize, char)| {
        let events = vec![event(EventKind::Character(character))];
        (events, start + character.len_utf8())
    };
    let mut parts: Vec<_> = text.char_indices().map(part).collect();
    let typed = format!("{text}a");
    parts.push((vec![down("A"), up("A")], typed.len()));
    check_typing(&typed, &parts);
}

#[test]
fn relative_and_absolute_pointer_motion_arrive() {
    let Some(server) = XServer::start() else {
        return;
    };
    let mut sink = open(&server);
    let positions = [
        (EventKind::MoveTo(0.0, 0.0), (0, 0)),
        (EventKind::MoveTo(1.0, 1.0), (799, 599)),
        (EventKind::MoveTo(0.5, 0.25), (400, 150)),
        (EventKind::MoveBy(-30, 7), (370, 157)),
        (EventKind::MoveBy(i32::MAX, i32::MIN), (799, 0)),
    ];
    for (action, position) in positions {
        sink.send(&[event(action)]).unwrap();
        assert!(
            server.wait_for_pointer(position),
            "{action:?}: {:?}",
            server.pointer()
        );
    }
}

#[test]
fn buttons_a_drag_and_the_wheel_arrive_in_order() {
    repeat(has_buttons_a_drag_and_the_wheel);
}

/// Checks what a window receives. Returns `false` if a busy machine has dropped a press.
fn has_buttons_a_drag_and_the_wheel() -> bool {
    let Some(server) = XServer::start() else {
        return true;
    };
    let field = InputWindow::open(&server);
    let mut sink = open(&server);
    sink.send(&[
        event(EventKind::MoveTo(0.0, 0.0)),
        event(EventKind::MoveBy(20, 10)),
    ])
    .unwrap();
    sink.send(&[
        down("MouseLeft"),
        event(EventKind::MoveBy(5, 5)),
        up("MouseLeft"),
    ])
    .unwrap();
    for button in ["MouseMiddle", "MouseRight", "MouseBack", "MouseForward"] {
        sink.send(&[down(button), up(button)]).unwrap();
    }
    let turns = [(0, 120), (0, -60), (0, -60), (240, 0), (-120, 0)];
    sink.send(&turns.map(|(x, y)| event(EventKind::Scroll(x, y))))
        .unwrap();
    sink.close().unwrap();
    if sink.dropped_presses() > 0 {
        return false;
    }
    let events: Vec<_> = field.events_until("up 6 at 25,15");
    let start = events.iter().position(|line| line == "move to 20,10");
    let clicks = [2, 3, 8, 9, 4, 5, 7, 7, 6];
    let clicked =
        clicks.map(|button| ["down", "up"].map(|what| format!("{what} {button} at 25,15")));
    let dragged = ["down 1 at 20,10", "drag to 25,15", "up 1 at 25,15"].map(str::to_owned);
    let expected: Vec<_> = dragged
        .into_iter()
        .chain(clicked.into_iter().flatten())
        .collect();
    assert_eq!(events[start.expect("the pointer moved") + 1..], expected);
    true
}

#[test]
fn all_buttons_are_released_after_closing_and_after_a_drop() {
    let Some(server) = XServer::start() else {
        return;
    };
    for closes in [true, false] {
        repeat(|| {
            let mut sink = open(&server);
            let presses = [down("MouseLeft"), down("MouseRight"), down("A")];
            let is_pressed = arrives(&mut sink, &presses, || server.pressed_buttons() == [1, 3]);
            if closes {
                sink.close().unwrap();
            }
            drop(sink);
            assert_eq!(server.pressed_buttons(), NO_BUTTONS);
            assert_eq!(server.pressed_keys(), NO_KEYS);
            is_pressed
        });
    }
}

#[test]
fn what_was_sent_before_closing_arrives() {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let log = KeyLog::start(&server);
        let is_sent = (0..20).all(|round| {
            let mut sink = open(&server);
            sink.send(&[down("A"), up("A"), down("B")]).unwrap();
            sink.close().unwrap();
            println!("{round}: {} dropped", sink.dropped_presses());
            sink.dropped_presses() == 0
        });
        assert!(log.len() <= 80, "{:?}", log.events());
        assert!(
            !is_sent || wait_for(|| log.len() == 80),
            "{:?}",
            log.events()
        );
        assert_eq!(server.pressed_keys(), NO_KEYS);
        is_sent
    });
}

#[test]
fn a_press_that_a_server_has_not_read_in_time_is_revoked_while_it_hangs() {
    let Some(server) = XServer::start() else {
        return;
    };
    let mut sink = open(&server);
    let log = KeyLog::start(&server);
    server.freeze();
    sink.send(&[down("A")]).unwrap();
    let is_revoked = wait_for(|| sink.dropped_presses() == 1);
    server.thaw();
    // Through the queue it would have waited for an answer of the server.
    assert!(is_revoked, "the loop has not written the press");
    assert!(sink.has_stalled());
    sink.void_presses();
    sink.send(&[up("A"), down("B")]).unwrap();
    assert!(server.wait_for_keys(&[56]), "B is pressed");
    sink.close().unwrap();
    assert!(server.wait_for_keys(&NO_KEYS), "B is released");
    assert!(log.wait_for_press(0), "the log has B");
    assert_eq!(pressed(&log), [Input::Key(56)]);
}

#[test]
fn a_press_that_becomes_void_while_a_server_hangs_is_revoked_at_once() {
    let Some(server) = XServer::start() else {
        return;
    };
    let mut sink = open(&server);
    let log = KeyLog::start(&server);
    server.freeze();
    sink.send(&[down("A")]).unwrap();
    sink.void_presses();
    // The press is not too old yet.
    server.thaw();
    sink.send(&[up("A")]).unwrap();
    assert!(wait_for(|| sink.dropped_presses() == 1));
    sink.send(&[down("B"), up("B")]).unwrap();
    sink.close().unwrap();
    assert!(log.wait_for_press(0), "the log has B");
    assert_eq!(pressed(&log), [Input::Key(56)]);
}

#[test]
fn a_key_whose_release_waits_for_a_server_that_hangs_is_released() {
    let Some(server) = XServer::start() else {
        return;
    };
    let mut sink = holding_two_keys(&server);
    server.freeze();
    sink.send(&[up("A")]).unwrap();
    // Longer than a server may take to execute what the loop has written.
    thread::sleep(Duration::from_millis(600));
    server.thaw();
    assert!(server.wait_for_keys(&[50]), "A is released");
    sink.send(&[up("ShiftLeft")]).unwrap();
    assert!(server.wait_for_keys(&NO_KEYS), "Shift is released");
    sink.close().unwrap();
    assert_eq!(sink.dropped_presses(), 0);
}

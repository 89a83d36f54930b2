//! Keys are places: what they write is up to the keymap of the desktop. Characters are not.

use std::io::ErrorKind;
use std::process::Command;

use ademan::device::{Capabilities, EventKind, OutputEvent};
use ademan::output::{Desktop, Sink};
use ademan::time::Timestamp;

use crate::support::program::Program;
use crate::support::x11::{TerminalWindow, XServer};

/// A server with this keymap, or `None` where it cannot be set.
fn server_with(keymap: &str) -> Option<XServer> {
    let server = XServer::start()?;
    let mut command = Command::new("setxkbmap");
    command.arg("-display").arg(server.display()).arg(keymap);
    match command.status() {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("SKIPPED: setxkbmap is not installed");
            None
        }
        status => {
            assert!(status.expect("it starts").success());
            Some(server)
        }
    }
}

/// What the demo says when the hand was not let play as it meant to.
const HELD_UP: &str = "did not come out right";

/// Lets the demo play on a board in front of a terminal under a keymap; what the terminal takes in.
///
/// A machine that is busy with other things for 200 ms on the way makes a stall of it; then it is tried again.
fn the_demo_types(keymap: &str, arguments: &[&str], expected: &str) {
    for _ in 0..3 {
        let Some(server) = server_with(keymap) else {
            return;
        };
        let Some(terminal) = TerminalWindow::start(&server) else {
            return;
        };
        let demo = ["demo", "--output", "desktop"];
        let mut program = Program::start(&server, [&demo, arguments].concat());
        let status = program.wait_for_exit();
        assert_eq!(server.pressed_keys(), [0; 0]);
        if program.count_lines(HELD_UP) > 0 {
            println!("held up: {:?}", program.stderr_lines());
            continue;
        }
        assert_eq!(status.code(), Some(0), "{:#?}", program.stderr_lines());
        assert_eq!(terminal.typed(expected), expected);
        return;
    }
    panic!("the machine has no time for a hand that types");
}

/// A script that taps these keys.
fn taps(keys: &str) -> String {
    let taps: Vec<_> = keys.split(' ').map(|key| format!("tap {key}")).collect();
    taps.join("; ")
}

#[test]
fn the_american_board_writes_what_is_drawn_on_it_under_an_american_keymap() {
    let text = "Yes: z {1} @ [2]; a-b 'c' / ~d";
    the_demo_types("us", &["--text", text], text);
}

#[test]
fn the_german_board_writes_what_is_drawn_on_it_under_a_german_keymap() {
    let keys = "Y Z Minus BracketLeft Semicolon Quote Backslash Slash IntlBackslash";
    let script = taps(keys);
    let arguments = ["--layout", "qwertz-flat", "--script", &script];
    the_demo_types("de", &arguments, "zyßüöä#-<");
}

#[test]
fn the_german_board_reaches_the_second_and_the_third_level_of_a_german_keymap() {
    let keys = "ShiftLeft Semicolon ShiftLeft 7 AltRight Q AltRight E AltRight 7 AltRight BracketRight \
                AltRight IntlBackslash";
    let script = taps(keys);
    let arguments = ["--layout", "qwertz-flat", "--script", &script];
    the_demo_types("de", &arguments, "Ö/@€{~|");
}

#[test]
fn characters_arrive_under_every_keymap() {
    for keymap in ["us", "de"] {
        let Some(server) = server_with(keymap) else {
            return;
        };
        let Some(terminal) = TerminalWindow::start(&server) else {
            return;
        };
        let text = "zy[ß] @€ é ñ λ";
        let mut sink = Desktop::open(Some(server.display()), &Capabilities::default());
        let sink = sink.as_mut().expect("the server is there");
        for character in text.chars() {
            let event = OutputEvent {
                time: Timestamp(0),
                kind: EventKind::Character(character),
            };
            sink.send(&[event]).expect("there is room");
        }
        sink.close().expect("it takes everything");
        assert_eq!(terminal.typed(text), text, "under {keymap}");
    }
}

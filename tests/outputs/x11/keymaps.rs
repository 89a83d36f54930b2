//! Keymaps: a key is a position, to which the keymap of the desktop assigns a character. Characters are independent of it.

use std::io::ErrorKind;
use std::process::Command;

use ademan::device::{Capabilities, EventKind, OutputEvent};
use ademan::output::{Desktop, Sink};
use ademan::time::Timestamp;

use super::{is_late, may_miss_keys};
use crate::support::program::Program;
use crate::support::x11::{TerminalWindow, XServer};

/// Starts a server with this keymap. Returns `None` with a message if setxkbmap is not installed.
pub fn server_with(keymap: &[&str]) -> Option<XServer> {
    let server = XServer::start()?;
    set_keymap(&server, keymap).then_some(server)
}

/// Sets the keymap of the server by these arguments of setxkbmap. Returns `false` with a message if it is not
/// installed.
pub fn set_keymap(server: &XServer, keymap: &[&str]) -> bool {
    let mut command = Command::new("setxkbmap");
    command.arg("-display").arg(server.display()).args(keymap);
    match command.status() {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("SKIPPED: setxkbmap is not installed");
            false
        }
        status => {
            assert!(status.expect("setxkbmap starts").success());
            true
        }
    }
}

/// Messages after a stall or a display that was late: of the session, and of a demo whose text differs.
pub const STALLED: [&str; 3] = [
    "stalled:",
    "did not accept them within",
    "the typed text differs from the given one",
];

/// Runs the demo in front of a terminal with a keymap and checks what is typed.
fn assert_demo_types(keymap: &str, arguments: &[&str], expected: &str) {
    check_demo(|| server_with(&[keymap]), arguments, expected);
}

/// Runs the demo in front of a terminal on a server of its own and checks what is typed. A busy machine may cause a stall; then
/// the demo is repeated.
pub fn check_demo(start: impl Fn() -> Option<XServer>, arguments: &[&str], expected: &str) {
    for _ in 0..5 {
        let Some(server) = start() else {
            return;
        };
        let Some(terminal) = TerminalWindow::start(&server) else {
            return;
        };
        let demo = ["demo", "--output", "desktop"];
        let mut program = Program::start(&server, [&demo, arguments].concat());
        let status = program.wait_for_exit();
        assert_eq!(server.pressed_keys(), [0; 0]);
        if is_late(&program) {
            println!("stalled: {:?}", program.stderr_lines());
            continue;
        }
        assert_eq!(status.code(), Some(0), "{:#?}", program.stderr_lines());
        let typed = terminal.typed(expected);
        if typed != expected && may_miss_keys(&program) {
            println!("{typed:?}: {:?}", program.stderr_lines());
            continue;
        }
        assert_eq!(typed, expected);
        return;
    }
    panic!("the machine is too busy");
}

/// Returns a script that taps these keys.
fn taps(keys: &str) -> String {
    let taps: Vec<_> = keys.split(' ').map(|key| format!("tap {key}")).collect();
    taps.join("; ")
}

#[test]
fn the_us_layout_types_its_labels_with_a_us_keymap() {
    let text = "Yes: z {1} @ [2]; a-b 'c' / ~d";
    assert_demo_types("us", &["--text", text], text);
}

#[test]
fn the_german_layout_types_its_labels_with_a_german_keymap() {
    let keys = "Y Z Minus BracketLeft Semicolon Quote Backslash Slash IntlBackslash";
    let script = taps(keys);
    let arguments = ["--layout", "qwertz-flat", "--script", &script];
    assert_demo_types("de", &arguments, "zyßüöä#-<");
}

#[test]
fn the_german_layout_reaches_levels_two_and_three_of_a_german_keymap() {
    let keys = "ShiftLeft Semicolon ShiftLeft 7 AltRight Q AltRight E AltRight 7 AltRight BracketRight \
                AltRight IntlBackslash";
    let script = taps(keys);
    let arguments = ["--layout", "qwertz-flat", "--script", &script];
    assert_demo_types("de", &arguments, "Ö/@€{~|");
}

#[test]
fn characters_arrive_with_every_keymap() {
    for keymap in ["us", "de"] {
        let Some(server) = server_with(&[keymap]) else {
            return;
        };
        let Some(terminal) = TerminalWindow::start(&server) else {
            return;
        };
        let text = "zy[ß] @€ é ñ λ";
        let mut sink = Desktop::open(Some(server.display()), &Capabilities::default());
        let sink = sink.as_mut().expect("the server runs");
        for (start, character) in text.char_indices() {
            let event = OutputEvent {
                time: Timestamp(0),
                kind: EventKind::Character(character),
            };
            sink.send(&[event]).expect("the queue has room");
            // A character that waits while a busy machine starves the sink would be dropped.
            terminal.typed(&text[..start + character.len_utf8()]);
        }
        sink.close().expect("everything is sent");
        assert_eq!(terminal.typed(text), text, "keymap {keymap}");
    }
}

//! The demo types into a terminal.

use crate::support::program::Program;
use crate::support::x11::{TerminalWindow, XServer};

/// Runs the demo with these arguments in front of a terminal and checks what is typed.
fn assert_demo_types(text: &str, arguments: &[&str]) {
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(terminal) = TerminalWindow::start(&server) else {
        return;
    };
    let mut program = Program::start(
        &server,
        [&["demo", "--output", "desktop"], arguments].concat(),
    );
    let status = program.wait_for_exit();
    assert_eq!(status.code(), Some(0), "{:#?}", program.stderr_lines());
    assert_eq!(server.pressed_keys(), [0; 0]);
    assert_eq!(terminal.typed(text), text);
}

#[test]
fn the_demo_text_arrives_byte_for_byte() {
    assert_demo_types("Hola! Typed by a hand, 1 tap each.", &[]);
}

#[test]
fn ascii_punctuation_before_the_letters_arrives_byte_for_byte() {
    let text = "!\"#$%&'()*+,-./:;<=>?@";
    assert_demo_types(text, &["--text", text]);
}

#[test]
fn ascii_punctuation_after_the_letters_arrives_byte_for_byte() {
    let text = "[\\]^_`{|}~";
    assert_demo_types(text, &["--text", text]);
}

#[test]
fn a_text_on_two_layers_arrives_byte_for_byte() {
    let text = "Hi 5! (ok)";
    assert_demo_types(text, &["--layout", "qwerty-arc", "--text", text]);
}

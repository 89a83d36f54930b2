//! The text of the demo in a terminal of the desktop.

use crate::support::program::Program;
use crate::support::x11::{TerminalWindow, XServer};

/// Lets the demo type into a terminal, with these arguments.
fn the_demo_types(text: &str, arguments: &[&str]) {
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
fn the_text_of_the_demo_arrives_byte_for_byte() {
    the_demo_types("Hola! Typed by a hand, 1 tap each.", &[]);
}

#[test]
fn the_punctuation_of_ascii_before_the_letters_arrives_byte_for_byte() {
    let text = "!\"#$%&'()*+,-./:;<=>?@";
    the_demo_types(text, &["--text", text]);
}

#[test]
fn the_punctuation_of_ascii_after_the_letters_arrives_byte_for_byte() {
    let text = "[\\]^_`{|}~";
    the_demo_types(text, &["--text", text]);
}

#[test]
fn a_text_in_two_layers_arrives_byte_for_byte() {
    let text = "Hi 5! (ok)";
    the_demo_types(text, &["--layout", "qwerty-arc", "--text", text]);
}

//! The demo types into a terminal.

use super::keymaps::check_demo;
use super::{is_late, may_miss_keys, repeat};
use crate::support::program::Program;
use crate::support::x11::{TerminalWindow, XServer};

/// Runs the demo with these arguments in front of a terminal and checks what is typed.
fn assert_demo_types(text: &str, arguments: &[&str]) {
    check_demo(XServer::start, arguments, text);
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

#[test]
fn a_sequence_arrives_in_order_and_leaves_no_key_pressed() {
    let layout = tempfile::NamedTempFile::with_suffix(".ron").expect("a file");
    let text = "Layout(name: \"t\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45), \
                keys: [(action: Sequence(\"sign\"), at_mm: (0, 0))])], \
                sequences: {\"sign\": [Text(\"Ana: \"), Tap(\"Shift A\"), Wait(100), Text(\"na@example.org\")]})";
    std::fs::write(layout.path(), text).expect("the file can be written");
    let path = layout.path().to_str().expect("a plain path");
    let script = "tap sign; wait 1500";
    assert_demo_types(
        "Ana: Ana@example.org",
        &["--layout", path, "--script", script],
    );
}

/// Returns the text that a text field shows after these bytes of a terminal.
fn shown(bytes: &str) -> String {
    let mut text = String::new();
    for character in bytes.chars() {
        match character {
            '\u{8}' | '\u{7f}' => _ = text.pop(),
            other => text.push(other),
        }
    }
    text
}

/// A line with two slips.
const LINE: &str = "teh quikc brown fox ";

/// Runs a hand that types the line with a mode of the decoder, and checks what a terminal shows. A busy machine may cause a stall or
/// drop a key; then the line is typed again.
fn assert_line_arrives(mode: &str, expected: &str) {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let Some(terminal) = TerminalWindow::start(&server) else {
            return true;
        };
        let source = format!("typist:{LINE}");
        let mut program = Program::start(
            &server,
            [
                "run",
                "--armed",
                "--control",
                "off",
                "--view",
                "log",
                "--output",
                "desktop",
                "--decoder",
                mode,
                "--source",
                &source,
            ],
        );
        let status = program.wait_for_exit();
        assert_eq!(server.pressed_keys(), [0; 0]);
        if is_late(&program) {
            println!("stalled: {:?}", program.stderr_lines());
            return false;
        }
        assert_eq!(status.code(), Some(0), "{:#?}", program.stderr_lines());
        // Each of two corrections deletes and types three characters at least.
        let least = "x".repeat(LINE.len() + if mode == "auto" { 8 } else { 0 });
        let bytes = terminal.typed(&least);
        if shown(&bytes) != expected && may_miss_keys(&program) {
            println!("{bytes:?}: {:?}", program.stderr_lines());
            return false;
        }
        assert_eq!(shown(&bytes), expected, "{bytes:?}");
        assert_eq!(bytes == LINE, mode == "literal");
        true
    });
}

#[test]
fn words_that_a_run_corrects_arrive_corrected_and_those_of_a_literal_run_as_typed() {
    assert_line_arrives("auto", "the quick brown fox ");
    assert_line_arrives("literal", LINE);
}

//! The text of the demo in a terminal, and characters that no key writes.

use ademan::device::EventKind;
use ademan::output::Sink;

use super::compositor::{Compositor, event};
use super::window::{Terminal, Window};

/// What the demo says when the hand was not let type as it meant to.
const HELD_UP: &str = "the text did not come out right";

/// Lets the demo type into a terminal of a desktop.
///
/// A machine that is busy with other things for 200 ms on the way makes a stall of it; then it is tried again.
fn the_demo_types(text: &str) {
    for _ in 0..3 {
        let Some(compositor) = Compositor::sway() else {
            return;
        };
        let Some(terminal) = Terminal::start(&compositor) else {
            return;
        };
        let mut program = compositor.run(["demo", "--output", "desktop", "--text", text]);
        let status = program.wait_for_exit();
        if program.count_lines(HELD_UP) > 0 {
            println!("held up: {:?}", program.stderr_lines());
            continue;
        }
        assert_eq!(status.code(), Some(0), "{:#?}", program.stderr_lines());
        assert_eq!(terminal.typed(text), text);
        return;
    }
    panic!("the machine has no time for a hand that types");
}

#[test]
fn a_text_arrives_byte_for_byte() {
    the_demo_types("Hola! Typed by a hand, 1 tap each.");
}

#[test]
fn the_punctuation_of_ascii_arrives_byte_for_byte() {
    the_demo_types("!\"#$%&'()*+,-./:;<=>?@[\\]^_`{|}~");
}

#[test]
fn characters_that_no_key_writes_arrive_byte_for_byte() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(terminal) = Terminal::start(&compositor) else {
        return;
    };
    let text = "äöüß €éñ λ→∀ 日本語 🙂 aaa{[|]}@~\\";
    let mut sink = compositor.desktop();
    for character in text.chars() {
        sink.send(&[event(EventKind::Character(character))])
            .expect("there is room");
    }
    sink.close().expect("it takes everything");
    assert_eq!(terminal.typed(text), text);
}

#[test]
fn keys_and_characters_take_turns() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(window) = Window::open(&compositor) else {
        return;
    };
    let key = |name: &str| name.parse().expect("the name of a key");
    let mut sink = compositor.desktop();
    let actions = [
        EventKind::KeyDown(key("ShiftLeft")),
        EventKind::KeyDown(key("A")),
        EventKind::Character('ß'),
        EventKind::KeyUp(key("A")),
        EventKind::KeyUp(key("ShiftLeft")),
        EventKind::KeyDown(key("B")),
        EventKind::KeyUp(key("B")),
    ];
    sink.send(&actions.map(event)).expect("there is room");
    sink.close().expect("it takes everything");
    let heard = window.heard_until("up b");
    let keys: Vec<_> = heard
        .iter()
        .filter(|line| !line.starts_with("held"))
        .collect();
    let expected = [
        "down Shift_L",
        "down A",
        "down ssharp",
        "up ssharp",
        "up A",
        "up Shift_L",
        "down b",
        "up b",
    ];
    assert_eq!(keys, expected, "{heard:#?}");
}

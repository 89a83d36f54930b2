//! The demo types into a terminal, and characters that are not in the keymap.

use ademan::device::EventKind;
use ademan::output::Sink;

use super::compositor::{Compositor, event};
use super::window::{Terminal, Window};
use crate::support::x11::wait_for;

/// The message of the demo after a stall.
const STALLED: &str = "the typed text differs from the given one";

/// Runs the demo in front of a terminal and checks what is typed. A busy machine may cause a stall; then the demo is
/// repeated.
fn assert_demo_types(text: &str) {
    for _ in 0..3 {
        let Some(compositor) = Compositor::sway() else {
            return;
        };
        let Some(terminal) = Terminal::start(&compositor) else {
            return;
        };
        let mut program = compositor.run(["demo", "--output", "desktop", "--text", text]);
        let status = program.wait_for_exit();
        if program.count_lines(STALLED) > 0 {
            println!("stalled: {:?}", program.stderr_lines());
            continue;
        }
        assert_eq!(status.code(), Some(0), "{:#?}", program.stderr_lines());
        assert_eq!(terminal.typed(text), text);
        return;
    }
    panic!("the machine is too busy");
}

#[test]
fn a_text_arrives_byte_for_byte() {
    assert_demo_types("Hola! Typed by a hand, 1 tap each.");
}

#[test]
fn ascii_punctuation_arrives_byte_for_byte() {
    assert_demo_types("!\"#$%&'()*+,-./:;<=>?@[\\]^_`{|}~");
}

#[test]
fn characters_that_are_not_in_the_keymap_arrive_byte_for_byte() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(terminal) = Terminal::start(&compositor) else {
        return;
    };
    let text = "äöüß €éñ λ→∀ 日本語 🙂 aaa{[|]}@~\\";
    let mut sink = compositor.desktop();
    for (start, character) in text.char_indices() {
        sink.send(&[event(EventKind::Character(character))])
            .expect("the queue has room");
        // A press that waits while a busy machine starves the sink would be dropped.
        terminal.typed(&text[..start + character.len_utf8()]);
    }
    // The same characters arrive as one text.
    let events = text.chars().map(EventKind::Character).map(event);
    sink.send(&events.collect::<Vec<_>>())
        .expect("the queue has room");
    sink.close().expect("everything is sent");
    let twice = text.repeat(2);
    assert_eq!(terminal.typed(&twice), twice);
}

#[test]
fn characters_arrive_with_caps_lock_and_a_held_control() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(terminal) = Terminal::start(&compositor) else {
        return;
    };
    let key = |name: &str| name.parse().expect("the name of a key");
    let (caps_lock, control) = (key("CapsLock"), key("ControlLeft"));
    let text = || "niño".chars().map(EventKind::Character);
    let mut events = vec![EventKind::KeyDown(caps_lock), EventKind::KeyUp(caps_lock)];
    events.extend(text());
    events.push(EventKind::KeyDown(control));
    events.extend(text());
    events.push(EventKind::KeyUp(control));
    let mut sink = compositor.desktop();
    let events: Vec<_> = events.into_iter().map(event).collect();
    sink.send(&events).expect("the queue has room");
    sink.close().expect("everything is sent");
    assert_eq!(terminal.typed("niñoniño"), "niñoniño");
}

#[test]
fn a_text_with_a_character_that_no_key_types_is_dropped_entirely_and_is_no_failure() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(terminal) = Terminal::start(&compositor) else {
        return;
    };
    let mut sink = compositor.desktop();
    let characters = |text: &str| -> Vec<_> {
        let events = text.chars().map(EventKind::Character);
        events.map(event).collect()
    };
    // What follows the text would act without it.
    for text in ["a\u{fffe}b", "c"] {
        sink.send(&characters(text)).expect("the queue has room");
    }
    let are_dropped = wait_for(|| sink.has_stalled() && sink.dropped_presses() >= 4);
    assert!(are_dropped, "{} presses", sink.dropped_presses());
    // As the loop does after a stall.
    sink.void_presses();
    sink.send(&characters("d")).expect("the queue has room");
    sink.close().expect("the rest is sent");
    assert_eq!(terminal.typed("d"), "d");
    assert_eq!(sink.dropped_presses(), 4);
}

#[test]
fn keys_and_characters_can_alternate() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(window) = Window::open(&compositor) else {
        return;
    };
    let key = |name: &str| name.parse().expect("the name of a key");
    let mut sink = compositor.desktop();
    let events = [
        EventKind::KeyDown(key("ShiftLeft")),
        EventKind::KeyDown(key("A")),
        EventKind::Character('ß'),
        EventKind::KeyUp(key("A")),
        EventKind::KeyUp(key("ShiftLeft")),
        EventKind::KeyDown(key("B")),
        EventKind::KeyUp(key("B")),
    ];
    sink.send(&events.map(event)).expect("the queue has room");
    sink.close().expect("everything is sent");
    let received = window.events_until("up b");
    let keys: Vec<_> = received
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
    assert_eq!(keys, expected, "{received:#?}");
}

//! Bursts: corrections and texts that arrive entirely or not at all.

use super::*;

/// Returns the strokes of a burst as text: `+A-A` for a tap of A.
pub fn describe(burst: &[Stroke]) -> String {
    let words = burst.iter().map(|stroke| match stroke {
        Stroke::Key(key, KeyDirection::Press) => format!("+{key}"),
        Stroke::Key(key, KeyDirection::Release) => format!("-{key}"),
        Stroke::Character(character) => character.to_string(),
    });
    words.collect()
}

fn characters(time: u64, text: &str) -> Vec<OutputEvent> {
    let event = |character| event(time, EventKind::Character(character));
    text.chars().map(event).collect()
}

pub fn tap(time: u64, name: &str) -> [OutputEvent; 2] {
    [down(time, name), up(time, name)]
}

/// Returns a correction: two Backspaces and a text.
fn correction(time: u64, text: &str) -> Vec<OutputEvent> {
    let backspace = tap(time, "Backspace");
    [&backspace[..], &backspace, &characters(time, text)].concat()
}

#[test]
fn a_correction_is_executed_entirely_or_not_at_all() {
    let (display, mut sink) = open_responding();
    sink.send(&correction(1, "ok")).unwrap();
    direct::wait_until_idle(&sink);
    let expected = ["type +Backspace-Backspace+Backspace-Backspaceok"];
    assert_eq!(display.lines(), expected);
    sink.send(&correction(2, "é")).unwrap();
    direct::wait_until_idle(&sink);
    assert_eq!(display.lines(), expected);
    assert_eq!(sink.dropped_presses(), 3);
    assert!(sink.has_stalled());
}

#[test]
fn a_correction_that_becomes_void_while_the_display_does_not_respond_deletes_nothing() {
    let dropped = void_while_the_display_does_not_respond(&correction(1, "ok"));
    assert_eq!(dropped, 4);
}

#[test]
fn a_key_after_a_text_that_cannot_be_typed_is_not_sent() {
    let (display, mut sink) = open_responding();
    sink.send(&characters(1, "é")).unwrap();
    sink.send(&tap(2, "Enter")).unwrap();
    sink.send(&tap(3, "Enter")).unwrap();
    sink.close().unwrap();
    assert_eq!(display.lines(), [""; 0]);
    assert_eq!(sink.dropped_presses(), 3);
}

#[test]
fn the_keys_of_a_burst_that_failed_are_released_at_the_end() {
    let (display, mut sink, gate) = open_gated();
    display.0.lock().unwrap().failures = 1;
    sink.send(&[tap(1, "Backspace"), tap(1, "A")].concat())
        .unwrap();
    drop(gate);
    sink.close().unwrap_err();
    assert_eq!(display.lines(), ["-A", "-Backspace"]);
}

/// Opens a sink that has typed in the first window.
fn open_in_a_window() -> (TestDisplay, Desktop) {
    let (display, mut sink) = open_responding();
    display.0.lock().unwrap().focus = Some(1);
    sink.send(&characters(1, "a")).unwrap();
    direct::wait_until_idle(&sink);
    assert_eq!(sink.text_field().generation, 0);
    (display, sink)
}

#[test]
fn a_correction_does_not_reach_another_window() {
    let (display, mut sink) = open_in_a_window();
    sink.send(&correction(2, "b")).unwrap();
    direct::wait_until_idle(&sink);
    display.0.lock().unwrap().focus = Some(2);
    sink.send(&correction(3, "c")).unwrap();
    direct::wait_until_idle(&sink);
    assert_eq!(sink.text_field().generation, 1);
    assert_eq!(sink.dropped_presses(), 3);
    assert!(sink.has_stalled());
    sink.void_presses();
    sink.send(&characters(4, "d")).unwrap();
    sink.send(&correction(5, "e")).unwrap();
    sink.close().unwrap();
    let backspaces = "+Backspace-Backspace+Backspace-Backspace";
    let lines = [
        "type a".to_owned(),
        format!("type {backspaces}b"),
        "type d".to_owned(),
        format!("type {backspaces}e"),
    ];
    assert_eq!(display.lines(), lines);
}

#[test]
fn an_idle_thread_notices_that_another_window_has_the_focus() {
    let (display, mut sink) = open_in_a_window();
    display.0.lock().unwrap().focus = Some(2);
    wait_until("another text field", || sink.text_field().generation > 0);
    // Both follow the change.
    sink.send(&correction(2, "b")).unwrap();
    direct::wait_until_idle(&sink);
    assert_eq!(sink.dropped_presses(), 3, "its text is in the first window");
}

/// Opens a sink that a decoder follows and that has typed a key, and presses another keyboard.
fn press_another_keyboard() -> (TestDisplay, Desktop) {
    let (display, mut sink) = open_in_a_window();
    sink.send(&tap(2, "A")).unwrap();
    direct::wait_until_idle(&sink);
    assert_eq!(sink.text_field().generation, 0);
    display.0.lock().unwrap().has_foreign_press = true;
    (display, sink)
}

#[test]
fn a_correction_deletes_nothing_after_a_press_of_another_device() {
    let (display, mut sink) = press_another_keyboard();
    sink.send(&correction(3, "b")).unwrap();
    direct::wait_until_idle(&sink);
    assert_eq!(sink.text_field().generation, 1);
    assert_eq!(sink.dropped_presses(), 3);
    assert!(sink.has_stalled());
    sink.void_presses();
    sink.send(&tap(4, "C")).unwrap();
    sink.send(&correction(5, "d")).unwrap();
    sink.close().unwrap();
    let corrected = "type +Backspace-Backspace+Backspace-Backspaced";
    let lines = ["type a", "+A", "-A", "+C", "-C", corrected];
    assert_eq!(display.lines(), lines);
}

#[test]
fn an_idle_thread_notices_a_press_of_another_device() {
    let (_display, mut sink) = press_another_keyboard();
    wait_until("another text field", || sink.text_field().generation > 0);
    // Both follow the press.
    sink.send(&correction(3, "b")).unwrap();
    direct::wait_until_idle(&sink);
    assert_eq!(sink.dropped_presses(), 3, "its text is before the press");
}

#[test]
fn other_devices_are_watched_only_for_a_decoder_whose_keys_the_output_types() {
    let is_watched = |is_followed: bool, typed: &[OutputEvent]| {
        let (display, mut sink) = open_responding();
        display.0.lock().unwrap().has_foreign_press = true;
        if is_followed {
            sink.text_field();
        }
        sink.send(typed).unwrap();
        sink.send(&correction(2, "b")).unwrap();
        sink.close().unwrap();
        !display.0.lock().unwrap().has_foreign_press
    };
    assert!(is_watched(true, &tap(1, "A")));
    assert!(!is_watched(false, &tap(1, "A")), "without a decoder");
    let text = characters(1, "a");
    assert!(!is_watched(true, &text), "another output has the keys");
}

#[test]
fn a_text_is_typed_entirely_or_dropped_entirely_and_is_no_failure() {
    let (display, mut sink) = open_responding();
    let texts = [
        characters(1, "abc"),
        characters(2, "aéc"),
        characters(3, "d"),
    ];
    sink.send(&texts.concat()).unwrap();
    direct::wait_until_idle(&sink);
    // What follows the text would act without it.
    assert_eq!(sink.dropped_presses(), 4);
    assert!(sink.has_stalled());
    sink.void_presses();
    sink.send(&texts[2]).unwrap();
    sink.close().unwrap();
    assert_eq!(display.lines(), ["type abc", "type d"]);
}

#[test]
fn a_text_without_room_in_the_queue_is_dropped_entirely() {
    let (display, mut sink, gate) = open_gated();
    let text = "x".repeat(QUEUE / 8);
    for time in 0..8 {
        sink.send(&characters(time, &text)).unwrap();
    }
    assert!(sink.dropped_presses() > 0);
    drop(gate);
    sink.close().unwrap();
    // Events that wait before a dropped text are void, too.
    assert!(display.lines().is_empty());
    assert_eq!(sink.dropped_presses() as usize, 8 * text.len());
}

#[test]
fn a_failed_character_is_not_repeated() {
    let (display, mut sink, gate) = open_gated();
    display.0.lock().unwrap().failures = 1;
    sink.send(&[event(1, EventKind::Character('a'))]).unwrap();
    drop(gate);
    sink.close().unwrap_err();
    assert_eq!(display.lines(), [""; 0]);
}

//! Questions to a log of key events.

use std::time::Instant;

use crate::support::key_log::{Action, KeyEvent, pressed};

/// Returns the first time at or after `from` at which no key is pressed, or `None` if a key always is.
pub fn first_release(events: &[KeyEvent], from: Instant) -> Option<Instant> {
    let before = events.partition_point(|event| event.time <= from);
    let mut down = pressed(&events[..before]);
    if down.is_empty() {
        return Some(from);
    }
    for event in &events[before..] {
        match event.action {
            Action::Release => down.remove(&event.input),
            Action::Press | Action::Repeat => down.insert(event.input),
        };
        if down.is_empty() {
            return Some(event.time);
        }
    }
    None
}

/// Returns the number of presses after `from`.
pub fn presses_after(events: &[KeyEvent], from: Instant) -> usize {
    let after = events.iter().filter(|event| event.time > from);
    after.filter(|event| event.action == Action::Press).count()
}

#[test]
fn the_first_release_is_the_end_of_the_last_press() {
    use crate::support::key_log::Input;
    use std::time::Duration;

    let start = Instant::now();
    let at = |milliseconds| start + Duration::from_millis(milliseconds);
    let event = |milliseconds, code, action| KeyEvent {
        time: at(milliseconds),
        input: Input::Key(code),
        action,
    };
    let events = [
        event(10, 50, Action::Press),
        event(20, 43, Action::Press),
        event(30, 43, Action::Repeat),
        event(40, 43, Action::Release),
        event(50, 50, Action::Release),
        event(60, 43, Action::Press),
    ];
    assert_eq!(first_release(&events, at(5)), Some(at(5)));
    assert_eq!(first_release(&events, at(15)), Some(at(50)));
    assert_eq!(first_release(&events, at(55)), Some(at(55)));
    assert_eq!(first_release(&events, at(65)), None);
    assert_eq!(presses_after(&events, at(15)), 2);
    assert_eq!(presses_after(&events, at(60)), 0);
}

//! Key events as words: `+A` for a press, `-A` for a release.

use ademan::device::{EventKind, Events};

/// Appends the presses and releases of `events` to `words`.
pub fn push_key_words(events: &Events, words: &mut Vec<String>) {
    for event in events {
        match event.kind {
            EventKind::KeyDown(key) => words.push(format!("+{key}")),
            EventKind::KeyUp(key) => words.push(format!("-{key}")),
            _ => {}
        }
    }
}

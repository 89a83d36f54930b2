//! Keys as they type characters, without the decoder.

use crate::correction::ends_word;

use ademan_core::device::pressed_keys::PressedKeys;
use ademan_core::device::{EventKind, KeyCode, OutputEvent};

/// Returns `true` for a mark that takes the place of the space that a candidate has brought.
pub(super) fn takes_space(mark: char) -> bool {
    matches!(mark, '.' | ',' | ';' | ':' | '!' | '?')
}

/// Returns `true` if the cursor is inside a word after events of the mode `literal`, as far as is known; `is_inside` if it was before
/// them, with the keys `held`.
pub(super) fn ends_inside_word(
    mut is_inside: bool,
    held: &PressedKeys,
    events: &[OutputEvent],
) -> bool {
    let mut is_shifted = held.release_order().any(KeyCode::is_shift);
    for event in events {
        is_inside = match event.kind {
            EventKind::KeyDown(key) if key.is_shift() => {
                is_shifted = true;
                continue;
            }
            EventKind::KeyDown(key) if key.is_modifier() => continue,
            EventKind::KeyDown(key) => match key.us_character(is_shifted) {
                Some(character) => !ends_word(character),
                // An arrow or a Backspace, for example: the cursor may be in a word.
                None => true,
            },
            EventKind::Character(character) => !ends_word(character),
            _ => continue,
        };
    }
    is_inside
}

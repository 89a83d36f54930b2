//! X11: keys are injected by their key codes.

use std::env;

use enigo::{Direction, Enigo, InputResult, Keyboard};

use crate::advice;
use ademan_core::device::KeyCode;

/// Injects the key at this position of the keyboard, whatever character the keymap assigns to it.
pub fn inject_key(enigo: &mut Enigo, key: KeyCode, direction: Direction) -> InputResult<()> {
    enigo.raw(key.x11_code(), direction)
}

/// Returns `true` if the system has this key.
pub fn has_key(_: KeyCode) -> bool {
    true
}

/// Returns the message for a display that does not answer; `None` stands for the display in `DISPLAY`.
pub fn no_display(display: Option<&str>) -> String {
    let display = display.map(str::to_owned);
    let display = display.or_else(|| env::var("DISPLAY").ok());
    advice::no_display(display.as_deref()).to_string()
}

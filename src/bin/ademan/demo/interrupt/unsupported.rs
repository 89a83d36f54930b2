//! Systems on which the keys of the terminal are read.

use std::io;
use std::time::Duration;

use ratatui::crossterm::event::{self, Event, KeyCode, KeyModifiers};

use crate::signals;

/// Does nothing: [`check`] reads the keys.
pub fn enable() -> io::Result<()> {
    Ok(())
}

/// Reads the keys that were typed and stops the demo on Ctrl-C.
pub fn check() -> io::Result<()> {
    while event::poll(Duration::ZERO)? {
        if is_ctrl_c(&event::read()?) {
            signals::interrupt();
        }
    }
    Ok(())
}

/// Does nothing: the keys were read.
pub fn discard_input() {}

fn is_ctrl_c(event: &Event) -> bool {
    event.as_key_press_event().is_some_and(|key| {
        key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL)
    })
}

//! Systems on which the keys of the terminal are read, and on which it is not known whether a write would block.

use std::io::{self, IsTerminal, Stdout, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use ratatui::crossterm::event::{self, Event, KeyCode, KeyModifiers};
use ratatui::crossterm::terminal::{disable_raw_mode, enable_raw_mode};

use super::{ENTER, LEAVE};
use crate::signals;

/// The environment does not name the character set, which is Unicode.
pub const HAS_LOCALE: bool = false;

static IS_COVERED: AtomicBool = AtomicBool::new(false);
/// The terminal has other modes than before.
static HAS_LEFT_MODES: AtomicBool = AtomicBool::new(false);

/// Returns `true` if standard output is a terminal.
pub fn is_usable() -> bool {
    io::stdout().is_terminal()
}

/// Covers the terminal.
pub fn take_over() -> io::Result<()> {
    enable_raw_mode()?;
    HAS_LEFT_MODES.store(true, Ordering::Release);
    IS_COVERED.store(true, Ordering::Release);
    let mut out = io::stdout();
    out.write_all(ENTER)?;
    out.flush()
}

/// Restores the terminal. Has no effect if it is not covered.
pub fn restore() {
    IS_COVERED.store(false, Ordering::Release);
    if HAS_LEFT_MODES.swap(false, Ordering::AcqRel) {
        let _ = disable_raw_mode();
        let mut out = io::stdout();
        let _ = out.write_all(LEAVE).and_then(|()| out.flush());
    }
}

/// Writes to the terminal after the view.
pub fn write_after(text: &str) {
    let _ = io::stdout().write_all(text.as_bytes());
}

/// Drops pictures from now on, also one that the terminal has not accepted yet.
pub fn end_output() {
    IS_COVERED.store(false, Ordering::Release);
}

/// Returns the number of takeovers so far: it is never given back for some time.
pub fn takeover() -> u32 {
    1
}

/// Returns `true` if the view covers the terminal.
pub fn is_covered() -> bool {
    IS_COVERED.load(Ordering::Acquire)
}

/// Reads the keys that were typed, and stops the program on Ctrl-C.
pub fn check_keys() -> io::Result<()> {
    while event::poll(Duration::ZERO)? {
        if is_ctrl_c(&event::read()?) {
            signals::interrupt();
        }
    }
    Ok(())
}

/// Returns the letters that were typed since the last call, without waiting.
pub fn typed_keys() -> io::Result<Vec<u8>> {
    let mut keys = Vec::new();
    while event::poll(Duration::ZERO)? {
        let event = event::read()?;
        if is_ctrl_c(&event) {
            signals::interrupt();
        } else if let Some(KeyCode::Char(letter)) = event.as_key_press_event().map(|key| key.code)
            && let Ok(letter) = u8::try_from(letter)
        {
            keys.push(letter);
        }
    }
    Ok(keys)
}

fn is_ctrl_c(event: &Event) -> bool {
    event.as_key_press_event().is_some_and(|key| {
        key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL)
    })
}

/// The writer of pictures.
pub struct Output(Stdout);

impl Output {
    pub fn open() -> io::Result<Self> {
        Ok(Self(io::stdout()))
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

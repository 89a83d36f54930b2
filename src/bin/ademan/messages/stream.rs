//! Standard error, or the live view while that covers the terminal.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::terminal_width;
use super::wrap::wrapped;

/// Lines that are kept for standard error until the view ends.
const CAPACITY: usize = 256;

static HELD: Mutex<Held> = Mutex::new(Held {
    is_held: false,
    lines: VecDeque::new(),
    lost: 0,
});

/// Lines that only the view has shown so far.
struct Held {
    is_held: bool,
    lines: VecDeque<String>,
    /// Lines that did not fit.
    lost: u64,
}

/// Keeps messages for the view from now on, instead of writing them.
pub fn hold() {
    lock().is_held = true;
}

/// Writes messages again, those that were kept first: with the next message or flush.
pub fn release() {
    lock().is_held = false;
}

/// Returns the latest lines that were kept, at most `count`, oldest first.
pub fn latest(count: usize) -> Vec<String> {
    let held = lock();
    let skipped = held.lines.len().saturating_sub(count);
    held.lines.iter().skip(skipped).cloned().collect()
}

fn lock() -> MutexGuard<'static, Held> {
    HELD.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Held {
    fn keep(&mut self, text: &str) {
        for line in text.lines() {
            if self.lines.len() == CAPACITY {
                self.lines.pop_front();
                self.lost += 1;
            }
            self.lines.push_back(line.to_owned());
        }
    }

    /// Takes the text of all lines, if they may be written now.
    fn take(&mut self) -> Option<String> {
        if self.is_held || self.lines.is_empty() {
            return None;
        }
        let mut text = String::new();
        if self.lost > 0 {
            text = format!("{} earlier lines were shown in the view only\n", self.lost);
            self.lost = 0;
        }
        for line in self.lines.drain(..) {
            text += &line;
            text.push('\n');
        }
        Some(text)
    }
}

/// Writes whole lines to standard error, which break between words if it is a terminal.
pub fn write_to_terminal(lines: &str) -> io::Result<()> {
    let columns = terminal_width::columns().unwrap_or_default();
    io::stderr().write_all(wrapped(lines, columns).as_bytes())
}

/// The writer of all messages.
pub struct MessageStream;

impl Write for MessageStream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.write_all(bytes).map(|()| bytes.len())
    }

    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        let kept = {
            let mut held = lock();
            if held.is_held {
                held.keep(&String::from_utf8_lossy(bytes));
                return Ok(());
            }
            held.take()
        };
        // Without the lock: standard error may block.
        if let Some(kept) = kept {
            write_to_terminal(&kept)?;
        }
        write_to_terminal(&String::from_utf8_lossy(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        let kept = lock().take();
        match kept {
            Some(kept) => write_to_terminal(&kept),
            None => Ok(()),
        }
    }
}

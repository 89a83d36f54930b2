//! Signals of a terminal in raw mode. The terminal is never read: a read spins once its window is closed.

use std::fs::File;
use std::io;

use rustix::termios::{LocalModes, OptionalActions, QueueSelector, tcflush, tcgetattr, tcsetattr};

/// Makes the terminal send a signal for Ctrl-C, although it is in raw mode.
pub fn enable() -> io::Result<()> {
    let terminal = File::open("/dev/tty")?;
    let mut modes = tcgetattr(&terminal)?;
    modes.local_modes |= LocalModes::ISIG;
    Ok(tcsetattr(&terminal, OptionalActions::Now, &modes)?)
}

/// Does nothing: the signal comes by itself.
pub fn check() -> io::Result<()> {
    Ok(())
}

/// Discards keys that were typed meanwhile. The shell would read them otherwise.
pub fn discard_input() {
    if let Ok(terminal) = File::open("/dev/tty") {
        let _ = tcflush(&terminal, QueueSelector::IFlush);
    }
}

//! Messages on standard error, which may be a terminal that is stopped or a full pipe.
//!
//! A command that runs a session [starts](start) a queue with a thread of its own, so that no message delays a release.
//! A full queue drops messages, and their number is printed once the stream accepts data again. The other commands print at once.
//! While the live view covers the terminal, messages are [held](hold) for it, and written to standard error when it ends.
//! Text of others is escaped, and log messages are limited by kind and source.

mod log;
mod queue;
mod stream;

use std::io::{self, Write};
use std::sync::OnceLock;
use std::time::Duration;

use ademan::message::escape_lines;

use self::queue::MessageQueue;
use self::stream::MessageStream;
pub use self::stream::{hold, latest, release};
use crate::failure::Failure;

/// Longest wait at the end of the program for a standard error that is not read.
const FLUSH_TIMEOUT: Duration = Duration::from_millis(500);

static QUEUE: OnceLock<MessageQueue> = OnceLock::new();

/// Sends log messages of the library to standard error.
pub fn install_log() {
    log::install();
}

/// Prints all later messages on a thread of its own.
pub fn start() -> Result<(), Failure> {
    let queue = MessageQueue::start(MessageStream, log::take_due).map_err(Failure::no_thread)?;
    // A second queue would have no messages.
    let _ = QUEUE.set(queue);
    Ok(())
}

/// Prints a message of one or more lines. A closed or full standard error is ignored: it must not end a session.
pub fn print(message: &str) {
    let line = format!("{}\n", escape_lines(message));
    match QUEUE.get() {
        Some(queue) => queue.push(line),
        None => _ = io::stderr().write_all(line.as_bytes()),
    }
}

/// Waits until all messages are printed, at most 0.5 s.
pub fn flush() {
    flush_within(FLUSH_TIMEOUT);
}

/// Waits until all messages are printed, or the time is over.
pub fn flush_within(timeout: Duration) {
    log::take_all().iter().for_each(|message| print(message));
    if let Some(queue) = QUEUE.get() {
        queue.flush(timeout);
    }
}

/// Makes the thread ask for log messages that are held back.
fn wake() {
    if let Some(queue) = QUEUE.get() {
        queue.wake();
    }
}

//! The file of `--log`: all messages with their time, written on a thread of its own.

use std::path::Path;
use std::sync::OnceLock;
use std::time::{Duration, SystemTime};

use ademan::files;
use ademan::message::escape_path;

use super::queue::MessageQueue;
use crate::failure::Failure;

static QUEUE: OnceLock<MessageQueue> = OnceLock::new();

/// Writes all later messages to the end of a file, which only its owner can read. Starts a thread.
pub fn open(path: &Path) -> Result<(), Failure> {
    let file = files::append_private(path).map_err(|error| {
        let path = escape_path(path);
        Failure::wrong_use(format!("cannot write the log to {path}: {error}"))
    })?;
    let queue = MessageQueue::start(file, || (Vec::new(), None)).map_err(Failure::no_thread)?;
    // A second file would have no messages.
    let _ = QUEUE.set(queue);
    Ok(())
}

/// Writes lines, if there is a file. Does not wait.
pub fn write(lines: &str) {
    if let Some(queue) = QUEUE.get() {
        let now = humantime::format_rfc3339_seconds(SystemTime::now());
        let lines = lines.lines().map(|line| format!("{now} {line}\n"));
        queue.push(lines.collect());
    }
}

/// Waits until all lines are written, or the time is over.
pub fn flush(timeout: Duration) {
    if let Some(queue) = QUEUE.get() {
        queue.flush(timeout);
    }
}

//! The file of `--log`: all messages with their time, written on a thread of its own.

use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::mem;
use std::path::{Path, PathBuf};
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
    let file = LogFile {
        file,
        path: path.to_owned(),
        has_failed: false,
    };
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

/// The file. Its first failure is a message.
struct LogFile {
    file: File,
    path: PathBuf,
    has_failed: bool,
}

impl Write for LogFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes).inspect_err(|error| {
            let is_failure = error.kind() != ErrorKind::Interrupted;
            if is_failure && !mem::replace(&mut self.has_failed, true) {
                let path = escape_path(&self.path);
                complain!("the log {path} is incomplete: {error}; the program continues");
            }
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

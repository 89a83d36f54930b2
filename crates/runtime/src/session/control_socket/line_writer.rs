//! The writing end of a connection.

use std::io::{self, Write};
use std::net::Shutdown;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::response::JsonLine;
use crate::output::socket::Stream;

/// Time-out of a write. A client that does not read for so long is disconnected.
const WRITE_TIMEOUT: Duration = Duration::from_secs(1);

/// The writing end of a connection, shared by responses and notifications. The reading end has the same file descriptor.
pub(super) struct LineWriter {
    stream: Arc<Stream>,
    /// Locked while a line is written.
    line: Mutex<()>,
}

impl LineWriter {
    /// Creates a writer for a stream, which can still be read.
    pub fn new(stream: Arc<Stream>) -> io::Result<Self> {
        stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
        Ok(Self {
            stream,
            line: Mutex::default(),
        })
    }

    /// Writes a line. On an error, such as a client that does not read for 1 s, the client is disconnected.
    pub fn write_line(&self, line: &JsonLine) -> io::Result<()> {
        let _lock = self.line.lock().unwrap_or_else(PoisonError::into_inner);
        let written = (&*self.stream).write_all(format!("{line}\n").as_bytes());
        if written.is_err() {
            self.shutdown();
        }
        written
    }

    /// Disconnects the client. Does not wait for a line that is being written.
    pub fn shutdown(&self) {
        let _ = self.stream.shutdown(Shutdown::Both);
    }
}

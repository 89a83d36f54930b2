//! The writing end of a connection.

use std::io::{self, Write};
use std::net::Shutdown;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use super::response::JsonLine;
use crate::output::socket::Stream;

/// Time-out of a write. A client that does not read for so long is disconnected.
const WRITE_TIMEOUT: Duration = Duration::from_secs(1);

/// The writing end of a connection, shared by responses and notifications.
pub(super) struct LineWriter(Mutex<Stream>);

impl LineWriter {
    /// Creates a writer for a stream, which can still be read.
    pub fn new(stream: &Stream) -> io::Result<Self> {
        let stream = stream.try_clone()?;
        stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
        Ok(Self(Mutex::new(stream)))
    }

    /// Writes a line. On an error, such as a client that does not read for 1 s, the client is disconnected.
    pub fn write_line(&self, line: &JsonLine) -> io::Result<()> {
        let mut stream = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let written = stream.write_all(format!("{line}\n").as_bytes());
        if written.is_err() {
            let _ = stream.shutdown(Shutdown::Both);
        }
        written
    }

    /// Disconnects the client.
    pub fn shutdown(&self) {
        let stream = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = stream.shutdown(Shutdown::Both);
    }
}

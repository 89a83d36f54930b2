//! A client of a server.

use std::io::{ErrorKind, Read};

use super::lines::{FormatSet, Line};
use super::listener::{Connection, Stream};
use super::outbox::Outbox;
use super::target::ShareFormat;

/// A connected client.
pub(super) struct Client {
    /// The index of its server.
    pub server: usize,
    stream: Box<dyn Stream>,
    outbox: Outbox,
    format: ShareFormat,
}

/// The client has to be disconnected.
#[derive(Debug)]
pub(super) struct Disconnected;

impl Client {
    /// Takes over a connection to a server of a format.
    pub fn new(connection: Connection, format: ShareFormat) -> Self {
        Self {
            server: connection.server,
            stream: connection.stream,
            outbox: Outbox::new(),
            format,
        }
    }

    /// Returns the formats of the lines that it wants.
    pub fn wanted(&self) -> FormatSet {
        FormatSet::only(self.format)
    }

    /// Adds the lines that it wants.
    pub fn push(&mut self, lines: &[Line]) {
        for line in lines {
            if line.format == self.format {
                self.outbox.push(line.bytes.clone());
            }
        }
    }

    /// Writes what the client accepts. Fails if it has gone, or has read nothing for one second.
    pub fn flush(&mut self) -> Result<(), Disconnected> {
        self.outbox.flush(&mut *self.stream)
    }

    /// Returns whether lines wait for the client.
    pub fn is_behind(&self) -> bool {
        !self.outbox.is_empty()
    }

    /// Receives what the client has sent. Fails if its format has no requests.
    pub fn receive(&mut self) -> Result<(), Disconnected> {
        match self.stream.read(&mut [0; 1]) {
            Ok(1..) => Err(Disconnected),
            // A client that will never send has closed its half of the connection.
            Ok(0) => Ok(()),
            Err(error) if is_temporary(error.kind()) => Ok(()),
            Err(_) => Err(Disconnected),
        }
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let dropped = self.outbox.take_dropped();
        if dropped > 0 {
            tracing::info!("a client of {} missed {dropped} lines", self.format);
        }
    }
}

/// Returns whether a stream without data failed with this kind of error.
fn is_temporary(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

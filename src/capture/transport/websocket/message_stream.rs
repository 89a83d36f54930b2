//! A connection that limits the bytes of one message.

use std::io::{Error, Read, Result, Write};
use std::time::Duration;

use crate::network::DeadlineStream;

/// Most bytes without a complete message: far more than the longest one, and what was read ahead of it. Fragments without
/// content would otherwise keep a processor busy for ever.
const MAX_BYTES: usize = 1 << 20;

/// A connection whose reads fail if no message is complete after [`MAX_BYTES`].
pub(super) struct MessageStream {
    stream: DeadlineStream,
    /// Bytes since the latest message.
    bytes: usize,
}

impl MessageStream {
    /// Creates it before the handshake.
    pub fn new(stream: DeadlineStream) -> Self {
        Self { stream, bytes: 0 }
    }

    /// Ends the deadline of the handshake, see [`DeadlineStream::end_deadline`].
    pub fn end_deadline(&mut self, timeout: Duration) -> Result<()> {
        self.stream.end_deadline(timeout)
    }

    /// Handles the end of a message.
    pub fn end_message(&mut self) {
        self.bytes = 0;
    }
}

impl Read for MessageStream {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let length = self.stream.read(buffer)?;
        self.bytes += length;
        if self.bytes > MAX_BYTES {
            return Err(Error::other("the client sent 1 MiB without a message"));
        }
        Ok(length)
    }
}

impl Write for MessageStream {
    fn write(&mut self, buffer: &[u8]) -> Result<usize> {
        self.stream.write(buffer)
    }

    fn flush(&mut self) -> Result<()> {
        self.stream.flush()
    }
}

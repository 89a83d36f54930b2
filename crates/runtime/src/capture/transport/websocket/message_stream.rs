//! A connection that limits the bytes of one message.

use std::io::{Error, Read, Result, Write};

/// Maximum number of bytes without a complete message: far more than the longest message and the bytes that are read ahead. Without the
/// limit, fragments without content could keep a processor busy indefinitely.
const MAX_BYTES: usize = 1 << 20;

/// A connection whose reads fail if no message is complete after [`MAX_BYTES`].
pub(in crate::capture::transport) struct MessageStream<S> {
    stream: S,
    /// Bytes since the latest message.
    bytes: usize,
}

impl<S> MessageStream<S> {
    /// Creates it before the handshake.
    pub fn new(stream: S) -> Self {
        Self { stream, bytes: 0 }
    }

    /// Returns the connection.
    pub fn stream_mut(&mut self) -> &mut S {
        &mut self.stream
    }

    /// Handles the end of a message.
    pub fn end_message(&mut self) {
        self.bytes = 0;
    }
}

impl<S: Read> Read for MessageStream<S> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let length = self.stream.read(buffer)?;
        self.bytes += length;
        if self.bytes > MAX_BYTES {
            return Err(Error::other("the client sent 1 MiB without a message"));
        }
        Ok(length)
    }
}

impl<S: Write> Write for MessageStream<S> {
    fn write(&mut self, buffer: &[u8]) -> Result<usize> {
        self.stream.write(buffer)
    }

    fn flush(&mut self) -> Result<()> {
        self.stream.flush()
    }
}

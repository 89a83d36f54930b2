//! Messages of a WebSocket.

use std::io::{self, ErrorKind, Read, Write};

use tungstenite::Message;
use tungstenite::protocol::{Role, WebSocketConfig, WebSocketContext};

use super::frame_limit::FrameLimit;
use crate::share::request::{MAX_REQUEST_BYTES, too_long};
use crate::share::stream::{Received, is_temporary};

/// Bytes of one read. Each client has a buffer for them.
const READ_BYTES: usize = 4096;

/// The reader of the messages of a client.
pub(in crate::share) struct SocketReader {
    context: WebSocketContext,
    limit: FrameLimit,
    is_closed: bool,
}

impl SocketReader {
    /// Creates a reader after the handshake. `rest` are the bytes that came with it.
    pub fn new(rest: Vec<u8>) -> Self {
        let config = WebSocketConfig::default()
            .read_buffer_size(READ_BYTES)
            .max_message_size(Some(MAX_REQUEST_BYTES))
            .max_frame_size(Some(MAX_REQUEST_BYTES));
        let mut limit = FrameLimit::new();
        limit.push(&rest);
        Self {
            context: WebSocketContext::from_partially_read(rest, Role::Server, Some(config)),
            limit,
            is_closed: false,
        }
    }

    /// Returns `true` once the client has closed the WebSocket. The latest reply is the answer to it.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Receives a message. The replies of the protocol itself are bytes to send.
    pub fn receive(&mut self, stream: &mut dyn Read) -> Received {
        let mut replies = Vec::new();
        let mut pipe = Pipe {
            stream,
            replies: &mut replies,
            limit: &mut self.limit,
        };
        let message = self.context.read(&mut pipe);
        // It fails only where the read has failed.
        let _ = self.context.flush(&mut pipe);
        if let Some(reason) = self.limit.exceeded() {
            return Received::Refused(reason.to_owned());
        }
        self.is_closed |= matches!(message, Ok(Message::Close(_)));
        match message {
            Ok(Message::Text(text)) => Received::Request(text.as_bytes().to_vec()),
            Ok(Message::Binary(_)) => Received::Refused("a request is a text message".into()),
            Ok(_) => Received::Reply(replies.into()),
            Err(tungstenite::Error::Io(error)) if is_temporary(error.kind()) => Received::Nothing,
            Err(tungstenite::Error::Capacity(_)) => Received::Refused(too_long()),
            Err(_) => Received::Gone,
        }
    }
}

/// The connection, with a buffer in place of its output: a reply must not come between the bytes of another frame.
struct Pipe<'a> {
    stream: &'a mut dyn Read,
    replies: &'a mut Vec<u8>,
    limit: &'a mut FrameLimit,
}

impl Read for Pipe<'_> {
    /// Counts the frames: a read of the library returns none of the parts of a message, and reads on after each of them.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.limit.exceeded().is_some() {
            return Err(ErrorKind::WouldBlock.into());
        }
        let count = self.stream.read(buffer)?;
        self.limit.push(&buffer[..count]);
        Ok(count)
    }
}

impl Write for Pipe<'_> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.replies.extend_from_slice(buffer);
        Ok(buffer.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

//! Messages of a WebSocket.

use std::io::{self, Read, Write};

use tungstenite::Message;
use tungstenite::protocol::{Role, WebSocketConfig, WebSocketContext};

use crate::network::Stream;
use crate::share::request::MAX_REQUEST_BYTES;
use crate::share::stream::{Received, is_temporary};

/// The reader of the messages of a client.
pub(in crate::share) struct SocketReader {
    context: WebSocketContext,
}

impl SocketReader {
    /// Creates a reader after the handshake. `rest` are the bytes that came with it.
    pub fn new(rest: Vec<u8>) -> Self {
        let config = WebSocketConfig::default()
            .max_message_size(Some(MAX_REQUEST_BYTES))
            .max_frame_size(Some(MAX_REQUEST_BYTES));
        Self {
            context: WebSocketContext::from_partially_read(rest, Role::Server, Some(config)),
        }
    }

    /// Receives a message. The replies of the protocol itself are bytes to send.
    pub fn receive(&mut self, stream: &mut dyn Stream) -> Received {
        let mut replies = Vec::new();
        let mut pipe = Pipe {
            stream,
            replies: &mut replies,
        };
        let message = self.context.read(&mut pipe);
        // It fails only where the read has failed.
        let _ = self.context.flush(&mut pipe);
        match message {
            Ok(Message::Text(text)) => Received::Request(text.as_bytes().to_vec()),
            Ok(Message::Binary(_)) => Received::Refused("a request is a text message".into()),
            Ok(_) => Received::Reply(replies),
            Err(tungstenite::Error::Io(error)) if is_temporary(error.kind()) => Received::Nothing,
            Err(_) => Received::Gone,
        }
    }
}

/// The connection, with a buffer in place of its output: a reply must not come between the bytes of another frame.
struct Pipe<'a> {
    stream: &'a mut dyn Stream,
    replies: &'a mut Vec<u8>,
}

impl Read for Pipe<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.read(buffer)
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

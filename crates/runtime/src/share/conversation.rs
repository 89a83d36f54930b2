//! The part of a connection that the client speaks.

use std::io::Read;
use std::sync::Arc;

use super::lines::Line;
use super::request::{MAX_REQUESTS_PER_SECOND, RateLimit};
use super::request_lines::RequestLines;
use super::stream::{Input, Received, read};
use super::target::{ShareFormat, ShareTarget};
use super::web::{Answer, Head, Pages, SocketReader};

/// The state of a conversation.
pub(super) enum Conversation {
    /// The client sends nothing.
    Silent,
    /// The client sends requests as lines.
    Lines(RequestLines, RateLimit),
    /// The client sends the request of a page or a WebSocket.
    Head(Box<Head>),
    /// The client sends requests as messages of a WebSocket.
    Socket(Box<SocketReader>, RateLimit),
    /// The client is disconnected once it has read the last line or reply.
    Closing,
}

impl Conversation {
    /// Creates the conversation of a new client of a target.
    pub fn new(target: &ShareTarget) -> Self {
        match target.format {
            ShareFormat::Json => Self::Lines(RequestLines::default(), request_limit()),
            ShareFormat::Ws => Self::Head(Box::new(Head::new(target.address, Pages::None))),
            ShareFormat::Web => Self::Head(Box::new(Head::new(target.address, Pages::Viewer))),
            _ => Self::Silent,
        }
    }

    /// Returns `true` if lines are sent as frames.
    pub fn is_framed(&self) -> bool {
        matches!(self, Self::Socket(..))
    }

    /// Returns the bytes of a line for this client.
    pub fn bytes_of(&self, line: &Line) -> Option<Arc<[u8]>> {
        if self.is_framed() {
            line.frame.clone()
        } else {
            Some(line.bytes.clone())
        }
    }

    /// Receives the next part of what the client has sent. The end of its input is the end of the connection, also of a
    /// client that only listens: a client that has gone looks the same until something is sent to it.
    pub fn receive(&mut self, stream: &mut dyn Read) -> Received {
        match self {
            Self::Silent => match read(stream, &mut [0; 1]) {
                Input::Nothing => Received::Nothing,
                Input::Bytes(_) | Input::Lost => Received::Gone,
            },
            Self::Lines(lines, limit) => limited(lines.receive(stream), limit),
            Self::Head(head) => match head.receive(stream) {
                Ok(None) => Received::Nothing,
                Ok(Some(Answer { bytes, socket })) => {
                    *self = match socket {
                        Some(socket) => Self::Socket(Box::new(socket), request_limit()),
                        None => Self::Closing,
                    };
                    Received::Reply(bytes)
                }
                Err(_) => Received::Gone,
            },
            Self::Socket(reader, limit) => {
                let received = limited(reader.receive(stream), limit);
                if reader.is_closed() {
                    *self = Self::Closing;
                }
                received
            }
            // The rest is read, or closing the connection would take the last line back. It is written even if the client
            // has closed its half of the connection.
            Self::Closing => match read(stream, &mut [0; 4096]) {
                Input::Lost => Received::Gone,
                Input::Bytes(_) | Input::Nothing => Received::Nothing,
            },
        }
    }
}

fn request_limit() -> RateLimit {
    RateLimit::new(MAX_REQUESTS_PER_SECOND, "requests")
}

/// Refuses a request if it is one too many.
fn limited(received: Received, limit: &mut RateLimit) -> Received {
    if !matches!(received, Received::Request(_)) {
        return received;
    }
    match limit.count() {
        Ok(()) => received,
        Err(reason) => Received::Refused(reason),
    }
}

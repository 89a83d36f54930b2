//! A client of a server.

use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::json;

use super::conversation::Conversation;
use super::frame::text_frame;
use super::kinds::{KindSet, LineKind};
use super::lines::{Line, LineEncoder, Wanted};
use super::listener::Connection;
use super::outbox::{Chunk, Outbox};
use super::request::Subscription;
use super::step::SharedStep;
use super::stream::{Disconnected, Received, RoundInput};
use super::target::ShareTarget;
use crate::network::Stream;

/// Most bytes that are read of a client in one round: two of the longest requests of HTTP.
const MAX_ROUND_BYTES: usize = 1 << 14;

/// Longest time without a request, of a client that receives nothing without one. A person may type it.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(30);

/// A connected client.
pub(super) struct Client {
    /// The index of its server.
    pub server: usize,
    target: ShareTarget,
    stream: Box<dyn Stream>,
    outbox: Outbox,
    conversation: Conversation,
    /// `None` until the first request.
    subscription: Option<Subscription>,
    /// The time of the connection or of the last request.
    requested_at: Instant,
    /// Lines that were dropped and not yet reported to the client.
    dropped: u64,
    /// Lines that were dropped in all.
    all_dropped: u64,
}

impl Client {
    /// Takes over a connection to the server of a target.
    pub fn new(connection: Connection, target: &ShareTarget) -> Self {
        Self {
            server: connection.server,
            target: *target,
            stream: connection.stream,
            outbox: Outbox::new(),
            conversation: Conversation::new(target),
            subscription: LineKind::of_target(target).map(Subscription::to),
            requested_at: Instant::now(),
            dropped: 0,
            all_dropped: 0,
        }
    }

    /// Returns the time since which the client has asked for nothing; `None` if it receives lines. The one that has been
    /// silent for the longest time makes room for another client.
    pub fn silent_since(&self) -> Option<Instant> {
        let is_silent = self
            .subscription
            .as_ref()
            .is_none_or(Subscription::is_empty);
        is_silent.then_some(self.requested_at)
    }

    /// Adds the kinds that it wants of a step.
    pub fn start_step(&mut self, step: &SharedStep, wanted: &mut Wanted) {
        let kinds = match &mut self.subscription {
            Some(subscription) => subscription.start_step(step),
            None => KindSet::default(),
        };
        wanted.kinds.insert_all(kinds);
        if self.conversation.is_framed() {
            wanted.frames.insert_all(kinds);
        }
    }

    /// Returns `true` if the client receives [rounds](Self::push_round) of lines of this kind.
    pub fn has_rounds_of(&self, kind: LineKind) -> bool {
        LineKind::of_target(&self.target) == Some(kind)
    }

    /// Adds the lines since the last write, for a client that makes no requests.
    pub fn push_round(&mut self, round: Chunk) {
        self.outbox.push(round);
    }

    /// Adds the lines of the step that it has asked for.
    pub fn push(&mut self, lines: &[Line]) {
        if self.target.format.is_plain() {
            return;
        }
        let Some(subscription) = &self.subscription else {
            return;
        };
        for line in lines.iter().filter(|line| subscription.wants(line)) {
            if let Some(bytes) = self.conversation.bytes_of(line) {
                self.outbox.push(bytes);
            }
        }
    }

    /// Adds the layout, if it wants it and has not got it, and the number of lines that it has missed.
    pub fn catch_up(&mut self, encoder: &mut LineEncoder) {
        self.report_dropped();
        if let Some(subscription) = &mut self.subscription
            && subscription.starts_layout(encoder.layout_number())
            && let Some(bytes) = self.conversation.bytes_of(encoder.layout())
        {
            self.outbox.push(bytes);
        }
    }

    /// Writes what the client accepts. Fails if it has gone, or has read nothing for one second.
    pub fn flush(&mut self) -> Result<(), Disconnected> {
        self.outbox.flush(&mut *self.stream)?;
        let is_over = matches!(self.conversation, Conversation::Closing);
        if is_over && self.outbox.is_empty() {
            Err(Disconnected)
        } else {
            Ok(())
        }
    }

    /// Returns `true` if lines wait for the client.
    pub fn is_behind(&self) -> bool {
        !self.outbox.is_empty()
    }

    /// Receives what the client has sent, as far as one round reads it. Fails if it has gone, or sends what it may not.
    pub fn receive(&mut self) -> Result<(), Disconnected> {
        let refused = match self.receive_requests()? {
            None if self.is_overdue() => {
                Some(format!("no request within {} s", REQUEST_TIMEOUT.as_secs()))
            }
            refused => refused,
        };
        if let Some(reason) = refused {
            self.refuse(&reason);
            // The rest is read, or closing the connection would take the reason back.
            self.receive_requests()?;
        }
        Ok(())
    }

    /// Receives requests. Returns the reason why the client is disconnected, if there is one.
    fn receive_requests(&mut self) -> Result<Option<String>, Disconnected> {
        let mut input = RoundInput::new(&mut self.stream, MAX_ROUND_BYTES);
        loop {
            match self.conversation.receive(&mut input) {
                Received::Nothing => return Ok(None),
                Received::Reply(bytes) => {
                    self.outbox.push(Chunk { bytes, lines: 0 });
                    if matches!(self.conversation, Conversation::Closing) {
                        // No line may follow the last reply.
                        self.subscription = None;
                    }
                }
                Received::Request(request) => match Subscription::parse(&request) {
                    Ok(subscription) => {
                        self.subscription = Some(subscription);
                        self.requested_at = Instant::now();
                    }
                    Err(reason) => return Ok(Some(reason)),
                },
                Received::Refused(reason) => return Ok(Some(reason)),
                Received::Gone => return Err(Disconnected),
            }
        }
    }

    /// Returns `true` if the client has sent no request for too long.
    fn is_overdue(&self) -> bool {
        let is_closing = matches!(self.conversation, Conversation::Closing);
        let is_silent = |since: Instant| since.elapsed() > REQUEST_TIMEOUT;
        !is_closing && self.silent_since().is_some_and(is_silent)
    }

    /// Sends the reason, and disconnects the client once it has read it.
    fn refuse(&mut self, reason: &str) {
        tracing::debug!("a client of {} is disconnected: {reason}", self.target);
        self.subscription = None;
        self.push_object(&json!({"kind": "error", "error": reason}));
        self.conversation = Conversation::Closing;
    }

    /// Tells a client that reads again how many lines it has missed.
    fn report_dropped(&mut self) {
        self.dropped += self.outbox.take_dropped();
        if self.dropped == 0 || !self.outbox.is_empty() {
            return;
        }
        let dropped = std::mem::take(&mut self.dropped);
        self.all_dropped += dropped;
        if !self.target.format.is_plain() {
            self.push_object(&json!({"kind": "dropped", "lines": dropped}));
        }
        if let Some(subscription) = &mut self.subscription {
            subscription.forget_layout();
        }
    }

    fn push_object(&mut self, object: &serde_json::Value) {
        let line = format!("{object}\n");
        let bytes: Arc<[u8]> = if self.conversation.is_framed() {
            text_frame(line.as_bytes())
        } else {
            line.into_bytes().into()
        };
        self.outbox.push(bytes);
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let dropped = self.all_dropped + self.dropped + self.outbox.take_dropped();
        if dropped > 0 {
            tracing::info!("a client of {} missed {dropped} lines", self.target);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Load;
    use crate::network::MemoryStream;
    use crate::share::request::MAX_REQUEST_BYTES;
    use ademan_core::hand::Side;
    use ademan_core::layout::Layout;

    fn client(format: &str, stream: &MemoryStream) -> Client {
        let target = format!("{format}:127.0.0.1:1").parse().unwrap();
        let connection = Connection {
            server: 0,
            stream: Box::new(stream.clone()),
        };
        Client::new(connection, &target)
    }

    #[test]
    fn a_client_that_asks_for_nothing_in_time_is_told_the_reason_and_disconnected() {
        let late = Instant::now().checked_sub(2 * REQUEST_TIMEOUT).unwrap();
        for (format, request, is_late) in [
            ("json", "", true),
            ("json", "{\"kinds\":[]}\n", false),
            ("json", "{\"kinds\":[\"pose\"]}\n", false),
            ("pose", "", false),
        ] {
            let stream = MemoryStream::new(usize::MAX);
            let mut client = client(format, &stream);
            client.requested_at = late;
            stream.send(request.as_bytes());
            assert!(client.receive().is_ok());
            assert_eq!(client.flush().is_err(), is_late, "{format} {request}");
            let answer = String::from_utf8(stream.take_received()).unwrap();
            assert_eq!(
                answer.contains("no request within 30 s"),
                is_late,
                "{answer}"
            );
        }
    }

    /// Returns a client whose connection is a WebSocket.
    fn web_socket(stream: &MemoryStream) -> Client {
        let mut client = client("ws", stream);
        stream.send(
            b"GET /ws HTTP/1.1\r\nHost: 127.0.0.1:1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
              Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
        );
        assert!(client.receive().is_ok());
        assert!(client.flush().is_ok());
        assert!(stream.take_received().starts_with(b"HTTP/1.1 101 "));
        client
    }

    #[test]
    fn a_client_that_closes_its_web_socket_gets_the_answer_and_no_line_after_it() {
        let stream = MemoryStream::new(usize::MAX);
        let mut client = web_socket(&stream);
        let layout = Layout::load("numpad").unwrap();
        let mut encoder = LineEncoder::new(Side::Right, layout.into());
        // A request for the layout, and the frame that closes with the code 1000.
        let request = b"{\"kinds\":[\"layout\"]}";
        stream.send(&[0x81, 0x80 | request.len() as u8, 0, 0, 0, 0]);
        stream.send(request);
        stream.send(&[0x88, 0x82, 0, 0, 0, 0, 0x03, 0xe8]);
        assert!(client.receive().is_ok());
        client.catch_up(&mut encoder);
        assert!(client.flush().is_err(), "the connection ends");
        assert_eq!(stream.take_received(), [0x88, 0x02, 0x03, 0xe8]);
    }

    #[test]
    fn a_message_that_is_too_long_is_refused_with_the_reason() {
        let stream = MemoryStream::new(usize::MAX);
        let mut client = web_socket(&stream);
        let length = MAX_REQUEST_BYTES + 1;
        let [high, low] = (length as u16).to_be_bytes();
        stream.send(&[0x81, 0x80 | 126, high, low, 0, 0, 0, 0]);
        stream.send(" ".repeat(length).as_bytes());
        assert!(client.receive().is_ok());
        assert!(client.flush().is_err(), "the connection ends");
        let answer = stream.take_received();
        let answer = String::from_utf8_lossy(&answer);
        assert!(answer.contains("at most 4096 bytes"), "{answer}");
    }

    #[test]
    fn a_client_that_reads_late_is_told_how_many_lines_it_has_missed() {
        let stream = MemoryStream::new(0);
        let mut client = client("json", &stream);
        let layout = Layout::load("numpad").unwrap();
        let mut encoder = LineEncoder::new(Side::Right, layout.into());
        stream.send(b"{\"kinds\":[\"layout\"]}\n");
        assert!(client.receive().is_ok());
        client.catch_up(&mut encoder);
        let length = encoder.layout().bytes.len();
        let count = 2 * (1 << 18) / length;
        for _ in 0..count {
            let line = encoder.layout();
            client.outbox.push(line.bytes.clone());
        }
        stream.set_room(usize::MAX);
        assert!(client.flush().is_ok());
        client.catch_up(&mut encoder);
        assert!(client.flush().is_ok());
        let output = stream.take_received();
        let lines: Vec<&str> = std::str::from_utf8(&output).unwrap().lines().collect();
        let kept = (1 << 18) / length;
        let missed = format!(r#"{{"kind":"dropped","lines":{}}}"#, count + 1 - kept);
        assert_eq!(lines[kept], missed);
        assert!(lines[kept + 1].starts_with(r#"{"kind":"layout","#), "again");
        assert_eq!(lines.len(), kept + 2);
    }
}

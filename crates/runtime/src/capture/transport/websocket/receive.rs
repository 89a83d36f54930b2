//! The messages of a client: lines of text within limits.

use std::io::{Read, Write};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Sender, TrySendError};
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

use super::clients::ClientId;
use super::message_stream::MessageStream;
use crate::capture::connection::is_idle;

/// Longest message: no protocol has longer lines.
const MAX_MESSAGE_BYTES: usize = 1 << 16;

/// Most frames in a second, of whatever kind: twice the messages of the fastest glove. A client that sends more is
/// disconnected.
const MAX_FRAMES_PER_SECOND: u32 = 2000;

/// Messages that wait for the source. A client that is faster waits.
pub(in crate::capture::transport) const QUEUE_CAPACITY: usize = 64;

/// Pause before something is tried again that other threads make possible.
const RETRY_INTERVAL: Duration = Duration::from_millis(1);

/// Event of a client.
#[derive(Debug)]
pub(in crate::capture::transport) enum ClientEvent {
    /// A message, with a line end.
    Message(ClientId, Vec<u8>),
    /// A client that was admitted has left, for this reason.
    Left(ClientId, String),
}

/// Returns the limits of a connection.
pub(in crate::capture::transport) fn socket_config() -> WebSocketConfig {
    WebSocketConfig::default()
        // A client that reads no answers to its pings is disconnected.
        .write_buffer_size(0)
        .max_write_buffer_size(MAX_MESSAGE_BYTES)
        .max_message_size(Some(MAX_MESSAGE_BYTES))
        .max_frame_size(Some(MAX_MESSAGE_BYTES))
}

/// The receiver of the messages of a client.
pub(in crate::capture::transport) struct MessageReceiver<S> {
    socket: WebSocket<MessageStream<S>>,
    second: Instant,
    frames: u32,
    /// Longest silence of a client that has to answer.
    silence_limit: Option<Duration>,
    /// Time of the latest frame.
    heard_at: Instant,
    /// Time at which the client was asked for an answer, if it has sent no frame since.
    asked_at: Option<Instant>,
}

impl<S: Read + Write> MessageReceiver<S> {
    /// Creates it after the handshake.
    pub fn new(socket: WebSocket<MessageStream<S>>) -> Self {
        let now = Instant::now();
        Self {
            socket,
            second: now,
            frames: 0,
            silence_limit: None,
            heard_at: now,
            asked_at: None,
        }
    }

    /// Closes the connection of a client that sends nothing for this time: a connection outlives a network or a battery that fails. After
    /// half of the time the client gets a ping, which a browser answers by itself.
    #[cfg(feature = "tls")]
    pub fn limit_silence(&mut self, limit: Duration) {
        self.silence_limit = Some(limit);
    }

    /// Returns the connection, which a server of headsets writes to.
    #[cfg(feature = "tls")]
    pub fn socket_mut(&mut self) -> &mut WebSocket<MessageStream<S>> {
        &mut self.socket
    }

    /// Sends a text, which may be longer than all other messages, to a client that reads it within `timeout`. Fails with the reason.
    #[cfg(feature = "tls")]
    pub fn send(&mut self, text: String, timeout: Duration) -> Result<(), String> {
        let deadline = Instant::now() + timeout;
        let limit = self.socket.get_config().max_write_buffer_size;
        let limit_of_text = limit + text.len();
        self.socket
            .set_config(|config| config.max_write_buffer_size = limit_of_text);
        let mut sent = self.socket.send(Message::text(text));
        // A single write of the connection may take less time than a slow network needs.
        while let Err(tungstenite::Error::Io(error)) = &sent
            && is_idle(error.kind())
            && Instant::now() < deadline
        {
            sent = self.socket.flush();
        }
        self.socket
            .set_config(|config| config.max_write_buffer_size = limit);
        match sent {
            Err(tungstenite::Error::Io(error)) if is_idle(error.kind()) => Err(format!(
                "the client did not read an answer within {} s",
                timeout.as_secs()
            )),
            other => other.map_err(|error| error.to_string()),
        }
    }

    /// Passes the messages on, each with a line end, until `send` returns `false`. Returns the reason why the client has left.
    pub fn receive(
        &mut self,
        is_stopped: impl Fn() -> bool,
        mut send: impl FnMut(Vec<u8>) -> bool,
    ) -> String {
        while !is_stopped() {
            match self.next() {
                Ok(Some(line)) => {
                    if !send(line) {
                        break;
                    }
                }
                Ok(None) => {}
                Err(reason) => return reason,
            }
        }
        "the server stops".to_owned()
    }

    /// Waits for a frame. Returns the text of a message, with a line end; `None` if there was none, or another frame. Fails with the
    /// reason why the client leaves.
    pub fn next(&mut self) -> Result<Option<Vec<u8>>, String> {
        let message = match self.socket.read() {
            Ok(message) => message,
            Err(tungstenite::Error::Io(error)) if is_idle(error.kind()) => {
                self.check_silence()?;
                return Ok(None);
            }
            Err(tungstenite::Error::ConnectionClosed) => {
                return Err("the client has closed the connection".to_owned());
            }
            Err(error) => return Err(error.to_string()),
        };
        self.socket.get_mut().end_message();
        (self.heard_at, self.asked_at) = (Instant::now(), None);
        if self.second.elapsed() >= Duration::from_secs(1) {
            (self.second, self.frames) = (Instant::now(), 0);
        }
        self.frames += 1;
        if self.frames > MAX_FRAMES_PER_SECOND {
            return Err(format!(
                "the client sent more than {MAX_FRAMES_PER_SECOND} frames in a second"
            ));
        }
        match message {
            Message::Text(text) => {
                let mut line = Vec::from(text.as_bytes());
                if !line.ends_with(b"\n") {
                    line.push(b'\n');
                }
                Ok(Some(line))
            }
            Message::Binary(_) => {
                Err("the client sent a binary message; lines are text messages".to_owned())
            }
            _ => Ok(None),
        }
    }

    /// Sends a ping to a silent client. Fails with the reason if the client has not answered in time. The second half of the limit starts
    /// with the ping, so that a time in which this thread did not read does not count as silence of the client.
    fn check_silence(&mut self) -> Result<(), String> {
        let Some(limit) = self.silence_limit else {
            return Ok(());
        };
        match self.asked_at {
            Some(asked_at) if asked_at.elapsed() >= limit / 2 => Err(format!(
                "it has not answered for {} s; its network or its battery may have failed",
                limit.as_secs()
            )),
            None if self.heard_at.elapsed() >= limit / 2 => {
                self.asked_at = Some(Instant::now());
                match self.socket.send(Message::Ping(tungstenite::Bytes::new())) {
                    Err(tungstenite::Error::Io(error)) if is_idle(error.kind()) => Ok(()),
                    sent => sent.map_err(|error| error.to_string()),
                }
            }
            _ => Ok(()),
        }
    }
}

/// Sends an event, and waits for room while the client and its server are open. Returns `false` if one of them has ended.
pub(in crate::capture::transport) fn send_when_there_is_room(
    sender: &Sender<ClientEvent>,
    mut event: ClientEvent,
    is_open: impl Fn() -> bool,
) -> bool {
    while is_open() {
        match sender.try_send(event) {
            Ok(()) => return true,
            Err(TrySendError::Full(back)) => event = back,
            Err(TrySendError::Disconnected(_)) => return false,
        }
        thread::sleep(RETRY_INTERVAL);
    }
    false
}

#[cfg(all(test, feature = "tls"))]
mod tests {
    use std::io::{self, ErrorKind};

    use tungstenite::protocol::Role;

    use super::*;
    use crate::network::MemoryStream;

    /// A connection that takes 10 000 bytes at once, and none at every second try.
    #[derive(Default)]
    struct SlowStream {
        received: Vec<u8>,
        tries: usize,
    }

    impl Read for SlowStream {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(ErrorKind::WouldBlock.into())
        }
    }

    impl Write for SlowStream {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.tries += 1;
            if self.tries.is_multiple_of(2) {
                return Err(ErrorKind::WouldBlock.into());
            }
            let count = bytes.len().min(10_000);
            self.received.extend_from_slice(&bytes[..count]);
            Ok(count)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn receiver<S: Read + Write>(stream: S) -> MessageReceiver<S> {
        let stream = MessageStream::new(stream);
        let config = Some(socket_config());
        MessageReceiver::new(WebSocket::from_raw_socket(stream, Role::Server, config))
    }

    #[test]
    fn a_text_longer_than_all_messages_of_clients_arrives_whole_over_a_slow_connection() {
        let mut client = receiver(SlowStream::default());
        let text = "key ".repeat(MAX_MESSAGE_BYTES);
        client.send(text.clone(), Duration::from_secs(60)).unwrap();
        let received = &client.socket_mut().get_mut().stream_mut().received;
        // The head of such a frame has ten bytes.
        assert_eq!(received.len(), text.len() + 10);
        assert!(received.ends_with(text.as_bytes()));
    }

    #[test]
    fn a_client_that_reads_no_answer_is_given_up() {
        let mut client = receiver(MemoryStream::new(0));
        let reason = client.send("answer".to_owned(), Duration::ZERO);
        assert!(reason.unwrap_err().contains("did not read"));
    }

    #[test]
    fn a_client_that_has_to_answer_is_asked_in_its_silence_and_then_given_up() {
        let network = MemoryStream::new(100);
        let mut client = receiver(network.clone());
        assert_eq!(client.next(), Ok(None));
        assert!(
            network.take_received().is_empty(),
            "its silence has no limit"
        );

        client.limit_silence(Duration::ZERO);
        let ping: [u8; 2] = [0x89, 0];
        let pong: [u8; 6] = [0x8a, 0x80, 0, 0, 0, 0];
        for _ in 0..3 {
            assert_eq!(client.next(), Ok(None));
            assert_eq!(network.take_received(), ping);
            network.send(&pong);
            assert_eq!(client.next(), Ok(None), "the answer");
        }
        assert_eq!(client.next(), Ok(None));
        let reason = client.next().unwrap_err();
        assert!(reason.contains("has not answered"), "{reason}");
    }

    #[test]
    fn a_client_that_sends_is_not_asked_for_an_answer() {
        let network = MemoryStream::new(100);
        let mut client = receiver(network.clone());
        client.limit_silence(Duration::ZERO);
        network.send(&[0x81, 0x81, 0, 0, 0, 0, b'a']);
        assert_eq!(client.next(), Ok(Some(b"a\n".to_vec())));
        assert!(network.take_received().is_empty());
    }
}

//! A client of the server: its requests, and the messages that wait to be sent to it.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use arrayvec::ArrayVec;

use super::Axes;
use super::protocol::{ClientSettings, PACKET_BYTES, Packet, button_packet};
use ademan_core::time::Timestamp;

/// Longest time for which a client may not read.
const WRITE_TIMEOUT: Duration = Duration::from_secs(1);

/// Maximum number of messages that wait. Motion occupies one slot, as a later motion replaces it.
const QUEUE: usize = 64;

/// Longest period reported with a motion, in milliseconds: a client that multiplies by it must not jump after a pause.
const MAX_PERIOD_MS: u64 = 100;

enum Message {
    Motion(Axes, Timestamp),
    Packet(Packet),
    /// A number in the format of protocol version 0.
    Number(i32),
}

/// A connected client.
pub(super) struct Client {
    stream: UnixStream,
    settings: ClientSettings,
    received: ArrayVec<u8, PACKET_BYTES>,
    queue: VecDeque<Message>,
    /// The unsent bytes of the current message.
    sending: ArrayVec<u8, PACKET_BYTES>,
    last_motion: Option<Timestamp>,
    blocked_since: Option<Instant>,
    is_lost: bool,
}

impl Client {
    pub fn new(stream: UnixStream) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        Ok(Self {
            stream,
            settings: ClientSettings::default(),
            received: ArrayVec::new(),
            queue: VecDeque::new(),
            sending: ArrayVec::new(),
            last_motion: None,
            blocked_since: None,
            is_lost: false,
        })
    }

    /// Returns `true` if the client has disconnected or is to be disconnected.
    pub fn is_lost(&self) -> bool {
        self.is_lost
    }

    /// Returns `true` if messages wait to be sent.
    pub fn has_messages(&self) -> bool {
        !(self.is_lost || self.queue.is_empty() && self.sending.is_empty())
    }

    /// Returns the time at which the client is disconnected unless it reads.
    pub fn deadline(&self) -> Option<Instant> {
        self.blocked_since.map(|since| since + WRITE_TIMEOUT)
    }

    /// Queues a motion. It replaces a motion at the end of the queue.
    pub fn queue_motion(&mut self, axes: Axes, time: Timestamp) {
        if !self.settings.wants_motion() {
            return;
        }
        match self.queue.back_mut() {
            Some(Message::Motion(last_axes, last_time)) => (*last_axes, *last_time) = (axes, time),
            _ => self.queue_message(Message::Motion(axes, time)),
        }
    }

    /// Queues a button event.
    pub fn queue_button(&mut self, number: usize, is_pressed: bool) {
        if self.settings.wants_buttons() {
            self.queue_message(Message::Packet(button_packet(number, is_pressed)));
        }
    }

    fn queue_message(&mut self, message: Message) {
        if self.queue.len() == QUEUE {
            return self.disconnect();
        }
        self.queue.push_back(message);
    }

    fn disconnect(&mut self) {
        if !self.is_lost {
            tracing::warn!("disconnected a spacenav client that does not read");
        }
        self.is_lost = true;
    }

    /// Reads at most one packet, so that no client occupies the server, and replies to it. `path` is the path
    /// of the socket.
    pub fn receive(&mut self, path: &str) {
        let mut bytes = [0; PACKET_BYTES];
        match self.stream.read(&mut bytes[self.received.len()..]) {
            Err(error) if is_transient(&error) => return,
            Ok(0) | Err(_) => return self.is_lost = true,
            Ok(count) => {
                let start = self.received.len();
                self.received
                    .extend(bytes[start..start + count].iter().copied());
            }
        }
        while self.received.len() >= self.settings.request_bytes() {
            let mut request = [0; 8];
            let length = self.settings.request_bytes();
            let numbers = self.received[..length].as_chunks::<4>().0;
            for (number, word) in request.iter_mut().zip(numbers) {
                *number = i32::from_ne_bytes(*word);
            }
            self.received.drain(..length);
            self.reply(request, length, path);
        }
    }

    fn reply(&mut self, request: Packet, length: usize, path: &str) {
        if length < PACKET_BYTES {
            if let Some(number) = self.settings.reply_to_number(request[0]) {
                self.queue_message(Message::Number(number));
            }
            return;
        }
        for packet in self.settings.reply_to_packet(request, path) {
            self.queue_message(Message::Packet(packet));
        }
    }

    /// Writes as much as the socket accepts. Disconnects the client if it has read nothing for 1 s.
    pub fn flush(&mut self, now: Instant) {
        while self.has_messages() {
            if self.sending.is_empty() {
                self.encode_next();
            }
            match self.stream.write(&self.sending) {
                Ok(count) => {
                    self.sending.drain(..count);
                    self.blocked_since = None;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if is_transient(&error) => {
                    self.blocked_since.get_or_insert(now);
                    if self.deadline().is_some_and(|deadline| now >= deadline) {
                        self.disconnect();
                    }
                    return;
                }
                Err(_) => self.is_lost = true,
            }
        }
    }

    fn encode_next(&mut self) {
        let packet = match self.queue.pop_front() {
            None => return,
            Some(Message::Number(number)) => return self.sending.extend(number.to_ne_bytes()),
            Some(Message::Packet(packet)) => packet,
            Some(Message::Motion(axes, time)) => {
                let previous = self.last_motion.replace(time).unwrap_or(time);
                let period_ms = time.0.saturating_sub(previous.0) / 1000;
                let period_ms = period_ms.clamp(1, MAX_PERIOD_MS) as i32;
                self.settings.motion_packet(axes, period_ms)
            }
        };
        self.sending
            .extend(packet.into_iter().flat_map(i32::to_ne_bytes));
    }
}

impl AsFd for Client {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.stream.as_fd()
    }
}

/// Returns `true` if the call may succeed later.
fn is_transient(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

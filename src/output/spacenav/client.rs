//! One client of the server: what it says, and what waits to be told to it.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use arrayvec::ArrayVec;

use super::Axes;
use super::protocol::{ClientSettings, LENGTH, Packet, button};
use crate::time::Timestamp;

/// How long a client may take nothing of what is told to it.
const PATIENCE: Duration = Duration::from_secs(1);

/// What waits for a client at most. Motion takes one place at a time: the latest.
const QUEUE: usize = 64;

/// The longest time since the last motion that a client is told: one that multiplies by it is not to jump
/// after a rest.
const LONGEST_PERIOD_MS: u64 = 100;

enum Told {
    Motion(Axes, Timestamp),
    Packet(Packet),
    Word(i32),
}

/// A client, connected.
pub(super) struct Client {
    stream: UnixStream,
    terms: ClientSettings,
    heard: ArrayVec<u8, LENGTH>,
    waiting: VecDeque<Told>,
    /// The bytes of what is being told.
    going: ArrayVec<u8, LENGTH>,
    moved: Option<Timestamp>,
    stuck_since: Option<Instant>,
    is_lost: bool,
}

impl Client {
    pub fn new(stream: UnixStream) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        Ok(Self {
            stream,
            terms: ClientSettings::default(),
            heard: ArrayVec::new(),
            waiting: VecDeque::new(),
            going: ArrayVec::new(),
            moved: None,
            stuck_since: None,
            is_lost: false,
        })
    }

    /// Whether it has gone away or was given up.
    pub fn is_lost(&self) -> bool {
        self.is_lost
    }

    /// Whether something waits to be told to it.
    pub fn is_waiting(&self) -> bool {
        !(self.is_lost || self.waiting.is_empty() && self.going.is_empty())
    }

    /// When it will be given up, if it takes nothing until then.
    pub fn deadline(&self) -> Option<Instant> {
        self.stuck_since.map(|since| since + PATIENCE)
    }

    /// Tells it where the axes stand; what it was not yet told of them it will not hear.
    pub fn tell_motion(&mut self, axes: Axes, time: Timestamp) {
        if !self.terms.has_motion() {
            return;
        }
        match self.waiting.back_mut() {
            Some(Told::Motion(latest, at)) => (*latest, *at) = (axes, time),
            _ => self.tell(Told::Motion(axes, time)),
        }
    }

    /// Tells it of a button.
    pub fn tell_button(&mut self, number: usize, is_down: bool) {
        if self.terms.has_buttons() {
            self.tell(Told::Packet(button(number, is_down)));
        }
    }

    fn tell(&mut self, told: Told) {
        if self.waiting.len() == QUEUE {
            return self.give_up();
        }
        self.waiting.push_back(told);
    }

    fn give_up(&mut self) {
        if !self.is_lost {
            tracing::warn!("a spacenav client that does not read was cut off");
        }
        self.is_lost = true;
    }

    /// Takes what it says, a packet at most, so that no client has the server for itself.
    pub fn hear(&mut self, path: &str) {
        let mut bytes = [0; LENGTH];
        match self.stream.read(&mut bytes[self.heard.len()..]) {
            Err(error) if is_passing(&error) => return,
            Ok(0) | Err(_) => return self.is_lost = true,
            Ok(count) => {
                let start = self.heard.len();
                self.heard
                    .extend(bytes[start..start + count].iter().copied());
            }
        }
        while self.heard.len() >= self.terms.length_heard() {
            let mut numbers = [0; 8];
            let length = self.terms.length_heard();
            for (number, bytes) in numbers
                .iter_mut()
                .zip(self.heard[..length].as_chunks::<4>().0)
            {
                *number = i32::from_ne_bytes(*bytes);
            }
            self.heard.drain(..length);
            self.reply(numbers, length, path);
        }
    }

    fn reply(&mut self, numbers: Packet, length: usize, path: &str) {
        if length < LENGTH {
            if let Some(word) = self.terms.hear(numbers[0]) {
                self.tell(Told::Word(word));
            }
            return;
        }
        for packet in self.terms.answer(numbers, path) {
            self.tell(Told::Packet(packet));
        }
    }

    /// Tells it as much as it takes at once; gives it up when it has taken nothing for a second.
    pub fn flush(&mut self, now: Instant) {
        while self.is_waiting() {
            if self.going.is_empty() {
                self.take_up();
            }
            match self.stream.write(&self.going) {
                Ok(count) => {
                    self.going.drain(..count);
                    self.stuck_since = None;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if is_passing(&error) => {
                    self.stuck_since.get_or_insert(now);
                    if self.deadline().is_some_and(|deadline| now >= deadline) {
                        self.give_up();
                    }
                    return;
                }
                Err(_) => self.is_lost = true,
            }
        }
    }

    /// Makes bytes of what is to be told next.
    fn take_up(&mut self) {
        let packet = match self.waiting.pop_front() {
            None => return,
            Some(Told::Word(word)) => return self.going.extend(word.to_ne_bytes()),
            Some(Told::Packet(packet)) => packet,
            Some(Told::Motion(axes, time)) => {
                let before = self.moved.replace(time).unwrap_or(time);
                let since_ms = time.0.saturating_sub(before.0) / 1000;
                let period = since_ms.clamp(1, LONGEST_PERIOD_MS) as i32;
                self.terms.motion(axes, period)
            }
        };
        self.going
            .extend(packet.into_iter().flat_map(i32::to_ne_bytes));
    }
}

impl AsFd for Client {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.stream.as_fd()
    }
}

/// Whether it is worth another try later.
fn is_passing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

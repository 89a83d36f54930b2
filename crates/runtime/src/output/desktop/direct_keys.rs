//! Key events that the loop writes to a display itself, which saves them a wake-up of the thread of the output.
//!
//! The loop writes to a connection of its own, never waits, and only writes while the thread has nothing to do, so that
//! events keep their order. The thread reads the answers. If the display has not executed a press when it is too old, the
//! thread closes the connection, which revokes the press.

use std::time::Instant;

use crossbeam_channel::{Receiver, Sender, bounded};

use super::injector::WindowId;
use super::key_reporter::KeyReporter;
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::KeyDirection;

/// The loop's end of a connection. Dropping it closes the connection.
pub trait KeyWriter: Send {
    /// Presses or releases `key` without waiting. Returns `false` if nothing was written.
    fn write(&mut self, key: KeyCode, direction: KeyDirection) -> bool;
}

/// The thread's end of a connection. Dropping it closes the connection: the display does not execute requests that it has not read.
pub trait AnswerReader: Send {
    /// Waits until the display has executed the next key event. Returns `false` if it has not by `deadline`, or if the
    /// connection is closed.
    fn wait_for_answer(&mut self, deadline: Instant) -> bool;

    /// Returns the window that had the focus at the last answer, if the display has reported it.
    fn focus(&self) -> Option<WindowId> {
        None
    }

    /// Discards what the display has sent beside answers. Returns `false` if the connection is closed.
    fn discard_events(&mut self) -> bool;
}

/// Both ends of a connection.
pub type DirectConnection = (Box<dyn KeyWriter>, Box<dyn AnswerReader>);

/// The number of a connection; the thread opens another one after it has revoked a press.
pub type ConnectionNumber = u64;

/// The loop's end of the present connection, with the reports of its presses.
pub struct DirectKeys {
    number: ConnectionNumber,
    writer: Box<dyn KeyWriter>,
    reporter: KeyReporter,
}

impl DirectKeys {
    /// Returns `false` if the watchdog may have released keys without the knowledge of this process.
    pub fn may_press(&self, now: Instant) -> bool {
        self.reporter.has_fresh_reply(now)
    }

    /// Writes a key event. Returns the number of the connection, or `None` if nothing was written.
    pub fn write(&mut self, key: KeyCode, direction: KeyDirection) -> Option<ConnectionNumber> {
        let is_press = direction == KeyDirection::Press;
        // The watchdog could not release a key that it does not know.
        if is_press && !self.reporter.report(key, direction) {
            return None;
        }
        let is_written = self.writer.write(key, direction);
        if is_press && !is_written {
            // The thread may drop the press, and would then not report its release.
            self.reporter.report(key, KeyDirection::Release);
        }
        is_written.then_some(self.number)
    }
}

/// The thread's end of the present connection, if there is one.
pub struct DirectAnswers {
    reader: Option<Box<dyn AnswerReader>>,
    number: ConnectionNumber,
    /// `true` if the display has opened every connection so far.
    is_supported: bool,
    to_loop: Sender<DirectKeys>,
    /// The other end of that channel, to remove what the loop has not received.
    not_received: Receiver<DirectKeys>,
}

impl DirectAnswers {
    /// Creates it without a connection, and the channel on which the loop receives its ends.
    pub fn new() -> (Self, Receiver<DirectKeys>) {
        let (to_loop, from_thread) = bounded(1);
        let answers = Self {
            reader: None,
            number: 0,
            is_supported: true,
            to_loop,
            not_received: from_thread.clone(),
        };
        (answers, from_thread)
    }

    /// Opens a connection with `connect`, and passes the other end to the loop, unless the display supports none or the loop
    /// would have to wait for its reports.
    pub fn open(
        &mut self,
        connect: impl FnOnce() -> Option<DirectConnection>,
        reporter: &KeyReporter,
    ) {
        if !self.is_supported || reporter.may_wait() {
            return;
        }
        let Some((writer, reader)) = connect() else {
            self.is_supported = false;
            return;
        };
        self.number += 1;
        let keys = DirectKeys {
            number: self.number,
            writer,
            reporter: reporter.clone(),
        };
        // The end of an earlier connection would fill the channel.
        let _ = self.not_received.try_recv();
        if self.to_loop.try_send(keys).is_ok() {
            self.reader = Some(reader);
        }
    }

    /// Discards what the display has sent beside answers, and opens a connection unless one is open: the loop or the display
    /// may have closed it.
    pub fn refresh(
        &mut self,
        connect: impl FnOnce() -> Option<DirectConnection>,
        reporter: &KeyReporter,
    ) {
        let is_open = |reader: &mut Box<dyn AnswerReader>| reader.discard_events();
        if !self.reader.as_mut().is_some_and(is_open) {
            self.close();
            self.open(connect, reporter);
        }
    }

    /// Waits until the display has executed an event that was written to this connection. If it has not by `deadline`,
    /// closes the connection and returns `false`.
    pub fn wait(&mut self, connection: ConnectionNumber, deadline: Instant) -> bool {
        if connection != self.number {
            return false;
        }
        let reader = self.reader.as_mut();
        let is_executed = reader.is_some_and(|reader| reader.wait_for_answer(deadline));
        if !is_executed {
            self.close();
        }
        is_executed
    }

    /// Returns the window that had the focus at the last answer, if the display has reported it.
    pub fn focus(&self) -> Option<WindowId> {
        self.reader.as_ref().and_then(|reader| reader.focus())
    }

    /// Closes the connection.
    pub fn close(&mut self) {
        self.reader = None;
    }
}

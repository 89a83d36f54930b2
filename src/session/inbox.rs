//! One place for all that a run hears from outside.
//!
//! The loop parks until an arrival or a command unparks it. To wait for several channels at once instead would take
//! a lock of each, also for every reading.

use std::io;
use std::thread::{self, Thread};

use crossbeam_channel::{Receiver, Sender, bounded, never, select};

use super::{Call, Commands, Replacement};

/// What a run is told.
pub(super) enum Message {
    /// To end.
    Stop,
    /// To put other controls in force.
    Replace(Replacement),
    /// To do something and answer.
    Call(Call),
}

/// Where messages come out, until it is dropped.
pub(super) struct Inbox {
    messages: Receiver<Message>,
    _end: Sender<()>,
}

impl Inbox {
    /// Passes on what comes in, on a thread of its own, and unparks the one that calls this.
    pub fn open(commands: Commands) -> io::Result<Self> {
        let (sender, messages) = bounded(1);
        let (end, ended) = bounded(0);
        let waiter = thread::current();
        thread::Builder::new()
            .name("commands".into())
            .spawn(move || pass_on(commands, &ended, &sender, &waiter))?;
        Ok(Self {
            messages,
            _end: end,
        })
    }

    /// The next message, if there is one.
    pub fn take(&self) -> Option<Message> {
        self.messages.try_recv().ok()
    }
}

fn pass_on(
    mut commands: Commands,
    ended: &Receiver<()>,
    messages: &Sender<Message>,
    waiter: &Thread,
) {
    loop {
        let message = select! {
            recv(ended) -> _ => return,
            // Whoever could ask for an end is gone, and so nobody could end it.
            recv(commands.stop) -> _ => {
                commands.stop = never();
                Message::Stop
            }
            recv(commands.replace) -> replacement => match replacement {
                Ok(replacement) => Message::Replace(replacement),
                // Nobody can send any more; a closed channel would wake this for ever.
                Err(_) => {
                    commands.replace = never();
                    continue;
                }
            },
            recv(commands.calls) -> call => match call {
                Ok(call) => Message::Call(call),
                Err(_) => {
                    commands.calls = never();
                    continue;
                }
            },
        };
        let is_heard = select! {
            send(messages, message) -> sent => sent.is_ok(),
            recv(ended) -> _ => false,
        };
        if !is_heard {
            return;
        }
        waiter.unpark();
    }
}

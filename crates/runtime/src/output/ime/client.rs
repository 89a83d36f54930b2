//! Requests of the loop to the thread of an input method, and state that both share; neither waits for the other.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use arrayvec::ArrayVec;
use crossbeam_channel::{Receiver, Sender, bounded};

use super::ibus;
use crate::output::text_field::{FocusedField, Text};
use ademan_core::pipeline::press_filter::{CandidateText, MAX_CANDIDATES};

/// Capacity of the queue of requests: the parts of some steps.
const QUEUE: usize = 256;

/// Longest time that [`Client::close`] waits for the thread.
const CLOSE_TIMEOUT: Duration = Duration::from_millis(500);

/// Candidates for the open word.
pub(super) type Candidates = ArrayVec<CandidateText, MAX_CANDIDATES>;

/// A request of the loop.
pub(super) struct Request {
    pub action: Action,
    /// The field for which the text was typed: another one does not get it.
    pub field: u32,
    /// The key presses that the output of keys got before: the text follows them.
    pub after_presses: u32,
    /// The number of stops before it: later stops make it void.
    pub stops: u32,
}

/// An action of the thread.
#[derive(Debug, PartialEq)]
pub(super) enum Action {
    /// Shows a word in the field.
    Show(Text),
    /// Puts text into the field in place of the shown word.
    Commit(Text),
    /// Lists candidates beside the field; none hides them.
    List(Candidates),
}

/// State that both sides read and write.
#[derive(Default)]
pub(super) struct Shared {
    pub field: Arc<FocusedField>,
    /// The number of the candidate that was chosen; 0 for none.
    choice: AtomicU8,
    /// The key presses that the output of keys got.
    presses: AtomicU32,
    stops: AtomicU32,
}

impl Shared {
    /// Reports the choice of a candidate, counted from 1.
    pub(super) fn choose(&self, number: u8) {
        self.choice.store(number, Ordering::Release);
    }

    /// Returns the candidate that was chosen since the last call.
    pub(super) fn take_choice(&self) -> Option<u8> {
        // Without a write in every turn of the loop.
        if self.choice.load(Ordering::Relaxed) == 0 {
            return None;
        }
        Some(self.choice.swap(0, Ordering::Acquire)).filter(|number| *number > 0)
    }

    /// Counts a key press, and returns the number of presses so far.
    pub(super) fn count_press(&self) -> u32 {
        self.presses.fetch_add(1, Ordering::AcqRel).wrapping_add(1)
    }

    pub(super) fn presses(&self) -> u32 {
        self.presses.load(Ordering::Acquire)
    }

    /// Makes all requests so far void.
    pub(super) fn stop(&self) {
        self.stops.fetch_add(1, Ordering::AcqRel);
    }

    pub(super) fn stops(&self) -> u32 {
        self.stops.load(Ordering::Acquire)
    }
}

/// The thread of an input method, as the loop uses it.
pub(super) struct Client {
    requests: Option<Sender<Request>>,
    shared: Arc<Shared>,
    /// The key presses for the output of keys so far.
    presses: u32,
    thread: Option<JoinHandle<()>>,
    ended: Receiver<()>,
}

impl Client {
    /// Starts the thread, which reports the field that has the focus, and waits until it is connected.
    pub(super) fn start(field: Arc<FocusedField>) -> Result<Self, String> {
        let (requests, queue) = bounded(QUEUE);
        let (end, ended) = bounded(0);
        let shared = Arc::new(Shared {
            field,
            ..Shared::default()
        });
        let thread = ibus::start(queue, Arc::clone(&shared), end)?;
        Ok(Self {
            requests: Some(requests),
            shared,
            presses: 0,
            thread: Some(thread),
            ended,
        })
    }

    /// Requests an action for the field of this generation. Returns `false` if the queue is full.
    pub(super) fn request(&self, action: Action, field: u32) -> bool {
        let request = Request {
            action,
            field,
            after_presses: self.presses,
            stops: self.shared.stops(),
        };
        let requests = self.requests.as_ref();
        requests.is_some_and(|requests| requests.try_send(request).is_ok())
    }

    /// Counts a key press that the output of keys gets: later text follows it.
    pub(super) fn count_press(&mut self) {
        self.presses = self.shared.count_press();
    }

    /// Makes all requests so far void.
    pub(super) fn stop(&self) {
        self.shared.stop();
    }

    /// Returns the candidate that was chosen since the last call.
    pub(super) fn take_choice(&self) -> Option<u8> {
        self.shared.take_choice()
    }

    /// Lets the thread execute what was requested, and ends it. A daemon that hangs keeps its thread.
    pub(super) fn close(&mut self) {
        drop(self.requests.take());
        let ended = self.ended.recv_timeout(CLOSE_TIMEOUT);
        if ended.is_err_and(|error| error.is_disconnected())
            && let Some(thread) = self.thread.take()
        {
            let _ = thread.join();
        }
    }
}

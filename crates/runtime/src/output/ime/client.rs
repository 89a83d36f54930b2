//! Requests of the loop to the thread of an input method, and state that both share; neither waits for the other.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use arrayvec::ArrayVec;
use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

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
    /// The number of stops before it: later stops make its text void.
    pub stops: u32,
}

/// An action of the thread.
#[derive(Debug, PartialEq)]
pub(super) enum Action {
    /// Shows a word in the field.
    Show(Text),
    /// Replaces the shown word in the field by text.
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
    /// Number of characters of text that no field has taken.
    dropped_characters: AtomicU64,
}

impl Shared {
    /// Returns `true` if a request is for the field that has the focus, and no stop has made it void. Otherwise counts its text as
    /// dropped. A stop makes no list void: without the request that hides a list, the list would stay.
    pub(super) fn accepts(&self, request: &Request) -> bool {
        let is_list = matches!(request.action, Action::List(_));
        let is_void = !is_list && request.stops != self.stops();
        let is_accepted = !is_void && request.field == self.field.get().generation;
        if !is_accepted {
            self.drop_text(&request.action);
        }
        is_accepted
    }

    /// Counts the text of an action that is not executed as dropped.
    pub(super) fn drop_text(&self, action: &Action) {
        if let Action::Commit(text) = action {
            let characters = text.chars().count() as u64;
            self.dropped_characters
                .fetch_add(characters, Ordering::Relaxed);
        }
    }

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

    /// Requests an action for the field of this generation. If the queue is full, counts its text as dropped.
    pub(super) fn request(&self, action: Action, field: u32) {
        let request = Request {
            action,
            field,
            after_presses: self.presses,
            stops: self.shared.stops(),
        };
        let Some(requests) = &self.requests else {
            return self.shared.drop_text(&request.action);
        };
        if let Err(TrySendError::Full(lost) | TrySendError::Disconnected(lost)) =
            requests.try_send(request)
        {
            self.shared.drop_text(&lost.action);
        }
    }

    /// Returns the number of characters of text that no field has taken.
    pub(super) fn dropped_characters(&self) -> u64 {
        self.shared.dropped_characters.load(Ordering::Relaxed)
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

    /// Ends the thread after it has executed all requests. The thread remains if the daemon hangs.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::FieldKind;

    fn request(shared: &Shared, action: Action) -> Request {
        Request {
            action,
            field: shared.field.get().generation,
            after_presses: 0,
            stops: shared.stops(),
        }
    }

    fn text(text: &str) -> Text {
        Text::from(text).unwrap()
    }

    #[test]
    fn text_of_before_a_stop_or_for_another_field_is_counted_as_dropped() {
        let shared = Shared::default();
        let requests = [
            Action::Commit(text("señal ")),
            Action::Show(text("wor")),
            Action::List(Candidates::new()),
        ]
        .map(|action| request(&shared, action));
        assert!(requests.iter().all(|request| shared.accepts(request)));
        let dropped = || shared.dropped_characters.load(Ordering::Relaxed);
        assert_eq!(dropped(), 0);
        shared.stop();
        let after_the_stop = requests.each_ref().map(|request| shared.accepts(request));
        assert_eq!(after_the_stop, [false, false, true]);
        assert_eq!(dropped(), 6, "a word that is shown is committed later");
        let of_a_field = request(&shared, Action::Commit(text("ok")));
        shared.field.enter(FieldKind::Text);
        assert!(!shared.accepts(&of_a_field));
        assert_eq!(dropped(), 8);
    }

    #[test]
    fn text_that_finds_no_room_in_the_queue_is_counted_as_dropped() {
        let (requests, queue) = bounded(1);
        let client = Client {
            requests: Some(requests),
            shared: Arc::default(),
            presses: 0,
            thread: None,
            ended: crossbeam_channel::never(),
        };
        for _ in 0..2 {
            client.request(Action::Commit(text("it ")), 0);
        }
        assert_eq!(client.dropped_characters(), 3);
        drop(queue);
        client.request(Action::Commit(text("is ")), 0);
        assert_eq!(client.dropped_characters(), 6);
    }
}

//! What happens in a run → a queue for each client that asked for it.
//!
//! The loop hands over what it has if there is room, and never waits. A thread of the server's own
//! makes lines of it; a client that does not read them loses the oldest.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

use super::response::{self, JsonLine};
use crate::contact::TargetNames;
use crate::device::Events;
use crate::pipeline::PipelineState;
use crate::session::reload::LayoutReport;
use crate::snapshot::Snapshot;

/// Frames with news that wait for the thread that makes lines of them.
const WAITING_NEWS: usize = 64;

/// Lines that wait for a client to read them.
const WAITING_LINES: usize = 64;

// A box would be an allocation in the loop.
#[allow(clippy::large_enum_variant)]
enum Notification {
    Events(Events, TargetNames),
    State {
        state: PipelineState,
        is_paused: bool,
    },
    Reload {
        in_force: bool,
        text: String,
    },
}

/// The end of the way that a run has: takes what happens.
#[derive(Clone)]
pub struct Notifier {
    news: Sender<Notification>,
    subscribers: Subscribers,
    last: Option<(PipelineState, bool)>,
}

impl Notifier {
    /// A reporter without subscribers, and what [`tell_all`] tells them.
    pub(super) fn new() -> (Self, NotificationQueue) {
        let (sender, news) = bounded(WAITING_NEWS);
        let subscribers = Subscribers::default();
        let reporter = Self {
            news: sender,
            subscribers: subscribers.clone(),
            last: None,
        };
        (reporter, NotificationQueue { news, subscribers })
    }

    /// Takes a frame; does not wait, and does nothing where nobody has subscribed.
    pub fn notify_snapshot(&mut self, frame: &Snapshot) {
        let (state, is_paused) = (frame.state, frame.is_paused);
        let is_new = self.last.replace((state, is_paused)) != Some((state, is_paused));
        if self.subscribers.count.load(Ordering::Relaxed) == 0 {
            return;
        }
        if !frame.events.is_empty() {
            self.send(Notification::Events(
                frame.events.clone(),
                frame.target_names.clone(),
            ));
        }
        if is_new {
            self.send(Notification::State { state, is_paused });
        }
    }

    /// Takes what became of a layout file.
    pub fn notify_reload(&mut self, report: &LayoutReport) {
        self.send(Notification::Reload {
            in_force: matches!(report, LayoutReport::Activated(_)),
            text: report.to_string(),
        });
    }

    fn send(&self, news: Notification) {
        let lines = match &news {
            Notification::Events(events, _) => events.len() as u64,
            _ => 1,
        };
        if self.news.try_send(news).is_err() {
            self.subscribers.missed.fetch_add(lines, Ordering::Relaxed);
        }
    }
}

/// The other end of the way.
pub(super) struct NotificationQueue {
    news: Receiver<Notification>,
    pub subscribers: Subscribers,
}

/// Makes lines of news and hands them to all subscribers, until no reporter is left.
pub(super) fn broadcast(untold: &NotificationQueue) {
    let mut buffer = Vec::new();
    let subscribers = &untold.subscribers;
    for news in &untold.news {
        let missed = subscribers.missed.swap(0, Ordering::Relaxed);
        if missed > 0 {
            subscribers.miss(missed);
        }
        match news {
            Notification::Events(events, names) => {
                for event in &events {
                    subscribers.put(&response::event_notification(event, &names, &mut buffer));
                }
            }
            Notification::State { state, is_paused } => {
                subscribers.put(&response::state_notification(state, is_paused));
            }
            Notification::Reload { in_force, text } => {
                subscribers.put(&response::reload_notification(in_force, &text));
            }
        }
    }
}

/// The queues of all clients that have subscribed.
#[derive(Clone, Default)]
pub(super) struct Subscribers {
    /// What the loop looks at instead of the list, so that it waits for no lock.
    count: Arc<AtomicUsize>,
    /// Lines that the loop could not hand over.
    missed: Arc<AtomicU64>,
    queues: Arc<Mutex<Vec<SubscriberQueue>>>,
}

impl Subscribers {
    /// A queue that is filled until it is dropped.
    pub fn add(&self) -> Subscription {
        let (sender, lines) = bounded(WAITING_LINES);
        let missed = Arc::new(AtomicU64::new(0));
        let subscription = Subscription {
            lines: lines.clone(),
            missed: missed.clone(),
        };
        let queue = SubscriberQueue {
            sender,
            oldest: lines,
            missed: Arc::downgrade(&missed),
        };
        self.with_queues(|queues| queues.push(queue));
        subscription
    }

    fn put(&self, line: &JsonLine) {
        self.with_queues(|queues| queues.retain(|queue| queue.put(line)));
    }

    fn miss(&self, count: u64) {
        self.with_queues(|queues| {
            for queue in queues {
                queue.miss(count);
            }
        });
    }

    fn with_queues(&self, change: impl FnOnce(&mut Vec<SubscriberQueue>)) {
        let mut queues = self.queues.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut queues);
        self.count.store(queues.len(), Ordering::Relaxed);
    }
}

/// The server's end of a queue.
struct SubscriberQueue {
    sender: Sender<JsonLine>,
    /// Where the oldest line is taken out when there is no room.
    oldest: Receiver<JsonLine>,
    missed: Weak<AtomicU64>,
}

impl SubscriberQueue {
    /// Puts a line in, if need be in the place of the oldest; whether anybody takes it out.
    fn put(&self, line: &JsonLine) -> bool {
        let mut line = line.clone();
        while let Err(TrySendError::Full(back)) = self.sender.try_send(line) {
            line = back;
            if self.oldest.try_recv().is_ok() {
                self.miss(1);
            }
        }
        self.missed.strong_count() > 0
    }

    fn miss(&self, count: u64) {
        if let Some(missed) = self.missed.upgrade() {
            missed.fetch_add(count, Ordering::Relaxed);
        }
    }
}

/// The client's end of a queue.
pub(super) struct Subscription {
    /// Lines of news, the oldest first.
    pub lines: Receiver<JsonLine>,
    missed: Arc<AtomicU64>,
}

impl Subscription {
    /// How many lines were lost since this was last asked.
    pub fn take_missed(&self) -> u64 {
        self.missed.swap(0, Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_queue_that_nobody_reads_loses_the_oldest_lines_and_counts_them() {
        let subscribers = Subscribers::default();
        let subscription = subscribers.add();
        for number in 0..WAITING_LINES + 3 {
            subscribers.put(&number.to_string().into());
        }
        assert_eq!(subscription.take_missed(), 3);
        assert_eq!(subscription.take_missed(), 0);
        let lines: Vec<_> = subscription.lines.try_iter().collect();
        assert_eq!(lines.len(), WAITING_LINES);
        assert_eq!(&*lines[0], "3");
    }

    #[test]
    fn a_queue_whose_client_went_away_is_gone_after_the_next_line() {
        let subscribers = Subscribers::default();
        let stays = subscribers.add();
        drop(subscribers.add());
        subscribers.put(&"a".into());
        assert_eq!(subscribers.count.load(Ordering::Relaxed), 1);
        assert_eq!(stays.lines.len(), 1);
    }

    #[test]
    fn a_report_is_told_in_order_with_what_the_loop_could_not_hand_over() {
        let (mut reporter, untold) = Notifier::new();
        let subscription = untold.subscribers.add();
        for _ in 0..WAITING_NEWS + 2 {
            reporter.notify_reload(&LayoutReport::Rejected("no".into()));
        }
        drop(reporter);
        broadcast(&untold);
        assert_eq!(subscription.take_missed(), 2);
        let line = subscription.lines.try_recv().unwrap();
        assert_eq!(&*line, r#"{"event":"reload","in_force":false,"text":"no"}"#);
    }
}

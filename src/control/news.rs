//! What happens in a run → a queue for each client that asked for it.
//!
//! The loop hands over what it has if there is room, and never waits. A thread of the server's own
//! makes lines of it; a client that does not read them loses the oldest.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

use super::answer::{self, Line};
use crate::contact::TargetNames;
use crate::device::Events;
use crate::monitor::{Snapshot, State};
use crate::reload::Report;

/// Frames with news that wait for the thread that makes lines of them.
const WAITING_NEWS: usize = 64;

/// Lines that wait for a client to read them.
const WAITING_LINES: usize = 64;

// A box would be an allocation in the loop.
#[allow(clippy::large_enum_variant)]
enum News {
    Events(Events, TargetNames),
    State { state: State, is_paused: bool },
    Reload { in_force: bool, text: String },
}

/// The end of the way that a run has: takes what happens.
#[derive(Clone)]
pub struct Reporter {
    news: Sender<News>,
    subscribers: Subscribers,
    last: Option<(State, bool)>,
}

impl Reporter {
    /// A reporter without subscribers, and what [`tell_all`] tells them.
    pub(super) fn new() -> (Self, Untold) {
        let (sender, news) = bounded(WAITING_NEWS);
        let subscribers = Subscribers::default();
        let reporter = Self {
            news: sender,
            subscribers: subscribers.clone(),
            last: None,
        };
        (reporter, Untold { news, subscribers })
    }

    /// Takes a frame; does not wait, and does nothing where nobody has subscribed.
    pub fn show(&mut self, frame: &Snapshot) {
        let (state, is_paused) = (frame.state, frame.is_paused);
        let is_new = self.last.replace((state, is_paused)) != Some((state, is_paused));
        if self.subscribers.count.load(Ordering::Relaxed) == 0 {
            return;
        }
        if !frame.events.is_empty() {
            self.tell(News::Events(frame.events.clone(), frame.names.clone()));
        }
        if is_new {
            self.tell(News::State { state, is_paused });
        }
    }

    /// Takes what became of a layout file.
    pub fn report(&mut self, report: &Report) {
        self.tell(News::Reload {
            in_force: matches!(report, Report::Replaced(_)),
            text: report.to_string(),
        });
    }

    fn tell(&self, news: News) {
        let lines = match &news {
            News::Events(events, _) => events.len() as u64,
            _ => 1,
        };
        if self.news.try_send(news).is_err() {
            self.subscribers.missed.fetch_add(lines, Ordering::Relaxed);
        }
    }
}

/// The other end of the way.
pub(super) struct Untold {
    news: Receiver<News>,
    pub subscribers: Subscribers,
}

/// Makes lines of news and hands them to all subscribers, until no reporter is left.
pub(super) fn tell_all(untold: &Untold) {
    let mut buffer = Vec::new();
    let subscribers = &untold.subscribers;
    for news in &untold.news {
        let missed = subscribers.missed.swap(0, Ordering::Relaxed);
        if missed > 0 {
            subscribers.miss(missed);
        }
        match news {
            News::Events(events, names) => {
                for event in &events {
                    subscribers.put(&answer::event_news(event, &names, &mut buffer));
                }
            }
            News::State { state, is_paused } => {
                subscribers.put(&answer::state_news(state, is_paused));
            }
            News::Reload { in_force, text } => {
                subscribers.put(&answer::reload_news(in_force, &text));
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
    queues: Arc<Mutex<Vec<Queue>>>,
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
        let queue = Queue {
            sender,
            oldest: lines,
            missed: Arc::downgrade(&missed),
        };
        self.with_queues(|queues| queues.push(queue));
        subscription
    }

    fn put(&self, line: &Line) {
        self.with_queues(|queues| queues.retain(|queue| queue.put(line)));
    }

    fn miss(&self, count: u64) {
        self.with_queues(|queues| {
            for queue in queues {
                queue.miss(count);
            }
        });
    }

    fn with_queues(&self, change: impl FnOnce(&mut Vec<Queue>)) {
        let mut queues = self.queues.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut queues);
        self.count.store(queues.len(), Ordering::Relaxed);
    }
}

/// The server's end of a queue.
struct Queue {
    sender: Sender<Line>,
    /// Where the oldest line is taken out when there is no room.
    oldest: Receiver<Line>,
    missed: Weak<AtomicU64>,
}

impl Queue {
    /// Puts a line in, if need be in the place of the oldest; whether anybody takes it out.
    fn put(&self, line: &Line) -> bool {
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
    pub lines: Receiver<Line>,
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
        let (mut reporter, untold) = Reporter::new();
        let subscription = untold.subscribers.add();
        for _ in 0..WAITING_NEWS + 2 {
            reporter.report(&Report::Refused("no".into()));
        }
        drop(reporter);
        tell_all(&untold);
        assert_eq!(subscription.take_missed(), 2);
        let line = subscription.lines.try_recv().unwrap();
        assert_eq!(&*line, r#"{"event":"reload","in_force":false,"text":"no"}"#);
    }
}

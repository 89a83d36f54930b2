//! A limit on messages by kind and source, so that no peer can fill a terminal or a log.

use std::fmt;
use std::time::{Duration, Instant};

/// Time in which a limited number of messages of one kind from one source is sent.
pub const MESSAGE_INTERVAL: Duration = Duration::from_secs(10);

/// Number of kinds and sources that are counted one by one. Further ones share the count of the last.
const MAX_KEYS: usize = 64;

/// The limit on messages: per interval of 10 s and key, that is kind and source, a number of messages, usually one.
///
/// The messages beyond are counted, and the latest is returned with the count when the interval is over, as the first
/// message of the next interval.
#[derive(Debug)]
pub struct MessageLimits<K, M> {
    intervals: Vec<Interval<K, M>>,
}

/// The current interval of one key.
#[derive(Debug)]
struct Interval<K, M> {
    key: K,
    start: Instant,
    sent: u32,
    held_back: u64,
    /// The latest message that was held back.
    latest: Option<M>,
}

/// Messages that were held back in one interval.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeldBack<M> {
    /// The latest message.
    pub latest: M,
    /// The number of messages.
    pub count: u64,
}

impl<M: fmt::Display> fmt::Display for HeldBack<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (latest, seconds) = (&self.latest, MESSAGE_INTERVAL.as_secs());
        write!(f, "{latest} ({} more of these in {seconds} s)", self.count)
    }
}

impl<K, M> Default for MessageLimits<K, M> {
    fn default() -> Self {
        Self {
            intervals: Vec::new(),
        }
    }
}

impl<K: PartialEq, M> MessageLimits<K, M> {
    /// Returns `message` if it may be sent, with at most `limit` messages of this key in an interval. Counts it
    /// otherwise.
    pub fn admit(&mut self, key: K, limit: u32, message: M, now: Instant) -> Option<M> {
        let interval = self.interval(key, now);
        if interval.admits(limit, now) {
            return Some(message);
        }
        interval.held_back += 1;
        interval.latest = Some(message);
        None
    }

    /// Returns `true` if one message of this key may be sent now and counts it as sent. For messages that carry a
    /// count of their own, so that nothing is lost when they are sent later.
    pub fn admits(&mut self, key: K, now: Instant) -> bool {
        self.interval(key, now).admits(1, now)
    }

    /// Returns messages that were held back in an interval that is over. Call it until it returns `None`.
    pub fn take_due(&mut self, now: Instant) -> Option<HeldBack<M>> {
        self.take(now, |interval| interval.is_over(now))
    }

    /// Returns messages that were held back, even if the interval is not over. Call it until it returns `None`.
    pub fn take_any(&mut self, now: Instant) -> Option<HeldBack<M>> {
        self.take(now, |_| true)
    }

    /// Returns the time from which [`take_due`](Self::take_due) returns something; `None` if nothing is held back.
    pub fn next_due(&self) -> Option<Instant> {
        let waiting = self.intervals.iter().filter(|entry| entry.held_back > 0);
        waiting.map(|entry| entry.start + MESSAGE_INTERVAL).min()
    }

    /// Starts new intervals for these keys. What they held back is forgotten.
    pub fn restart(&mut self, is_restarted: impl Fn(&K) -> bool) {
        self.intervals
            .retain(|interval| !is_restarted(&interval.key));
    }

    fn take(
        &mut self,
        now: Instant,
        is_due: impl Fn(&Interval<K, M>) -> bool,
    ) -> Option<HeldBack<M>> {
        let held_back = self.intervals.iter_mut().filter(|it| it.latest.is_some());
        let mut due = held_back.filter(|entry| is_due(entry));
        due.find_map(|interval| interval.take(now))
    }

    fn interval(&mut self, key: K, now: Instant) -> &mut Interval<K, M> {
        let found = self.intervals.iter().position(|entry| entry.key == key);
        let index = found.unwrap_or_else(|| {
            self.intervals
                .retain(|entry| entry.held_back > 0 || !entry.is_over(now));
            // A peer with ever new names must not fill the memory.
            if self.intervals.len() < MAX_KEYS {
                self.intervals.push(Interval::new(key, now));
            }
            self.intervals.len() - 1
        });
        &mut self.intervals[index]
    }
}

impl<K, M> Interval<K, M> {
    fn new(key: K, start: Instant) -> Self {
        Self {
            key,
            start,
            sent: 0,
            held_back: 0,
            latest: None,
        }
    }

    fn is_over(&self, now: Instant) -> bool {
        now.saturating_duration_since(self.start) >= MESSAGE_INTERVAL
    }

    /// Counts a message as sent if the limit allows it.
    fn admits(&mut self, limit: u32, now: Instant) -> bool {
        // Messages that were held back precede a later one.
        if self.held_back > 0 {
            return false;
        }
        if self.is_over(now) {
            (self.start, self.sent) = (now, 0);
        }
        let admits = self.sent < limit;
        self.sent += u32::from(admits);
        admits
    }

    /// Takes the messages that were held back as the first of a new interval.
    fn take(&mut self, now: Instant) -> Option<HeldBack<M>> {
        let latest = self.latest.take()?;
        let count = std::mem::take(&mut self.held_back);
        (self.start, self.sent) = (now, 1);
        Some(HeldBack { latest, count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Limits = MessageLimits<u32, &'static str>;

    fn seconds(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    #[test]
    fn one_message_per_key_and_interval_is_sent_and_the_others_are_counted() {
        let (mut limits, start) = (Limits::default(), Instant::now());
        assert_eq!(limits.admit(1, 1, "a", start), Some("a"));
        assert_eq!(limits.admit(2, 1, "x", start), Some("x"));
        for second in 0..5 {
            assert_eq!(limits.admit(1, 1, "b", start + seconds(second)), None);
        }
        assert_eq!(limits.take_due(start + seconds(9)), None);
        assert_eq!(limits.next_due(), Some(start + MESSAGE_INTERVAL));
        // A message at the end of the interval does not overtake those held back.
        let end = start + MESSAGE_INTERVAL;
        assert_eq!(limits.admit(1, 1, "c", end), None);
        let held_back = limits.take_due(end).unwrap();
        assert_eq!(held_back.to_string(), "c (6 more of these in 10 s)");
        assert_eq!((limits.take_due(end), limits.next_due()), (None, None));
        // The summary is the message of the next interval.
        assert_eq!(limits.admit(1, 1, "d", end + seconds(1)), None);
        let count = limits.take_any(end + seconds(2)).map(|held| held.count);
        assert_eq!(count, Some(1));
        let later = end + seconds(12);
        assert_eq!(limits.admit(1, 1, "e", later), Some("e"));
    }

    #[test]
    fn a_higher_limit_admits_more_and_a_restart_admits_at_once() {
        let (mut limits, now) = (Limits::default(), Instant::now());
        let admitted = (0..5).filter_map(|_| limits.admit(1, 3, "a", now));
        assert_eq!(admitted.count(), 3);
        assert!(limits.admits(2, now) && !limits.admits(2, now));
        limits.restart(|key| *key == 1);
        assert_eq!(limits.admit(1, 3, "a", now), Some("a"));
        assert_eq!(limits.take_any(now), None);
    }

    #[test]
    fn ever_new_sources_share_a_bounded_number_of_counters() {
        let (mut limits, now) = (MessageLimits::default(), Instant::now());
        let admitted = (0..100_000).filter_map(|key: u32| limits.admit(key, 1, key, now));
        assert_eq!(admitted.count(), MAX_KEYS);
        let held_back = limits.take_any(now).unwrap();
        assert_eq!(held_back.count, 100_000 - MAX_KEYS as u64);
        let later = now + 2 * MESSAGE_INTERVAL;
        assert!(limits.admits(100_000, later));
        assert_eq!(limits.intervals.len(), 1, "old keys are removed");
    }
}

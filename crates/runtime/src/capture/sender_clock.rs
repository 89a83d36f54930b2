//! The age of readings, by the times that their sender states.

use std::time::{Duration, Instant};

use ademan_core::time::Timestamp;

/// Largest age of a reading of a source on the network unless the setup says otherwise: the default stall timeout.
pub(super) const DEFAULT_MAX_AGE: Duration = Duration::from_millis(200);

/// Time in which the clock of a sender has to keep pace before readings are judged by it.
const TRIAL: Duration = Duration::from_secs(2);

/// The largest excess of the smallest delay of the second half of a trial over the smallest delay of the first half. A clock
/// that loses 3 % or counts other units than microseconds never passes.
const TRIAL_TOLERANCE: Duration = Duration::from_millis(25);

/// Rise of the smallest delay per unit of time, 3 %: more than the delay of a slow clock that passes a trial grows. A camera that
/// states the number of a picture at a nominal rate is easily 1 % slow. A congested network delays readings faster than that.
const MAX_DRIFT: f64 = 0.03;

/// Longest time between two readings in which the smallest delay rises: the network may have held back what was sent after it.
const MAX_DRIFT_TIME: Duration = Duration::from_secs(1);

/// Longest time in which all readings are too old. After it a new trial starts: the clock may have been set, or have stood still.
const MAX_LATENESS: Duration = Duration::from_secs(10);

/// Time in which only packets with earlier times arrive, after which the clock counts as set back. Datagrams that a network has
/// delayed arrive among newer ones.
const MIN_REFUSAL: Duration = Duration::from_millis(100);

/// The clock of a sender, which detects readings that a congested network has delayed.
///
/// The age of a reading is its delay less the smallest delay so far, so that the two clocks need no common origin. The smallest
/// delay rises slowly while readings are young, so that a slow clock does not add to their age. A steady delay is therefore not
/// detected, only a delay that has grown. A clock that does not keep pace with the clock of the receiver is not used.
#[derive(Debug)]
pub(super) struct SenderClock {
    max_age: Duration,
    opened: Instant,
    /// The smallest delay, in microseconds; `None` before the first reading.
    smallest: Option<i64>,
    /// The latest time that was stated.
    latest: Timestamp,
    /// `None` once the clock has kept pace.
    trial: Option<Trial>,
    /// Arrival of the first reading that was too old since the latest one that was not, in microseconds.
    late_since: Option<i64>,
    /// Arrival of the first packet that was refused for its earlier time since the latest one that was not, in microseconds.
    refused_since: Option<i64>,
}

/// The smallest delays of both halves of a trial, in microseconds.
#[derive(Debug)]
struct Trial {
    /// Arrival of the first reading, in microseconds.
    started_at: i64,
    smallest: [i64; 2],
}

impl SenderClock {
    /// Creates the clock of a sender from which nothing was received yet.
    pub fn new(max_age: Duration) -> Self {
        Self {
            max_age,
            opened: Instant::now(),
            smallest: None,
            latest: Timestamp::default(),
            trial: Some(Trial::NEW),
            late_since: None,
            refused_since: None,
        }
    }

    /// Forgets the clock: readings may come from another sender.
    pub fn reset(&mut self) {
        *self = Self::new(self.max_age);
    }

    /// Sets the largest age.
    pub fn set_max_age(&mut self, age: Duration) {
        self.max_age = age;
    }

    /// Updates the clock with a reading that arrives `now` and states the time `sent_at`. Returns `true` if the reading is older than
    /// the largest age.
    pub fn is_too_old(&mut self, now: Instant, sent_at: Timestamp) -> bool {
        let arrival = self.arrival(now);
        self.refused_since = None;
        if sent_at < self.latest {
            // The clock was set back, or the sender has started again.
            self.restart();
        }
        let elapsed = sent_at.since(self.latest).min(MAX_DRIFT_TIME);
        self.latest = sent_at;
        // Beyond every clock: 292 000 years.
        let time = sent_at.0.min(i64::MAX as u64 / 2) as i64;
        let delay = arrival - time;
        let age = self.age(delay, elapsed);
        if let Some(trial) = &mut self.trial {
            if trial.update(arrival, delay) {
                self.trial = None;
            }
            return false;
        }
        if age <= self.max_age.as_micros() as i64 {
            self.late_since = None;
            return false;
        }
        let late_since = *self.late_since.get_or_insert(arrival);
        if arrival - late_since >= MAX_LATENESS.as_micros() as i64 {
            self.restart();
        }
        true
    }

    /// Returns the age of a reading with this delay, in microseconds, which was sent `elapsed` after the previous reading, and updates
    /// the smallest delay.
    fn age(&mut self, delay: i64, elapsed: Duration) -> i64 {
        // The delay of readings that are too old does not come from the clock.
        let drift = if self.late_since.is_none() {
            elapsed.mul_f64(MAX_DRIFT)
        } else {
            Duration::ZERO
        };
        let smallest = self.smallest.map_or(delay, |smallest| {
            delay.min(smallest + drift.as_micros() as i64)
        });
        self.smallest = Some(smallest);
        delay - smallest
    }

    /// Updates the clock with packets that the protocol refuses because they state earlier times than a packet before them. If only
    /// such packets arrive for [`MIN_REFUSAL`], the clock was set back by a little, and its later times are not comparable with its
    /// earlier ones.
    pub fn note_refused(&mut self, now: Instant) {
        let arrival = self.arrival(now);
        let since = *self.refused_since.get_or_insert(arrival);
        if arrival - since >= MIN_REFUSAL.as_micros() as i64 {
            self.restart();
        }
    }

    /// Returns the time of an arrival in microseconds.
    fn arrival(&self, now: Instant) -> i64 {
        now.saturating_duration_since(self.opened).as_micros() as i64
    }

    fn restart(&mut self) {
        self.smallest = None;
        self.trial = Some(Trial::NEW);
        self.late_since = None;
    }
}

impl Trial {
    const NEW: Self = Self {
        started_at: i64::MIN,
        smallest: [i64::MAX; 2],
    };

    /// Adds a reading. Returns `true` at the end of the trial if the clock has kept pace; otherwise a new trial starts.
    fn update(&mut self, arrival: i64, delay: i64) -> bool {
        if self.started_at == i64::MIN {
            self.started_at = arrival;
        }
        let elapsed = arrival - self.started_at;
        let length = TRIAL.as_micros() as i64;
        if elapsed < length {
            let half = &mut self.smallest[usize::from(elapsed >= length / 2)];
            *half = delay.min(*half);
            return false;
        }
        let [first, second] = self.smallest;
        let is_passed = second < i64::MAX && second - first <= TRIAL_TOLERANCE.as_micros() as i64;
        *self = Self::NEW;
        is_passed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1000;

    /// A clock and the readings that were too old, by the number of the reading.
    struct Sender {
        clock: SenderClock,
        too_old: Vec<u64>,
    }

    impl Sender {
        fn new() -> Self {
            Self {
                clock: SenderClock::new(DEFAULT_MAX_AGE),
                too_old: Vec::new(),
            }
        }

        /// Sends a reading every 10 ms from `start_ms` to `end_ms`; `stated` and `delay` are functions of its time, in
        /// microseconds.
        fn send(
            &mut self,
            milliseconds: std::ops::Range<u64>,
            stated: impl Fn(u64) -> u64,
            delay: impl Fn(u64) -> u64,
        ) -> usize {
            let before = self.too_old.len();
            for number in milliseconds.step_by(10) {
                let time = number * MS;
                let arrival = self.clock.opened + Duration::from_micros(time + delay(time));
                if self.clock.is_too_old(arrival, Timestamp(stated(time))) {
                    self.too_old.push(number);
                }
            }
            self.too_old.len() - before
        }
    }

    fn fast(_: u64) -> u64 {
        500
    }

    #[test]
    fn readings_of_a_growing_delay_are_too_old_beyond_the_limit_and_young_ones_pass_again() {
        let mut sender = Sender::new();
        let right = |time| time + 77_000_000;
        assert_eq!(sender.send(0..3_000, right, fast), 0);
        // Each second arrives in two.
        sender.send(3_000..5_000, right, |time| time - 3_000 * MS + 500);
        assert_eq!(sender.too_old[0], 3_210, "the first beyond 200 ms");
        assert_eq!(sender.too_old.len(), 179, "and all after it");
        sender.too_old.clear();
        assert_eq!(sender.send(5_000..60_000, right, fast), 0);
    }

    #[test]
    fn jitter_below_the_limit_and_a_clock_that_drifts_are_no_age() {
        let mut sender = Sender::new();
        let jitter = |time: u64| (time * 7919) % (180 * MS);
        // 500 parts per million, twice as much as any clock of a computer.
        for loses in [true, false] {
            let stated = |time: u64| {
                if loses {
                    time - time / 2000
                } else {
                    time + time / 2000
                }
            };
            assert_eq!(sender.send(0..600_000, stated, jitter), 0, "{loses}");
            sender.clock.reset();
        }
    }

    #[test]
    fn a_clock_that_runs_slow_is_followed_or_not_used_and_hides_no_congestion() {
        // Parts per thousand that the clock loses.
        for loss in [2, 5, 10, 15, 20, 25, 28, 35, 50] {
            let mut sender = Sender::new();
            let stated = |time| time - time * loss / 1000;
            let jitter = |time: u64| (time * 7919) % (50 * MS);
            assert_eq!(sender.send(0..120_000, stated, jitter), 0, "{loss}");
            if loss <= 20 {
                let late = sender.send(120_000..125_000, stated, |_| 400 * MS);
                assert_eq!(late, 500, "{loss}");
            }
        }
    }

    #[test]
    fn what_was_sent_during_a_long_silence_is_too_old() {
        let mut sender = Sender::new();
        sender.send(0..10_000, |time| time, fast);
        // A minute arrives at once.
        let late = sender.send(10_000..70_000, |time| time, |time| 70_000 * MS - time);
        assert!((5_970..=5_990).contains(&late), "{late}");
    }

    #[test]
    fn a_clock_that_jumps_is_followed_at_once_or_after_ten_seconds() {
        const HOUR: u64 = 3_600_000_000;
        let mut sender = Sender::new();
        sender.send(0..5_000, |time| time + HOUR, fast);
        assert_eq!(sender.send(5_000..10_000, |time| time + 2 * HOUR, fast), 0);
        assert_eq!(sender.send(10_000..15_000, |time| time, fast), 0, "back");
        // The sender slept for a second, in which its clock stood still: a delay like any other.
        let stood = |time| time - 1_000 * MS;
        assert_eq!(sender.send(16_000..40_000, stood, fast), 1_001);
        assert_eq!(sender.too_old.last(), Some(&26_000));
    }

    #[test]
    fn a_clock_that_is_set_back_by_less_than_a_protocol_accepts_is_followed_once_its_packets_are() {
        const BACK: u64 = 500 * MS;
        let mut sender = Sender::new();
        sender.send(0..5_000, |time| time + BACK, fast);
        for number in (5_000..5_500).step_by(10) {
            let arrival = sender.clock.opened + Duration::from_micros(number * MS + 500);
            sender.clock.note_refused(arrival);
        }
        assert_eq!(sender.send(5_510..20_000, |time| time, fast), 0);
    }

    #[test]
    fn packets_that_others_have_overtaken_do_not_restart_the_clock() {
        let mut sender = Sender::new();
        sender.send(0..5_000, |time| time, fast);
        let delayed = |time: u64| 400 * MS + time % 2;
        for start in (5_000..7_000).step_by(20) {
            assert_eq!(sender.send(start..start + 20, |time| time, delayed), 2);
            let arrival = sender.clock.opened + Duration::from_millis(start + 415);
            sender.clock.note_refused(arrival);
        }
    }

    #[test]
    fn a_clock_of_other_units_or_one_that_stands_still_is_not_used() {
        for stated in [
            |time| time / 1000,
            |_| 5,
            |time| time * 8 / 10,
            |time| time * 40,
        ] {
            let mut sender = Sender::new();
            assert_eq!(sender.send(0..100_000, stated, fast), 0);
        }
    }

    #[test]
    fn readings_that_are_late_from_the_start_are_judged_once_the_delay_is_steady() {
        let mut sender = Sender::new();
        let growing = |time| time / 2;
        assert_eq!(sender.send(0..4_000, |time| time, growing), 0);
        sender.send(4_000..20_000, |time| time, |_| 2_000 * MS);
        assert!(sender.too_old.len() > 500, "{:?}", sender.too_old.first());
    }
}

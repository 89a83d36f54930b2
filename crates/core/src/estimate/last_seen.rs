//! The time at which something was seen last, and whether it is late.

use std::time::Duration;

use crate::time::Timestamp;

/// The time by which the interval between two readings may be longer than the interval before it, while the movement still counts as
/// known: a camera with 30 pictures per second may lose one.
const MAX_LATENESS: Duration = Duration::from_millis(60);

/// The time at which a part of a hand was seen last.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LastSeen {
    /// `None` before the first time, and while it is lost.
    time: Option<Timestamp>,
    /// The time between the last two times.
    interval: Duration,
}

impl LastSeen {
    /// Returns the time; `None` if it was not seen yet or is lost.
    pub(crate) fn time(&self) -> Option<Timestamp> {
        self.time
    }

    /// Returns the time since it was seen last, or zero if it was not seen.
    pub(crate) fn age(&self, time: Timestamp) -> Duration {
        self.time
            .map_or(Duration::ZERO, |seen_at| time.since(seen_at))
    }

    /// Returns `true` if it is late at `time`, so that its movement is not known.
    pub(crate) fn is_late(&self, time: Timestamp) -> bool {
        self.age(time) > self.interval + MAX_LATENESS
    }

    /// Sets the time at which it is seen again.
    pub(crate) fn see(&mut self, time: Timestamp) {
        self.interval = self.age(time);
        self.time = Some(time);
    }

    /// Forgets it, because it is lost.
    pub(crate) fn lose(&mut self) {
        self.time = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_late_60_ms_after_its_last_interval_and_never_before_it_is_seen() {
        let at = |milliseconds: u64| Timestamp(milliseconds * 1_000);
        let mut part = LastSeen::default();
        assert!(!part.is_late(at(5_000)), "nothing is known of it");
        part.see(at(5_000));
        assert!(!part.is_late(at(5_060)));
        assert!(part.is_late(at(5_061)));
        part.see(at(5_100));
        assert!(!part.is_late(at(5_260)));
        assert!(part.is_late(at(5_261)));
        part.lose();
        assert!(!part.is_late(at(9_000)));
        part.see(at(9_000));
        assert!(part.is_late(at(9_061)), "the interval before is forgotten");
    }
}

//! The pace of the taps of controls with a value.

use std::time::Duration;

use super::KeyArbiter;
use crate::time::Timestamp;

/// Taps come at once as long as they are due within this time at the pace.
const BURST: Duration = Duration::from_millis(500);

/// The pace of taps: a quick finger on a slider must not exceed the rate limit, which pauses the session.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TapPace {
    /// The time between two taps at the pace; 0 for no limit.
    gap: Duration,
    /// The time at which the taps so far would have ended at the pace.
    due: Timestamp,
}

impl KeyArbiter {
    /// Sets the time between two taps of a control with a value, beyond a few at once. At first nothing limits them.
    pub fn set_tap_gap(&mut self, gap: Duration) {
        self.tap_pace.gap = gap;
    }

    /// Counts a tap of a control with a value. Returns `false` if it has to wait.
    pub(in crate::device) fn may_tap(&mut self, time: Timestamp) -> bool {
        self.tap_pace.try_take(time)
    }
}

impl TapPace {
    /// Counts a tap at `time`. Returns `false` if it has to wait.
    fn try_take(&mut self, time: Timestamp) -> bool {
        if self.due.since(time) > BURST {
            return false;
        }
        self.due = self.due.max(time) + self.gap;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_is_followed_by_taps_at_the_pace() {
        let mut pace = TapPace {
            gap: Duration::from_millis(100),
            ..TapPace::default()
        };
        let count = |ms: u64| {
            let time = Timestamp(ms * 1_000);
            (0..100).take_while(|_| pace.try_take(time)).count()
        };
        assert_eq!(
            [1_000, 1_010, 1_100, 1_300, 9_000].map(count),
            [6, 0, 1, 2, 6]
        );
    }

    #[test]
    fn without_a_gap_nothing_waits() {
        let mut pace = TapPace::default();
        assert!((0..1_000).all(|_| pace.try_take(Timestamp(1_000))));
    }
}

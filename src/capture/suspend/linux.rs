//! Whether the machine has slept: readings of before then are of a hand that nobody knows any more.

use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// What the two clocks may differ by without a sleep; they are read one after the other.
const TOLERANCE: Duration = Duration::from_millis(100);

/// Notices that the machine has slept.
///
/// The clock that [`Instant`](std::time::Instant) goes by stands still in a sleep; the one since the start of
/// the machine does not.
pub(in crate::capture) struct SuspendDetector {
    /// How long the machine has slept since its start.
    asleep: fn() -> Duration,
    /// What that was when it was last asked.
    last: Duration,
}

impl SuspendDetector {
    /// One that goes by a clock of its own: no test can send the machine to sleep.
    #[cfg(test)]
    pub fn with(asleep: fn() -> Duration) -> Self {
        Self::by(asleep)
    }

    fn by(asleep: fn() -> Duration) -> Self {
        Self {
            last: asleep(),
            asleep,
        }
    }

    /// Whether the machine has slept since this was last asked.
    pub fn was_suspended(&mut self) -> bool {
        let asleep = (self.asleep)();
        let more = asleep.saturating_sub(self.last);
        if more > TOLERANCE {
            self.last = asleep;
        }
        more > TOLERANCE
    }
}

impl Default for SuspendDetector {
    fn default() -> Self {
        Self::by(asleep)
    }
}

fn asleep() -> Duration {
    let read = |clock| Duration::try_from(clock_gettime(clock)).unwrap_or_default();
    let awake = read(ClockId::Monotonic);
    read(ClockId::Boottime).saturating_sub(awake)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    #[test]
    fn a_sleep_is_noticed_once() {
        static ASLEEP_MS: AtomicU64 = AtomicU64::new(5_000);
        assert!(
            !SuspendDetector::default().was_suspended(),
            "the real clocks run alike"
        );
        let mut awake =
            SuspendDetector::with(|| Duration::from_millis(ASLEEP_MS.load(Ordering::SeqCst)));
        assert!(!awake.was_suspended());
        ASLEEP_MS.store(8_000, Ordering::SeqCst);
        assert!(awake.was_suspended());
        assert!(!awake.was_suspended());
    }
}

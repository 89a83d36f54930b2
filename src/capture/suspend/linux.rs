//! Comparison of the clocks with and without suspend time.

use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// Difference of the clocks that is not a suspend: they are read one after the other.
const TOLERANCE: Duration = Duration::from_millis(100);

/// Detector of system suspends.
///
/// `CLOCK_MONOTONIC`, the clock of [`Instant`](std::time::Instant), stands still during a suspend;
/// `CLOCK_BOOTTIME` does not.
pub(in crate::capture) struct SuspendDetector {
    /// Returns the total suspend time since boot.
    suspended: fn() -> Duration,
    last: Duration,
}

impl SuspendDetector {
    /// Creates a detector with a clock of its own, because a test cannot suspend the system.
    pub fn with_clock(suspended: fn() -> Duration) -> Self {
        Self {
            last: suspended(),
            suspended,
        }
    }

    /// Returns `true` if the system was suspended since the last call.
    pub fn was_suspended(&mut self) -> bool {
        let suspended = (self.suspended)();
        let was_suspended = suspended.saturating_sub(self.last) > TOLERANCE;
        if was_suspended {
            self.last = suspended;
        }
        was_suspended
    }
}

impl Default for SuspendDetector {
    fn default() -> Self {
        Self::with_clock(suspended_since_boot)
    }
}

fn suspended_since_boot() -> Duration {
    let read = |clock| Duration::try_from(clock_gettime(clock)).unwrap_or_default();
    let monotonic = read(ClockId::Monotonic);
    read(ClockId::Boottime).saturating_sub(monotonic)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    #[test]
    fn a_suspend_is_reported_once() {
        static SUSPENDED_MS: AtomicU64 = AtomicU64::new(5_000);
        assert!(
            !SuspendDetector::default().was_suspended(),
            "the real clocks run alike"
        );
        let mut detector = SuspendDetector::with_clock(|| {
            Duration::from_millis(SUSPENDED_MS.load(Ordering::SeqCst))
        });
        assert!(!detector.was_suspended());
        SUSPENDED_MS.store(8_000, Ordering::SeqCst);
        assert!(detector.was_suspended());
        assert!(!detector.was_suspended());
    }
}

//! Comparison of the clocks with and without suspend time.

use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// Largest difference between the clocks without a suspend: they are read one after the other. Every suspend takes longer.
const TOLERANCE: Duration = Duration::from_millis(100);

/// Detector of system suspends.
///
/// `CLOCK_MONOTONIC`, the clock of [`Instant`](std::time::Instant), stands still during a suspend;
/// `CLOCK_BOOTTIME` does not.
pub(in crate::capture) struct SuspendDetector {
    /// Returns the time since boot, with suspends.
    since_boot: fn() -> Duration,
    /// The time of the last call.
    last_call: Duration,
    /// The total suspend time of the last comparison.
    suspended: Duration,
}

impl SuspendDetector {
    /// Creates a detector with a clock of its own, because a test cannot suspend the system.
    pub fn with_clock(since_boot: fn() -> Duration) -> Self {
        let now = since_boot();
        Self {
            since_boot,
            last_call: now,
            suspended: now.saturating_sub(monotonic()),
        }
    }

    /// Returns `true` if the system was suspended since the last call.
    pub fn was_suspended(&mut self) -> bool {
        let now = (self.since_boot)();
        let elapsed = now.saturating_sub(self.last_call);
        self.last_call = now;
        // No suspend fits between two readings of a hand in motion, for which one clock is enough.
        if elapsed <= TOLERANCE {
            return false;
        }
        let suspended = now.saturating_sub(monotonic());
        let was_suspended = suspended.saturating_sub(self.suspended) > TOLERANCE;
        if was_suspended {
            self.suspended = suspended;
        }
        was_suspended
    }
}

impl Default for SuspendDetector {
    fn default() -> Self {
        Self::with_clock(|| read(ClockId::Boottime))
    }
}

/// Returns the time since boot, without suspends.
pub(in crate::capture) fn monotonic() -> Duration {
    read(ClockId::Monotonic)
}

fn read(clock: ClockId) -> Duration {
    Duration::try_from(clock_gettime(clock)).unwrap_or_default()
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
            monotonic() + Duration::from_millis(SUSPENDED_MS.load(Ordering::SeqCst))
        });
        assert!(!detector.was_suspended());
        SUSPENDED_MS.store(8_000, Ordering::SeqCst);
        assert!(detector.was_suspended());
        assert!(!detector.was_suspended());
    }
}

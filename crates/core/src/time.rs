//! Time stamps.
//!
//! Only `capture` and `session` read a clock. Every other module receives the time as an argument, so the same
//! readings produce the same events at any replay speed.

use std::ops::{Add, Sub};
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// The time-out of a thread that waits without a deadline: it wakes once an hour and waits again.
pub const NO_DEADLINE: Duration = Duration::from_secs(3600);

/// Microseconds on the monotonic clock of a source; 0 is the start of the source.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Timestamp(pub u64);

impl Timestamp {
    /// Returns the time in seconds.
    pub fn seconds(self) -> f64 {
        self.0 as f64 * 1e-6
    }

    /// Returns the time in milliseconds.
    pub fn milliseconds(self) -> f64 {
        self.0 as f64 * 1e-3
    }

    /// Creates a time stamp from seconds. Negative values and NaN give 0; larger values than fit saturate.
    pub fn from_seconds(seconds: f64) -> Self {
        Self((seconds * 1e6).round() as u64)
    }

    /// Returns the time elapsed since `earlier`, or zero if `earlier` is later than `self`.
    pub fn since(self, earlier: Self) -> Duration {
        Duration::from_micros(self.0.saturating_sub(earlier.0))
    }

    /// Interpolates linearly from `self` (`t` = 0) to `later` (`t` = 1). `t` is clamped to 0..=1; the result is
    /// `self` if `later` is earlier.
    pub fn lerp(self, later: Self, t: f32) -> Self {
        let span = later.0.saturating_sub(self.0) as f64;
        let elapsed = span * f64::from(t.clamp(0.0, 1.0));
        // `round` is a call of the system's library on most processors.
        let whole = elapsed as u64;
        let elapsed = whole + u64::from(elapsed - whole as f64 >= 0.5);
        // `f64` cannot represent every span exactly, so the sum may pass `later`.
        Self(self.0.saturating_add(elapsed).min(later.0.max(self.0)))
    }
}

impl Add<Duration> for Timestamp {
    type Output = Self;

    fn add(self, duration: Duration) -> Self {
        Self(self.0.saturating_add(duration.as_micros() as u64))
    }
}

impl Sub<Duration> for Timestamp {
    type Output = Self;

    fn sub(self, duration: Duration) -> Self {
        Self(self.0.saturating_sub(duration.as_micros() as u64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_saturates_at_the_start() {
        assert_eq!(Timestamp(5) - Duration::from_secs(1), Timestamp(0));
        assert_eq!(Timestamp(5).since(Timestamp(9)), Duration::ZERO);
        assert_eq!(Timestamp::from_seconds(f64::NAN), Timestamp(0));
    }

    #[test]
    fn interpolation_stays_between_both_ends() {
        let (start, end) = (Timestamp(1_000), Timestamp(2_000));
        assert_eq!(start.lerp(end, 0.25), Timestamp(1_250));
        assert_eq!(start.lerp(end, 7.0), end);
        assert_eq!(end.lerp(start, 0.5), end);
        let last = Timestamp(u64::MAX);
        assert_eq!(start.lerp(last, 1.0), last);
    }
}

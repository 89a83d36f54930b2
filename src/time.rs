//! The only clock that a stage knows: a number that its caller hands over.

use std::ops::{Add, Sub};
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// Where nothing is expected a thread wakes up once an hour, for nothing.
pub(crate) const NO_DEADLINE: Duration = Duration::from_secs(3600);

/// Microseconds on the source's own monotonic clock; 0 is the start of the source.
///
/// Stages never ask an operating system for the time: they get it with the reading, so that the
/// same readings give the same events at any speed.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Timestamp(pub u64);

impl Timestamp {
    /// The time in seconds.
    pub fn seconds(self) -> f64 {
        self.0 as f64 * 1e-6
    }

    /// The time in milliseconds.
    pub fn milliseconds(self) -> f64 {
        self.0 as f64 * 1e-3
    }

    /// From seconds; negative and non-finite values give the start, 0.
    pub fn from_seconds(seconds: f64) -> Self {
        Self((seconds * 1e6).round() as u64)
    }

    /// How long after `earlier` this is; zero when it is not after it.
    pub fn since(self, earlier: Self) -> Duration {
        Duration::from_micros(self.0.saturating_sub(earlier.0))
    }

    /// The moment at `share` (0..=1) of the way from `self` to `later`.
    pub fn lerp(self, later: Self, share: f32) -> Self {
        let gap = later.0.saturating_sub(self.0) as f64;
        let passed = (gap * f64::from(share.clamp(0.0, 1.0))).round() as u64;
        // A gap of centuries has more digits than the share can tell.
        Self(self.0.saturating_add(passed).min(later.0.max(self.0)))
    }
}

impl Add<Duration> for Timestamp {
    type Output = Self;

    fn add(self, later: Duration) -> Self {
        Self(self.0.saturating_add(later.as_micros() as u64))
    }
}

impl Sub<Duration> for Timestamp {
    type Output = Self;

    fn sub(self, earlier: Duration) -> Self {
        Self(self.0.saturating_sub(earlier.as_micros() as u64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_never_goes_below_the_start() {
        assert_eq!(Timestamp(5) - Duration::from_secs(1), Timestamp(0));
        assert_eq!(Timestamp(5).since(Timestamp(9)), Duration::ZERO);
        assert_eq!(Timestamp::from_seconds(f64::NAN), Timestamp(0));
    }

    #[test]
    fn a_share_of_the_way_lies_between_both_ends() {
        let (start, end) = (Timestamp(1_000), Timestamp(2_000));
        assert_eq!(start.lerp(end, 0.25), Timestamp(1_250));
        assert_eq!(start.lerp(end, 7.0), end);
        assert_eq!(end.lerp(start, 0.5), end);
        let last = Timestamp(u64::MAX);
        assert_eq!(start.lerp(last, 1.0), last);
    }
}

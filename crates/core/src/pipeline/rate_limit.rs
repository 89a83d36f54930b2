//! The rate limit for presses.

use std::time::Duration;

use crate::time::Timestamp;

/// A rate limit for presses of keys and buttons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PressRateLimit {
    /// The sustained rate in presses per second. Half as many may come at once.
    pub per_second: u32,
}

impl PressRateLimit {
    /// The default for sources on this machine: 720 words per minute, faster than any typist.
    pub const LOCAL: Self = Self { per_second: 60 };

    /// The default for network sources: an intruder is slower than a good typist.
    pub const NETWORK: Self = Self { per_second: 20 };

    /// Returns the time between two presses of a sequence, or two taps of a control with a value: at most 50 presses per second, and half
    /// of the rate limit, so that one of them alone never exceeds it and leaves room for the presses of a person.
    pub(super) fn sequence_gap(self) -> Duration {
        let of_limit = Duration::from_secs(2) / self.per_second.max(1);
        of_limit.max(Duration::from_millis(20))
    }

    /// Returns the size of the largest burst, in units of [`TOKEN`].
    fn capacity(self) -> u64 {
        u64::from(self.per_second / 2).max(1) * TOKEN
    }
}

/// The cost of one press. A bucket gains `per_second` units per microsecond.
const TOKEN: u64 = 1_000_000;

/// A token bucket that holds the presses of half a second.
#[derive(Clone, Copy, Debug)]
pub(super) struct TokenBucket {
    limit: PressRateLimit,
    level: u64,
    updated: Timestamp,
}

impl TokenBucket {
    pub(super) fn new(limit: PressRateLimit) -> Self {
        Self {
            limit,
            level: limit.capacity(),
            updated: Timestamp::default(),
        }
    }

    /// Returns the rate limit.
    pub(super) fn limit(&self) -> PressRateLimit {
        self.limit
    }

    /// Removes one token at `time`; returns `false` if there is none.
    pub(super) fn try_take(&mut self, time: Timestamp) -> bool {
        let elapsed_us = time.since(self.updated).as_micros() as u64;
        self.updated = self.updated.max(time);
        let gain = elapsed_us.saturating_mul(self.limit.per_second.into());
        self.level = self.level.saturating_add(gain).min(self.limit.capacity());
        let is_available = self.level >= TOKEN;
        self.level -= if is_available { TOKEN } else { 0 };
        is_available
    }
}

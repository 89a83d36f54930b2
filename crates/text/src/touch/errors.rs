//! Rates of taps that are missed, mean nothing, or come in the wrong order.

use serde::{Deserialize, Serialize};

/// The number of taps that the prior of the errors is worth.
const ERROR_TAPS: f32 = 150.0;

/// Counts of taps that were missed and of taps that mean nothing, older ones counted less.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ErrorSums {
    /// The taps.
    pub taps: f32,
    /// Taps that mean nothing.
    pub spurious: f32,
    /// Characters that were meant and not tapped.
    pub missed: f32,
    /// Pairs of taps in the wrong order.
    pub swapped: f32,
}

/// The errors of a text that was committed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ErrorCounts {
    /// The taps.
    pub taps: usize,
    /// Taps that mean nothing.
    pub spurious: usize,
    /// Characters that were meant and not tapped.
    pub missed: usize,
    /// Pairs of taps in the wrong order.
    pub swapped: usize,
}

impl ErrorSums {
    /// Returns by how much the log-probability of a spurious tap changes with what was learned.
    pub fn spurious_change(&self, prior: f32) -> f32 {
        self.change(self.spurious, prior)
    }

    /// Returns by how much the log-probability of a missed tap changes with what was learned.
    pub fn missed_change(&self, prior: f32) -> f32 {
        self.change(self.missed, prior)
    }

    /// Returns by how much the log-probability of two taps in the wrong order changes with what was learned.
    pub fn swapped_change(&self, prior: f32) -> f32 {
        self.change(self.swapped, prior)
    }

    fn change(&self, seen: f32, prior: f32) -> f32 {
        // An error that is never believed has no probability, and divided by it no logarithm.
        let expected = prior.exp().max(f32::MIN_POSITIVE);
        ((seen + expected * ERROR_TAPS) / (self.taps + ERROR_TAPS) / expected).ln()
    }

    pub(super) fn is_sane(&self) -> bool {
        [self.taps, self.spurious, self.missed, self.swapped]
            .iter()
            .all(|number| number.is_finite() && *number >= 0.0)
    }
}

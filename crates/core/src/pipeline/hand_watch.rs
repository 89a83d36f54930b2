//! The moment at which a hand is lost.

use crate::estimate::Estimate;
use crate::hand::FingerSet;

/// The tracking of a hand, as of its last step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HandWatch {
    /// `true` if the position of the hand was known.
    was_placed: bool,
    /// `true` if a finger was measured.
    was_seen: bool,
    /// `true` if a source of the hand was lost after the last step.
    has_lost_source: bool,
}

impl HandWatch {
    /// Notes that a source of the hand was lost.
    pub(super) fn lose(&mut self) {
        self.has_lost_source = true;
    }

    /// Returns `true` for the step in which the hand is lost: its position or its last finger is no longer measured, or it has lost a
    /// source. Returns `false` for the steps after that, so that the rest of the hand can lock keys and switch toggles on again.
    pub(super) fn update(&mut self, estimate: &Estimate) -> bool {
        let is_seen = estimate.untrusted != FingerSet::ALL;
        let is_lost = std::mem::take(&mut self.has_lost_source)
            || self.was_placed && !estimate.is_placed
            || self.was_seen && !is_seen;
        self.was_placed = estimate.is_placed;
        self.was_seen = is_seen;
        is_lost
    }
}

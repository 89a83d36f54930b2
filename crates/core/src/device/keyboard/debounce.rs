//! Debouncing of keys.

use std::time::Duration;

use crate::time::Timestamp;

/// The last release of each key, by the index of its binding.
#[derive(Clone, Debug)]
pub(super) struct Debouncer {
    released_at: Vec<Option<Timestamp>>,
}

impl Debouncer {
    /// Creates a debouncer for `count` keys, none released yet.
    pub(super) fn new(count: usize) -> Self {
        Self {
            released_at: vec![None; count],
        }
    }

    /// Records the release of a key.
    pub(super) fn record_release(&mut self, index: usize, time: Timestamp) {
        if let Some(released_at) = self.released_at.get_mut(index) {
            *released_at = Some(time);
        }
    }

    /// Returns `true` if a press follows the release of its key within `debounce`. A press before the release
    /// comes from another finger and is not a bounce.
    pub(super) fn is_bounce(&self, index: usize, time: Timestamp, debounce: Duration) -> bool {
        let released_at = self.released_at.get(index).copied().flatten();
        released_at
            .is_some_and(|released_at| time >= released_at && time.since(released_at) < debounce)
    }

    /// Forgets all releases.
    pub(super) fn reset(&mut self) {
        self.released_at.fill(None);
    }
}

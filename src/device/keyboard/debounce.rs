//! Presses that come too soon after the key came up.

use std::time::Duration;

use crate::time::Timestamp;

/// When each key came up last.
#[derive(Clone, Debug)]
pub(super) struct Bounces {
    /// By the place of the key's binding.
    came_up: Vec<Option<Timestamp>>,
}

impl Bounces {
    /// No key of `count` has come up yet.
    pub(super) fn new(count: usize) -> Self {
        Self {
            came_up: vec![None; count],
        }
    }

    /// Takes note that a press of a key has ended.
    pub(super) fn came_up(&mut self, place: usize, time: Timestamp) {
        if let Some(came_up) = self.came_up.get_mut(place) {
            *came_up = Some(time);
        }
    }

    /// Whether a press comes sooner than `delay` after the key came up. One that began before that
    /// is another finger's.
    pub(super) fn is_bounce(&self, place: usize, time: Timestamp, delay: Duration) -> bool {
        let came_up = self.came_up.get(place).copied().flatten();
        came_up.is_some_and(|came_up| time >= came_up && time.since(came_up) < delay)
    }

    /// Forgets every key.
    pub(super) fn forget(&mut self) {
        self.came_up.fill(None);
    }
}

//! Debouncing of keys and switches.

use std::time::Duration;

use crate::contact::Touch;
use crate::hand::{FingerSet, Side};
use crate::time::Timestamp;

/// The last releases of the keys, by their indices.
#[derive(Clone, Debug)]
pub(super) struct Debouncer {
    keys: Vec<Bounces>,
}

/// The last release of a key.
#[derive(Clone, Copy, Debug, Default)]
struct Bounces {
    released_at: Option<Timestamp>,
    /// The fingers of each hand that press it, also those whose press is ignored.
    pressed_by: [FingerSet; Side::COUNT],
}

impl Debouncer {
    /// Creates a debouncer for `count` keys, none released yet.
    pub(super) fn new(count: usize) -> Self {
        Self {
            keys: vec![Bounces::default(); count],
        }
    }

    /// Records the release of a key.
    pub(super) fn record_release(&mut self, index: usize, time: Timestamp) {
        if let Some(key) = self.keys.get_mut(index) {
            key.released_at = Some(time);
        }
    }

    /// Records the end of a press, also of one that had no effect: the key continues to bounce, however often noise presses it. A finger
    /// that has only touched the key has pressed nothing.
    pub(super) fn end_press(&mut self, index: usize, touch: &Touch) {
        let Some(key) = self.keys.get_mut(index) else {
            return;
        };
        let fingers = &mut key.pressed_by[touch.side.index()];
        if fingers.contains(touch.finger) {
            *fingers = fingers.without(touch.finger);
            key.released_at = Some(touch.time);
        }
    }

    /// Notes a press. Returns `true` if it follows the release of its key within `debounce`, and is to be ignored. A press before the
    /// release comes from another finger and is not a bounce.
    pub(super) fn ignores(&mut self, index: usize, touch: &Touch, debounce: Duration) -> bool {
        let is_bounce = self.is_bounce(index, touch.time, debounce);
        if let Some(key) = self.keys.get_mut(index) {
            let fingers = &mut key.pressed_by[touch.side.index()];
            *fingers = fingers.with(touch.finger);
        }
        is_bounce
    }

    /// Returns `true` if a press follows the release of its key within `debounce`.
    pub(super) fn is_bounce(&self, index: usize, time: Timestamp, debounce: Duration) -> bool {
        let released_at = self.keys.get(index).and_then(|key| key.released_at);
        released_at
            .is_some_and(|released_at| time >= released_at && time.since(released_at) < debounce)
    }

    /// Forgets all releases.
    pub(super) fn reset(&mut self) {
        self.keys.fill(Bounces::default());
    }
}

//! The state that the loop and the thread of an output share.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

use super::press_ticket::PressTickets;

/// The state, whose fields either side may change at any time.
pub struct WorkerStatus {
    /// The first failure.
    pub failure: OnceLock<String>,
    /// The names of the keys that could not be released.
    pub stuck_keys: OnceLock<String>,
    /// Number of calls from the loop, as a sign of life.
    pub loop_calls: AtomicU64,
    /// Number of requests that the thread has executed.
    pub executed: AtomicU64,
    /// The validity of queued presses.
    pub tickets: PressTickets,
    /// Number of presses and characters that were not sent because their tickets were void, the display cannot type the
    /// text, or a burst would have deleted text in another window.
    pub void_presses: AtomicU64,
    /// The generation of the field that has the focus: another number for each window.
    pub field: AtomicU32,
}

impl WorkerStatus {
    /// Creates the state for presses that are sent within `max_press_age`.
    pub fn new(max_press_age: Duration) -> Self {
        Self {
            failure: OnceLock::new(),
            stuck_keys: OnceLock::new(),
            loop_calls: AtomicU64::new(0),
            executed: AtomicU64::new(0),
            tickets: PressTickets::new(max_press_age),
            void_presses: AtomicU64::new(0),
            field: AtomicU32::new(0),
        }
    }

    /// Begins another generation of the field if another window has the focus: its text is another one.
    pub fn next_field_if(&self, is_other_window: bool) {
        if is_other_window {
            self.field.fetch_add(1, Ordering::Release);
        }
    }
}

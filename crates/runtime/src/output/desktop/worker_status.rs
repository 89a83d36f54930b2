//! The state that the loop and the thread of an output share.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

use super::injector::Injector;
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
    /// text, or a burst would have deleted text in another window or after a press of another device.
    pub void_presses: AtomicU64,
    /// The generation of the field that has the focus: another number for each window, and after each press of another device.
    pub field: AtomicU32,
    /// A text decoder follows the field.
    is_field_followed: AtomicBool,
    /// A key of the keyboard was pressed in a field that a text decoder follows. Another output may have the keys, and presses
    /// of its device are not presses of the person.
    needs_device_watch: AtomicBool,
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
            is_field_followed: AtomicBool::new(false),
            needs_device_watch: AtomicBool::new(false),
        }
    }

    /// Returns the generation of the field to a text decoder, which follows the field from now on.
    pub fn follow_field(&self) -> u32 {
        self.is_field_followed.store(true, Ordering::Relaxed);
        self.field.load(Ordering::Acquire)
    }

    /// Returns the generation of the field in which a key of the keyboard is pressed.
    pub fn press_in_field(&self) -> u32 {
        if self.is_field_followed.load(Ordering::Relaxed) {
            self.needs_device_watch.store(true, Ordering::Relaxed);
        }
        self.field.load(Ordering::Acquire)
    }

    /// Begins another generation of the field if another window has the focus, as its text is another one, or if another device was
    /// pressed, which may change the text or the place in it.
    pub fn update_field(&self, is_other_window: bool, injector: &mut dyn Injector) {
        let is_watched = self.needs_device_watch.load(Ordering::Relaxed);
        let is_changed = is_watched && injector.poll_foreign_press();
        if is_other_window || is_changed {
            self.field.fetch_add(1, Ordering::Release);
        }
    }
}

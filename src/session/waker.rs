//! A way to wake the session loop from any thread.

use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, Thread};

/// Wakes the loop thread, which parks while there is nothing to do.
#[derive(Clone, Debug, Default)]
pub(super) struct Waker(Arc<Mutex<Option<Thread>>>);

impl Waker {
    /// Wakes the loop. Must be called after the message was queued.
    pub fn wake(&self) {
        if let Some(thread) = &*self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            thread.unpark();
        }
    }

    /// Makes the current thread the one to wake. Messages queued before this call are in the queue.
    pub fn attach(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(thread::current());
    }
}

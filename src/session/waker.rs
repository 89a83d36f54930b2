//! A way to wake the session loop from any thread.

use std::sync::{Arc, Mutex, PoisonError};
use std::thread::Thread;

use crate::capture::WakeUp;

/// Wakes the loop thread, which waits while there is nothing to do.
#[derive(Clone, Debug, Default)]
pub(super) struct Waker(Arc<Mutex<Option<WakeTarget>>>);

/// A waiting thread.
#[derive(Debug)]
pub(super) enum WakeTarget {
    /// It is parked.
    Parked(Thread),
    /// It polls descriptors.
    Polling(WakeUp),
}

impl Waker {
    /// Wakes the loop. Must be called after the message was queued.
    pub fn wake(&self) {
        match &*self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(WakeTarget::Parked(thread)) => thread.unpark(),
            Some(WakeTarget::Polling(wake_up)) => wake_up.wake(),
            None => {}
        }
    }

    /// Sets the thread to wake. Messages queued before this call are in the queue.
    pub fn attach(&self, target: WakeTarget) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(target);
    }
}

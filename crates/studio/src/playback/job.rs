//! Work that takes longer than a picture, on a thread of its own.

use std::thread;

use crossbeam_channel::{Receiver, bounded};

/// Work on a thread of its own, and its result.
pub struct Job<T> {
    result: Receiver<T>,
}

impl<T: Send + 'static> Job<T> {
    /// Starts the work. If there is no thread for it, it has no result.
    pub fn start(work: impl FnOnce() -> T + Send + 'static) -> Self {
        let (sender, result) = bounded(1);
        let thread = thread::Builder::new().name("studio-job".into());
        // The window may have been closed before the work is done.
        let _ = thread.spawn(move || _ = sender.send(work()));
        Self { result }
    }

    /// Returns the result once, when it is there. Does not wait.
    pub fn poll(&self) -> Option<T> {
        self.result.try_recv().ok()
    }
}

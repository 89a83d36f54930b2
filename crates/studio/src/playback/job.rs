//! Work that takes longer than a frame, on a thread of its own.

use std::thread;

use crossbeam_channel::{Receiver, TryRecvError, bounded};

/// Reason why there is no result: the thread has not started, or has ended early.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "this was not done, as its thread did not start or ended early; close other programs and try again"
)]
pub struct JobLost;

/// Work on a thread of its own, and its result.
pub struct Job<T> {
    result: Receiver<T>,
}

impl<T: Send + 'static> Job<T> {
    /// Starts the work. If there is no thread for it, it is lost.
    pub fn start(work: impl FnOnce() -> T + Send + 'static) -> Self {
        let (sender, result) = bounded(1);
        let thread = thread::Builder::new().name("studio-job".into());
        // The window may have been closed before the work is done.
        let _ = thread.spawn(move || _ = sender.send(work()));
        Self { result }
    }

    /// Returns the result once, when it is there, or the reason why there will be none. Does not wait.
    pub fn poll(&self) -> Option<Result<T, JobLost>> {
        match self.result.try_recv() {
            Ok(result) => Some(Ok(result)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(JobLost)),
        }
    }

    /// Waits for the result, unless [`poll`](Self::poll) has returned it, or returns the reason why there is none.
    pub fn wait(self) -> Result<T, JobLost> {
        self.result.recv().map_err(|_| JobLost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_whose_thread_ends_without_a_result_is_lost() {
        let (sender, result) = bounded::<u8>(1);
        let job = Job { result };
        assert_eq!(job.poll(), None);
        drop(sender);
        assert_eq!(job.poll(), Some(Err(JobLost)));
        assert_eq!(job.wait(), Err(JobLost));
    }

    #[test]
    fn the_result_of_work_is_waited_for() {
        assert_eq!(Job::start(|| 3).wait(), Ok(3));
    }
}

//! Work on several threads, with results in order.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

/// The work was cancelled before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("interrupted before the end")]
pub struct Cancelled;

/// Calls `work` for each index below `count` on `jobs` threads, or on as many as the system starts, and returns the results in order of
/// the indices, whatever the number of threads. Calls `progress` with the number of results so far, on the thread of the caller. One
/// job starts no thread: WebAssembly has none.
pub fn for_each<T: Send>(
    count: usize,
    jobs: NonZeroUsize,
    cancel: &AtomicBool,
    work: impl Fn(usize) -> T + Sync,
    mut progress: impl FnMut(usize),
) -> Result<Vec<T>, Cancelled> {
    if jobs == NonZeroUsize::MIN {
        let mut results = Vec::with_capacity(count);
        for index in 0..count {
            if cancel.load(Ordering::Relaxed) {
                return Err(Cancelled);
            }
            results.push(work(index));
            progress(results.len());
        }
        return Ok(results);
    }
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    let mut results: Vec<Option<T>> = (0..count).map(|_| None).collect();
    let run = |finished: mpsc::Sender<(usize, T)>| {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count || cancel.load(Ordering::Relaxed) {
                return;
            }
            if finished.send((index, work(index))).is_err() {
                return;
            }
        }
    };
    thread::scope(|scope| {
        let run = &run;
        let started = (0..jobs.get().min(count)).take_while(|_| {
            let sender = sender.clone();
            let thread = thread::Builder::new().spawn_scoped(scope, move || run(sender));
            thread.is_ok()
        });
        // A system that refuses a thread leaves the work to those that it has started, or to this one.
        if started.count() == 0 {
            run(sender.clone());
        }
        drop(sender);
        for (done, (index, result)) in receiver.into_iter().enumerate() {
            results[index] = Some(result);
            progress(done + 1);
        }
    });
    let results: Option<Vec<T>> = results.into_iter().collect();
    results.ok_or(Cancelled)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_order_on_any_number_of_threads() {
        for jobs in [1, 2, 7] {
            let jobs = NonZeroUsize::new(jobs).expect("more than 0");
            let mut seen = Vec::new();
            let never = AtomicBool::new(false);
            let squares = for_each(
                50,
                jobs,
                &never,
                |index| index * index,
                |done| seen.push(done),
            );
            let expected: Vec<usize> = (0..50).map(|index| index * index).collect();
            assert_eq!(squares, Ok(expected));
            assert_eq!(seen, (1..=50).collect::<Vec<_>>());
        }
    }

    #[test]
    fn cancelled_work_has_no_result() {
        let cancel = AtomicBool::new(false);
        let one = NonZeroUsize::MIN;
        let stop_after = |done| cancel.store(done == 3, Ordering::Relaxed);
        let result = for_each(
            1_000_000,
            one,
            &cancel,
            |index| index,
            |done| {
                if done == 3 {
                    stop_after(done);
                }
            },
        );
        assert_eq!(result, Err(Cancelled));
    }
}

//! No thread dies in silence: a panic anywhere ends the program in good order.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use crate::failure::Failure;
use crate::signals::Stopper;

static HAPPENED: AtomicBool = AtomicBool::new(false);
static TRACE: OnceLock<Backtrace> = OnceLock::new();
static BELL: OnceLock<Stopper> = OnceLock::new();

/// Runs the program; a panic, of whatever thread, is a failure.
pub fn caught(run: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    end_the_run();
    let outcome = catch_unwind(AssertUnwindSafe(run));
    if let Some(trace) = TRACE.get()
        && trace.status() == BacktraceStatus::Captured
    {
        say!("{trace}");
    }
    match outcome {
        Ok(Err(failure)) => Err(failure),
        _ => check(),
    }
}

/// From now on a panic of any thread is told, and asks for the end of what is [under way](ring).
pub fn end_the_run() {
    panic::set_hook(Box::new(move |panic| {
        HAPPENED.store(true, Ordering::Relaxed);
        if let Some(bell) = BELL.get() {
            bell.ask_once();
        }
        // Where it was, in words, takes longer than anybody wants to wait for keys to come up.
        let _ = TRACE.set(Backtrace::capture());
        let thread = thread::current();
        say!(
            "thread '{}' {panic}",
            thread.name().unwrap_or("without a name")
        );
    }));
}

/// Where the end is asked for. The first one counts.
pub fn ring(bell: &Stopper) {
    let _ = BELL.set(bell.clone());
}

/// An error if any thread has panicked: whoever ended because of that did not do the job.
fn check() -> Result<(), Failure> {
    match HAPPENED.load(Ordering::Relaxed) {
        false => Ok(()),
        true => Err(Failure::job(
            "a part of this program broke down, as told above: everything is released; please report this",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stands for the threads that nobody waits for: those of the control socket, of a layout file, of a
    /// recording.
    #[test]
    fn a_panic_of_a_thread_that_nobody_waits_for_asks_for_the_end_and_is_a_failure() {
        let (stopper, stop) = Stopper::new();
        ring(&stopper);
        end_the_run();
        assert!(check().is_ok());
        assert!(stop.is_empty());
        let dies = thread::spawn(|| panic!("meant to happen"));
        assert!(dies.join().is_err());
        assert_eq!(stop.try_recv(), Ok(()));
        assert!(stopper.is_asked());
        assert!(check().is_err());
        assert!(caught(|| panic!("meant to happen")).is_err());
    }
}

//! Panics: a panic of any thread stops the program in an orderly way and makes it fail.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crate::failure::Failure;
use crate::{messages, signals};

/// Longest wait for the message of a panic that aborts the process.
const ABORT_DELAY: Duration = Duration::from_millis(20);

static PANICKED: AtomicBool = AtomicBool::new(false);
static BACKTRACE: OnceLock<Backtrace> = OnceLock::new();

thread_local! {
    /// The session continues after a panic of this thread.
    static IS_CONTAINED: Cell<bool> = const { Cell::new(false) };
}

/// Runs the program. A panic of any thread is a failure.
pub fn catch(run: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    install_hook();
    let outcome = catch_unwind(AssertUnwindSafe(run));
    if let Some(backtrace) = BACKTRACE.get()
        && backtrace.status() == BacktraceStatus::Captured
    {
        complain!("{backtrace}");
    }
    match outcome {
        Ok(Err(failure)) => Err(failure),
        _ => check(),
    }
}

/// Runs a part of the program that a session does not need. A panic in it prints a message, does not stop the program, and gives
/// `None`; the program fails at its end.
#[cfg(any(feature = "studio", test))]
pub fn contain<T>(run: impl FnOnce() -> T) -> Option<T> {
    IS_CONTAINED.set(true);
    let outcome = catch_unwind(AssertUnwindSafe(run));
    IS_CONTAINED.set(false);
    outcome.ok()
}

/// Makes every panic print a message and stop the program.
pub fn install_hook() {
    panic::set_hook(Box::new(|panic| {
        let is_second = PANICKED.swap(true, Ordering::Relaxed);
        if !IS_CONTAINED.get() {
            signals::request_stop();
        }
        // Resolving its symbols takes seconds, in which keys would stay down; `catch` prints it at the end.
        let _ = BACKTRACE.set(Backtrace::capture());
        let thread = thread::current();
        complain!(
            "thread '{}' {panic}",
            thread.name().unwrap_or("without a name")
        );
        if is_second {
            // A panic during a panic aborts the process next, and the watchdog releases the keys.
            signals::run_last_action();
            messages::flush_within(ABORT_DELAY);
        }
    }));
}

fn check() -> Result<(), Failure> {
    if !PANICKED.load(Ordering::Relaxed) {
        Ok(())
    } else {
        Err(Failure::job(
            "internal error, see above: everything is released; please report this",
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::own_process::has_own_process;
    use crossbeam_channel::bounded;

    const NAME: &str =
        "panics::tests::a_panic_of_a_detached_thread_stops_the_program_and_is_a_failure";

    /// Stands for threads that are never joined, such as the threads of the control socket or a layout file.
    #[test]
    fn a_panic_of_a_detached_thread_stops_the_program_and_is_a_failure() {
        if !has_own_process(NAME) {
            return;
        }
        let (stop, stopped) = bounded(1);
        signals::on_stop(move || _ = stop.try_send(()));
        install_hook();
        assert!(check().is_ok());
        assert!(contain(|| panic!("intended")).is_none());
        assert!(stopped.is_empty(), "a contained panic stops nothing");
        assert!(!signals::is_stop_requested());
        assert!(check().is_err());
        let thread = thread::spawn(|| panic!("intended"));
        assert!(thread.join().is_err());
        assert_eq!(stopped.try_recv(), Ok(()));
        assert!(signals::is_stop_requested());
        assert!(check().is_err());
        assert!(catch(|| panic!("intended")).is_err());
    }

    const NAME_AT_ONCE: &str =
        "panics::tests::a_panic_is_reported_where_a_signal_ends_the_program_at_once";

    #[test]
    fn a_panic_is_reported_where_a_signal_ends_the_program_at_once() {
        if has_own_process(NAME_AT_ONCE) {
            signals::end_at_once_on_stop();
            assert!(catch(|| panic!("intended")).is_err());
        }
    }
}

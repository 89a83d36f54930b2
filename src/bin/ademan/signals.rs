//! SIGINT (Ctrl-C), SIGTERM and SIGHUP: an orderly end within a bounded time.

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;

use crossbeam_channel::bounded;

use crate::failure::Failure;

/// Exit code of a program that could not end in an orderly way.
const INTERRUPTED: i32 = 130;

/// Time for an orderly end. It takes some milliseconds, but a full pipe on standard output would block it forever.
const END_TIMEOUT: Duration = Duration::from_secs(3);

/// Time for an orderly end before a second Ctrl-C ends the process. Releasing all keys takes a few milliseconds.
const GRACE: Duration = Duration::from_secs(1);

/// Longest time for the last action before the process ends.
const ACTION_TIMEOUT: Duration = Duration::from_millis(200);

static IS_INSTALLED: AtomicBool = AtomicBool::new(false);
static REQUESTED: AtomicBool = AtomicBool::new(false);
static BEFORE_EXIT: OnceLock<fn()> = OnceLock::new();
static ACTION: Mutex<Option<Arc<dyn Fn() + Send + Sync>>> = Mutex::new(None);

/// Handles the signals from now on. A second call has no effect.
pub fn install() -> Result<(), Failure> {
    if IS_INSTALLED.swap(true, Ordering::SeqCst) {
        return Ok(());
    }
    ctrlc::set_handler(interrupt).map_err(|error| match error {
        ctrlc::Error::System(error) => Failure::no_thread(error),
        error => Failure::job(format!("cannot handle Ctrl-C: {error}")),
    })
}

/// Sets the action that stops the program in an orderly way, in place of an earlier one, and calls it at once if a signal came
/// before.
pub fn on_stop(action: impl Fn() + Send + Sync + 'static) {
    *lock_action() = Some(Arc::new(action));
    if is_stop_requested() {
        run_action();
    }
}

/// Makes a request end the process at once, while it holds nothing: it waits for an answer or listens.
pub fn end_at_once_on_stop() {
    on_stop(|| {
        // A panic here would abort the process: this also runs while another panic is reported.
        let _ = writeln!(io::stdout());
        exit_unless_panicking();
    });
}

/// Makes a request remove a file that is not complete yet, and end the process at once.
pub fn remove_on_stop(path: &Path) {
    let path = path.to_owned();
    on_stop(move || {
        let _ = fs::remove_file(&path);
        exit_unless_panicking();
    });
}

/// Ends the process, unless this thread has a panic, whose message comes next.
fn exit_unless_panicking() {
    if !thread::panicking() {
        std::process::exit(INTERRUPTED);
    }
}

/// Makes a request only set [`is_stop_requested`], for a step that looks at it or is short.
pub fn only_note_stop() {
    on_stop(|| {});
}

/// Sets the last action before a second request ends the process. Only the first one counts.
pub fn before_exit(action: fn()) {
    let _ = BEFORE_EXIT.set(action);
}

/// Handles a signal or Ctrl-C: stops the program in an orderly way. A program that hangs ends after 3 s, or 1 s after a
/// second request.
pub fn interrupt() {
    if REQUESTED.swap(true, Ordering::SeqCst) {
        exit_after(GRACE);
    }
    let deadline = thread::Builder::new().name("end".into());
    // Without the thread, a second request is the way to end a program that hangs.
    let _ = deadline.spawn(|| exit_after(END_TIMEOUT));
    run_action();
}

/// Calls the last action, and waits 0.2 s for it at most.
pub fn run_last_action() {
    if let Some(action) = BEFORE_EXIT.get() {
        let (end, ended) = bounded::<()>(0);
        let act = move || {
            let _end = end;
            action();
        };
        // On a thread of its own: a terminal that is stopped by Ctrl-S would block it.
        let _ = thread::Builder::new().name("last action".into()).spawn(act);
        let _ = ended.recv_timeout(ACTION_TIMEOUT);
    }
}

fn exit_after(delay: Duration) -> ! {
    thread::sleep(delay);
    run_last_action();
    std::process::exit(INTERRUPTED)
}

/// Stops the program in an orderly way. A second request has no effect.
pub fn request_stop() {
    if !REQUESTED.swap(true, Ordering::SeqCst) {
        run_action();
    }
}

/// Returns `true` after a request.
pub fn is_stop_requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

fn run_action() {
    // An action may take long, and another one may be set while it runs.
    let action = lock_action().clone();
    if let Some(action) = action {
        action();
    }
}

fn lock_action() -> MutexGuard<'static, Option<Arc<dyn Fn() + Send + Sync>>> {
    ACTION.lock().unwrap_or_else(PoisonError::into_inner)
}

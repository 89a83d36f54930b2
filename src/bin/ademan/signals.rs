//! SIGINT (Ctrl-C), SIGTERM and SIGHUP: an orderly end.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crate::failure::Failure;

/// Exit code after a second Ctrl-C.
const INTERRUPTED: i32 = 130;

/// Time for an orderly end before a second Ctrl-C ends the process. Releasing all keys takes a few milliseconds.
const GRACE: Duration = Duration::from_secs(1);

static REQUESTED: AtomicBool = AtomicBool::new(false);
static BEFORE_EXIT: OnceLock<fn()> = OnceLock::new();
static ACTION: OnceLock<Box<dyn Fn() + Send + Sync>> = OnceLock::new();

/// Handles the signals from now on.
pub fn install() -> Result<(), Failure> {
    ctrlc::set_handler(request_stop).map_err(|error| match error {
        ctrlc::Error::System(error) => Failure::no_thread(error),
        error => Failure::job(format!("cannot handle Ctrl-C: {error}")),
    })
}

/// Sets the action that stops the program in an orderly way, and calls it at once if a signal came before. Only the first
/// action counts.
pub fn on_stop(action: impl Fn() + Send + Sync + 'static) {
    let _ = ACTION.set(Box::new(action));
    if is_stop_requested() {
        run_action();
    }
}

/// Sets the last action before a second request ends the process. Only the first one counts.
pub fn before_exit(action: fn()) {
    let _ = BEFORE_EXIT.set(action);
}

/// Stops the program in an orderly way. A second request ends even a program that hangs, after 1 s.
pub fn request_stop() {
    if REQUESTED.swap(true, Ordering::SeqCst) {
        thread::sleep(GRACE);
        if let Some(action) = BEFORE_EXIT.get() {
            action();
        }
        std::process::exit(INTERRUPTED);
    }
    run_action();
}

/// As [`request_stop`], but a second request has no effect.
pub fn request_stop_once() {
    if !is_stop_requested() {
        request_stop();
    }
}

/// Returns `true` after a request.
pub fn is_stop_requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

fn run_action() {
    if let Some(action) = ACTION.get() {
        action();
    }
}

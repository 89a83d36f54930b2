//! Ctrl-C, SIGTERM and SIGHUP end a run in good order.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam_channel::{Receiver, bounded};

use crate::failure::Failure;

/// The exit code of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;
/// What an end in good order may take; letting go of all keys takes a few milliseconds.
const GRACE: Duration = Duration::from_secs(1);

/// Something comes in here when the user or the system wants the program to end. A second request
/// ends it even if it hangs, but leaves the first the time to let go of all keys.
pub fn stop_requests() -> Result<Receiver<()>, Failure> {
    let (sender, stop) = bounded(1);
    let asked = AtomicBool::new(false);
    ctrlc::set_handler(move || {
        if asked.swap(true, Ordering::Relaxed) {
            std::thread::sleep(GRACE);
            std::process::exit(INTERRUPTED);
        }
        // A full channel means that the end is already asked for.
        let _ = sender.try_send(());
    })
    .map_err(|error| Failure::job(format!("cannot listen for Ctrl-C: {error}")))?;
    Ok(stop)
}

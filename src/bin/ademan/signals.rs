//! Ctrl-C, SIGTERM and SIGHUP end a run in good order.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, bounded};

use crate::failure::Failure;
use crate::panics;

/// The exit code of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;
/// What an end in good order may take; letting go of all keys takes a few milliseconds.
const GRACE: Duration = Duration::from_secs(1);

/// Asks the program to end.
#[derive(Clone)]
pub struct Stopper {
    asked: Arc<AtomicBool>,
    sender: Sender<()>,
}

impl Stopper {
    /// One that nobody has asked yet, and where its requests come in.
    pub fn new() -> (Self, Receiver<()>) {
        let (sender, stop) = bounded(1);
        let asked = Arc::default();
        (Self { asked, sender }, stop)
    }

    /// Asks for an end in good order. A second request ends the program even if it hangs, but leaves
    /// the first the time to let go of all keys.
    pub fn ask(&self) {
        if self.is_asked() {
            std::thread::sleep(GRACE);
            std::process::exit(INTERRUPTED);
        }
        self.asked.store(true, Ordering::Relaxed);
        // A full channel means that the end is already asked for.
        let _ = self.sender.try_send(());
    }

    /// The same, but a second request does nothing.
    pub fn ask_once(&self) {
        if !self.is_asked() {
            self.ask();
        }
    }

    /// Whether the end was asked for.
    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }
}

/// Something comes in here when the user or the system wants the program to end.
pub fn stop_requests() -> Result<Receiver<()>, Failure> {
    stopper().map(|(_, stop)| stop)
}

/// As [`stop_requests`], with a hand on the same bell for who else may ring it.
pub fn stopper() -> Result<(Stopper, Receiver<()>), Failure> {
    let (stopper, stop) = Stopper::new();
    panics::ring(&stopper);
    let bell = stopper.clone();
    ctrlc::set_handler(move || bell.ask())
        .map_err(|error| Failure::job(format!("cannot listen for Ctrl-C: {error}")))?;
    Ok((stopper, stop))
}

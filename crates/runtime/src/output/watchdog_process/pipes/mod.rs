//! The watchdog where messages pass through its standard input and output.

mod client_state;
mod releaser;

use std::io::{self, IsTerminal, Write};
use std::sync::Arc;

use super::record::SharedRecord;
use super::release_thread::ReleaseThread;
use super::{AbandonedRelease, ClientLoss};
use crate::output::watchdog::READY;
use crate::priority;
use client_state::ClientState;
use releaser::KeyReleaser;

/// Runs the watchdog: receives messages on the standard input, and releases the keys of the client if it exits or hangs. Returns
/// when the client has exited and its keys are released.
///
/// `log` receives messages for the user and must not block; they do not contain the names of keys.
pub fn run(log: impl Fn(&str) + Send + 'static) -> Result<(), String> {
    if io::stdin().is_terminal() {
        return Err("the watchdog is started by `ademan` itself, not by hand".into());
    }
    // The thread that releases keys inherits it.
    priority::raise_thread_priority();
    let record = Arc::<SharedRecord>::default();
    let mut replies = io::stdout();
    let releases = match ReleaseThread::start(Arc::clone(&record), KeyReleaser::connect, log) {
        Ok(releases) => releases,
        Err(reason) => {
            let _ = replies.write_all(reason.as_bytes());
            return Err(reason);
        }
    };
    let ready = replies.write_all(&[READY]).and_then(|()| replies.flush());
    if ready.is_err() {
        // The program has ended before, or waits no longer. It has pressed nothing.
        return Ok(());
    }
    let client = ClientState::new(io::stdin(), replies, record);
    let mut client = client.map_err(|error| error.to_string())?;
    while client.wait_for_loss() == ClientLoss::Hung {
        releases.release();
    }
    let _ = releases.finish();
    Ok(())
}

/// Releases nothing: there are no records of pressed keys.
pub fn release_abandoned_keys() -> AbandonedRelease {
    AbandonedRelease::default()
}

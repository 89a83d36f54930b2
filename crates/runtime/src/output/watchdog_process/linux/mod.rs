//! The watchdog's main loop: receives messages, and has keys released when the client is lost.

mod abandoned;
mod client_state;
mod releaser;
mod scope;

use std::fs;
use std::io::Write;
use std::os::unix::net::UnixStream;
use std::os::unix::process::parent_id;
use std::sync::Arc;

use crate::output::pressed_key_file::AbandonedKeys;
use crate::output::watchdog::{PROCESS_NAME, READY, ReleaseTarget};
use crate::output::watchdog_process::ClientLoss;
use crate::output::watchdog_process::record::SharedRecord;
use crate::output::watchdog_process::release_thread::ReleaseThread;
use crate::priority;
pub use abandoned::release_abandoned_keys;
use client_state::ClientState;
use releaser::KeyReleaser;

/// Runs the watchdog: receives messages on the standard input, a Unix socket, and releases the keys of the client if it
/// exits or hangs. Returns when the client has exited and its keys are released.
///
/// `log` receives messages for the user and must not block; they do not contain the names of keys.
pub fn run(log: impl Fn(&str) + Send + 'static) -> Result<(), String> {
    // The name of the file is `exe`. Without the folder `/proc` the process could not have been started.
    let _ = fs::write("/proc/self/comm", PROCESS_NAME);
    let stdin = rustix::stdio::stdin().try_clone_to_owned();
    let mut socket = UnixStream::from(stdin.map_err(|error| error.to_string())?);
    if socket.peer_addr().is_err() {
        return Err("the watchdog is started by `ademan` itself, not by hand".into());
    }
    let (target, thread) = ReleaseTarget::receive(&socket)
        .map_err(|error| format!("no handle to release keys with: {error}"))?;
    // The thread that releases keys inherits it.
    priority::raise_thread_priority();
    let process = parent_id();
    let record = Arc::<SharedRecord>::default();
    let connect = move || KeyReleaser::connect(&target);
    let releases = match ReleaseThread::start(Arc::clone(&record), connect, log) {
        Ok(releases) => releases,
        Err(reason) => {
            let _ = socket.write_all(reason.as_bytes());
            return Err(reason);
        }
    };
    if socket.write_all(&[READY]).is_err() {
        // The program has ended before, or waits no longer. It has pressed nothing.
        return Ok(());
    }
    scope::enter();
    let mut client = ClientState::new(socket, thread, Arc::clone(&record));
    while client.wait_for_loss() == ClientLoss::Hung {
        releases.release();
    }
    let is_released = releases.finish();
    let released = record.lock().pressed.clone();
    // After an ordinary end nothing is pressed, and the program removes its file.
    if is_released && released.count() > 0 {
        AbandonedKeys::forget_released(process, &released);
    }
    Ok(())
}

//! The thread that is an IBus engine: it connects, makes the engine the desktop's, and connects again after the daemon has ended.

mod bus;
mod engine;
mod serial;

use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};

use self::bus::Bus;
use self::engine::{End, Engine};
use super::client::{Request, Shared};
use crate::advice;
use crate::output::FieldKind;

/// Longest time in which the daemon answers at the start.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);

/// Time between two attempts to connect again.
const RETRY_PERIOD: Duration = Duration::from_secs(1);

/// Starts the thread and waits until the engine is the desktop's. The thread ends with the requests, and drops `end` then.
pub(super) fn start(
    requests: Receiver<Request>,
    shared: Arc<Shared>,
    end: Sender<()>,
) -> Result<JoinHandle<()>, String> {
    let (connected, connection) = bounded(1);
    let thread = thread::Builder::new()
        .name("input method".into())
        .spawn(move || {
            let _end = end;
            match Bus::connect() {
                Ok(bus) => {
                    let _ = connected.send(Ok(()));
                    run(bus, &requests, &shared);
                }
                Err(reason) => drop(connected.send(Err(reason))),
            }
        })
        .map_err(|error| advice::no_thread(&error).to_string())?;
    match connection.recv_timeout(CONNECT_TIMEOUT) {
        Ok(Ok(())) => Ok(thread),
        Ok(Err(reason)) => Err(reason),
        Err(RecvTimeoutError::Timeout) => Err("the IBus daemon does not answer".into()),
        Err(RecvTimeoutError::Disconnected) => Err("connecting to IBus panicked".into()),
    }
}

fn run(bus: Bus, requests: &Receiver<Request>, shared: &Shared) {
    let mut bus = bus;
    loop {
        let ended = Engine::new(bus, shared).run(requests);
        // It may be a password.
        shared.field.enter(FieldKind::Literal);
        if ended == End::Session {
            return;
        }
        tracing::warn!(
            "IBus has ended: the unfinished word is lost, and text is typed with keys, without corrections, until IBus is back"
        );
        bus = loop {
            if is_session_over(requests, shared) {
                return;
            }
            if let Ok(next) = Bus::connect() {
                tracing::info!("IBus is back");
                break next;
            }
        };
    }
}

/// Drops requests for [`RETRY_PERIOD`]. Returns `true` as soon as the session is over.
fn is_session_over(requests: &Receiver<Request>, shared: &Shared) -> bool {
    let deadline = std::time::Instant::now() + RETRY_PERIOD;
    loop {
        match requests.recv_deadline(deadline) {
            Ok(request) => shared.drop_text(&request.action),
            Err(error) => return error == RecvTimeoutError::Disconnected,
        }
    }
}

//! Looks for a lost device on a thread of its own, less and less often.

use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, after, bounded, never, select};

use super::cancel::CancelToken;
use super::transport::{ConnectError, Connection, Connector, READ_TIMEOUT};

/// The intervals between attempts: 0.1 s, doubling to 2 s.
#[derive(Clone, Debug)]
pub struct BackOff(Duration);

impl BackOff {
    const LONGEST: Duration = Duration::from_secs(2);

    /// The time to wait before the next attempt.
    pub fn next_interval(&mut self) -> Duration {
        let interval = self.0;
        self.0 = (interval * 2).min(Self::LONGEST);
        interval
    }
}

impl Default for BackOff {
    fn default() -> Self {
        Self(Duration::from_millis(100))
    }
}

/// A search that is under way. Dropping it ends it.
pub(super) struct Reconnect {
    findings: Receiver<ReconnectEvent>,
    /// Its end tells the thread to stop.
    _stop: Sender<()>,
}

/// What came of a search.
pub(super) enum ReconnectEvent {
    /// The device is back.
    Connected(Connection),
    /// A device is there that cannot be used, for this reason. Told once per reason.
    Refused(String),
    /// No news.
    Idle,
    /// The search has stopped without a result.
    Stopped,
}

impl Reconnect {
    /// Starts to look, at intervals of `back_off`.
    pub fn start(connector: impl Connector, back_off: BackOff) -> Self {
        let (sender, findings) = bounded(1);
        let (stop, stopped) = bounded(0);
        let thread = std::thread::Builder::new()
            .name("searching".to_owned())
            .spawn(move || search(connector, back_off, &stopped, &sender));
        if let Err(error) = thread {
            tracing::warn!("no thread to look for the device, trying again: {error}");
        }
        Self {
            findings,
            _stop: stop,
        }
    }

    /// Waits for news until `interrupt` rings; without one for [`READ_TIMEOUT`] at most.
    pub fn wait(&self, interrupt: Option<&CancelToken>) -> ReconnectEvent {
        let (rung, timeout) = match interrupt {
            Some(interrupt) => (interrupt.channel().clone(), never()),
            None => (never(), after(READ_TIMEOUT)),
        };
        select! {
            recv(self.findings) -> finding => finding.unwrap_or_else(|_| {
                // The thread died or never was: without a pause its owner would start one after the other.
                std::thread::sleep(READ_TIMEOUT);
                ReconnectEvent::Stopped
            }),
            recv(rung) -> _ => ReconnectEvent::Idle,
            recv(timeout) -> _ => ReconnectEvent::Idle,
        }
    }
}

fn search(
    mut connector: impl Connector,
    mut back_off: BackOff,
    stopped: &Receiver<()>,
    findings: &Sender<ReconnectEvent>,
) {
    let mut told = None;
    while stopped.recv_timeout(back_off.next_interval()) == Err(RecvTimeoutError::Timeout) {
        let finding = match connector.connect() {
            Ok(connection) => ReconnectEvent::Connected(connection),
            Err(ConnectError::Unusable(reason)) if told.as_ref() != Some(&reason) => {
                told = Some(reason.clone());
                ReconnectEvent::Refused(reason)
            }
            Err(_) => ReconnectEvent::Idle,
        };
        let is_over = matches!(finding, ReconnectEvent::Connected(_));
        let is_news = !matches!(finding, ReconnectEvent::Idle);
        if is_news && findings.send(finding).is_err() || is_over {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::empty;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Instant;

    use super::*;

    const LIMIT: Duration = Duration::from_secs(20);

    /// Refuses the first attempts, then opens.
    #[derive(Clone)]
    struct Reluctant {
        attempts: Arc<AtomicUsize>,
        refusals: &'static [&'static str],
    }

    impl Connector for Reluctant {
        const IS_LIVE: bool = true;

        fn connect(&mut self) -> Result<Connection, ConnectError> {
            let attempt = self.attempts.fetch_add(1, Ordering::SeqCst);
            match self.refusals.get(attempt) {
                Some(&"absent") => Err(ConnectError::Absent("not plugged in".to_owned())),
                Some(&reason) => Err(ConnectError::Unusable(reason.to_owned())),
                None => Ok(Connection {
                    bytes: Box::new(empty()),
                    readiness: None,
                    endpoint: format!("port {attempt}"),
                }),
            }
        }
    }

    fn reluctant(refusals: &'static [&'static str]) -> Reluctant {
        Reluctant {
            attempts: Arc::default(),
            refusals,
        }
    }

    #[test]
    fn each_reason_is_told_once_and_the_device_is_found_in_the_end() {
        let connector = reluctant(&["stranger", "stranger", "absent", "stranger", "busy"]);
        let search = Reconnect::start(connector, BackOff(Duration::from_millis(1)));
        let mut told = Vec::new();
        let start = Instant::now();
        while start.elapsed() < LIMIT {
            match search.wait(None) {
                ReconnectEvent::Refused(reason) => told.push(reason),
                ReconnectEvent::Connected(connection) => {
                    told.push(connection.endpoint);
                    break;
                }
                ReconnectEvent::Idle | ReconnectEvent::Stopped => {}
            }
        }
        assert_eq!(told, ["stranger", "busy", "port 5"]);
    }

    #[test]
    fn a_search_that_is_dropped_asks_no_more() {
        let connector = reluctant(&["absent"; 1000]);
        let attempts = connector.attempts.clone();
        let search = Reconnect::start(connector, BackOff(Duration::from_millis(1)));
        while attempts.load(Ordering::SeqCst) == 0 {
            std::thread::yield_now();
        }
        let stopping = search.findings.clone();
        drop(search);
        assert_eq!(
            stopping.recv_timeout(LIMIT).err(),
            Some(RecvTimeoutError::Disconnected)
        );
        let attempts_at_the_end = attempts.load(Ordering::SeqCst);
        std::thread::sleep(Duration::from_millis(50));
        assert_eq!(attempts.load(Ordering::SeqCst), attempts_at_the_end);
    }

    #[test]
    fn the_interval_doubles_up_to_two_seconds() {
        let mut back_off = BackOff::default();
        let intervals = [(); 7].map(|()| back_off.next_interval().as_millis());
        assert_eq!(intervals, [100, 200, 400, 800, 1600, 2000, 2000]);
    }
}

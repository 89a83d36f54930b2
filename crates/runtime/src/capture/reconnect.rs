//! Reconnection to a lost device, with back-off.

use std::time::{Duration, Instant};

use crossbeam_channel::{
    Receiver, RecvTimeoutError, SendError, Sender, TryRecvError, after, bounded, never, select,
};

use super::SourceWait;
use super::cancel::CancelToken;
use super::connection::{ConnectError, Connection, Connector, READ_TIMEOUT};
use super::poll::Readiness;
use super::wake_up::WakeUp;

/// Intervals between attempts: 0.1 s, doubling to 2 s.
#[derive(Clone, Debug)]
pub struct BackOff(Duration);

impl BackOff {
    const MAX: Duration = Duration::from_secs(2);

    /// Returns the time to wait before the next attempt.
    pub fn next_interval(&mut self) -> Duration {
        let interval = self.0;
        self.0 = (interval * 2).min(Self::MAX);
        interval
    }
}

impl Default for BackOff {
    fn default() -> Self {
        Self(Duration::from_millis(100))
    }
}

/// A reconnection in progress on its own thread. Dropping it stops the attempts.
pub(super) struct Reconnect {
    events: Receiver<ReconnectEvent>,
    /// Reports events to a caller that polls. `None` if it has to try.
    notification: Option<(WakeUp, Readiness)>,
    /// Stops the thread when it is dropped.
    _stop: Sender<()>,
}

/// Progress of a reconnection.
pub(super) enum ReconnectEvent {
    /// The connection is open.
    Connected(Connection),
    /// The device is present but unusable, for this reason. Each reason is reported once in a row.
    Unusable(String),
    /// No change.
    Idle,
    /// The thread has ended without a connection.
    Stopped,
}

impl Reconnect {
    /// Starts attempts at the intervals of `back_off`.
    pub fn start(connector: impl Connector, back_off: BackOff) -> Self {
        let (sender, events) = bounded(1);
        let (stop, stopped) = bounded(0);
        let wake_up = WakeUp::new();
        let mut sender = EventSender {
            events: sender,
            notification: Notification(wake_up.clone()),
        };
        let thread = std::thread::Builder::new()
            .name("reconnect".to_owned())
            .spawn(move || reconnect(connector, back_off, &stopped, &mut sender));
        if let Err(error) = &thread {
            tracing::warn!("cannot start a thread to reconnect: {error}; trying again");
        }
        // A thread that does not run reports nothing.
        let wake_up = wake_up.filter(|_| thread.is_ok());
        Self {
            events,
            notification: wake_up.and_then(|it| it.readiness().map(|readiness| (it, readiness))),
            _stop: stop,
        }
    }

    /// Returns the next event. Never waits.
    pub fn try_event(&self) -> ReconnectEvent {
        if let Some((wake_up, _)) = &self.notification {
            wake_up.reset();
        }
        match self.events.try_recv() {
            Ok(event) => event,
            Err(TryRecvError::Empty) => ReconnectEvent::Idle,
            Err(TryRecvError::Disconnected) => ReconnectEvent::Stopped,
        }
    }

    /// Returns what to wait for before [`try_event`](Self::try_event).
    pub fn source_wait(&self) -> SourceWait<'_> {
        let readiness = self.notification.as_ref().map(|(_, readiness)| readiness);
        SourceWait {
            readiness,
            deadline: readiness.is_none().then(|| Instant::now() + READ_TIMEOUT),
        }
    }

    /// Waits for an event until cancellation; without a token for [`READ_TIMEOUT`] at most.
    pub fn wait(&self, cancel: Option<&CancelToken>) -> ReconnectEvent {
        let (cancelled, timeout) = match cancel {
            Some(cancel) => (cancel.channel().clone(), never()),
            None => (never(), after(READ_TIMEOUT)),
        };
        select! {
            recv(self.events) -> event => event.unwrap_or_else(|_| {
                // Without a pause a thread that cannot start would be started again at once.
                std::thread::sleep(READ_TIMEOUT);
                ReconnectEvent::Stopped
            }),
            recv(cancelled) -> _ => ReconnectEvent::Idle,
            recv(timeout) -> _ => ReconnectEvent::Idle,
        }
    }
}

/// Sending end of the events of a reconnection.
struct EventSender {
    events: Sender<ReconnectEvent>,
    // Declared after `events`: the receiver is woken when the channel is already disconnected.
    notification: Notification,
}

impl EventSender {
    fn send(&mut self, event: ReconnectEvent) -> Result<(), SendError<ReconnectEvent>> {
        let sent = self.events.send(event);
        self.notification.notify();
        sent
    }
}

/// Wakes the thread that polls for events, also when it is dropped.
struct Notification(Option<WakeUp>);

impl Notification {
    fn notify(&self) {
        if let Some(wake_up) = &self.0 {
            wake_up.wake();
        }
    }
}

impl Drop for Notification {
    fn drop(&mut self) {
        self.notify();
    }
}

fn reconnect(
    mut connector: impl Connector,
    mut back_off: BackOff,
    stopped: &Receiver<()>,
    events: &mut EventSender,
) {
    let mut last_reason = None;
    while stopped.recv_timeout(back_off.next_interval()) == Err(RecvTimeoutError::Timeout) {
        match connector.connect() {
            Ok(connection) => {
                let _ = events.send(ReconnectEvent::Connected(connection));
                return;
            }
            Err(ConnectError::Unusable(reason)) if last_reason.as_ref() != Some(&reason) => {
                last_reason = Some(reason.clone());
                if events.send(ReconnectEvent::Unusable(reason)).is_err() {
                    return;
                }
            }
            Err(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Empty, empty};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Instant;

    use super::*;
    use crate::capture::connection::ByteStream;
    use crate::output::tests::wait_until;

    const TIMEOUT: Duration = Duration::from_secs(60);

    /// Connector that fails with each of these reasons in turn, then opens.
    #[derive(Clone)]
    struct FailingConnector {
        attempts: Arc<AtomicUsize>,
        reasons: &'static [&'static str],
    }

    impl ByteStream for Empty {}

    impl Connector for FailingConnector {
        const IS_LIVE: bool = true;
        const RECONNECTS: bool = true;

        fn connect(&mut self) -> Result<Connection, ConnectError> {
            let attempt = self.attempts.fetch_add(1, Ordering::SeqCst);
            match self.reasons.get(attempt) {
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

    fn failing(reasons: &'static [&'static str]) -> FailingConnector {
        FailingConnector {
            attempts: Arc::default(),
            reasons,
        }
    }

    #[test]
    fn each_reason_is_reported_once_in_a_row_until_the_connection_opens() {
        let connector = failing(&["other", "other", "absent", "other", "busy"]);
        let reconnect = Reconnect::start(connector, BackOff(Duration::from_millis(1)));
        let mut events = Vec::new();
        let start = Instant::now();
        while start.elapsed() < TIMEOUT {
            match reconnect.wait(None) {
                ReconnectEvent::Unusable(reason) => events.push(reason),
                ReconnectEvent::Connected(connection) => {
                    events.push(connection.endpoint);
                    break;
                }
                ReconnectEvent::Idle | ReconnectEvent::Stopped => {}
            }
        }
        assert_eq!(events, ["other", "busy", "port 5"]);
    }

    #[test]
    fn a_dropped_reconnection_makes_no_more_attempts() {
        let connector = failing(&["absent"; 1000]);
        let attempts = connector.attempts.clone();
        let reconnect = Reconnect::start(connector, BackOff(Duration::from_millis(1)));
        wait_until("an attempt", || attempts.load(Ordering::SeqCst) > 0);
        let events = reconnect.events.clone();
        drop(reconnect);
        assert_eq!(
            events.recv_timeout(TIMEOUT).err(),
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

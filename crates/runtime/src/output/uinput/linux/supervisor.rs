//! The supervisor of the watchdog for the devices: reports, heartbeats and restarts without blocking the loop.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Instant;

use crossbeam_channel::{Receiver, TryRecvError, bounded, never};

use crate::output::watchdog::{
    HEARTBEAT_INTERVAL, MAX_REPLY_AGE, ReleaseTarget, WatchdogClient, WatchdogLost,
    WatchdogSettings,
};
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::{KeyDirection, PressedKeys};

/// A watchdog, what has been reported to it, and its restart. No method blocks after the start.
pub struct WatchdogSupervisor {
    /// `None` while the watchdog restarts.
    client: Option<WatchdogClient>,
    /// Receives the restarted watchdog, or the reason why there is none.
    restarted: Receiver<Result<WatchdogClient, String>>,
    failure: Option<String>,
    reported_keys: PressedKeys,
    is_deflection_reported: bool,
    /// `true` if the watchdog did not accept a message, or does not reply.
    is_unresponsive: bool,
    last_heartbeat: Instant,
    /// The time of the first report after nothing was pressed.
    active_since: Instant,
    /// `true` if the watchdog has released keys of this process while the process did not respond.
    has_released: Arc<AtomicBool>,
}

impl WatchdogSupervisor {
    /// Starts a watchdog and waits until it is ready.
    pub fn start(settings: &WatchdogSettings, target: ReleaseTarget) -> Result<Self, String> {
        let has_released = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&has_released);
        let on_release = Arc::new(move || flag.store(true, Ordering::Release));
        Ok(Self {
            client: Some(WatchdogClient::start(settings, target, on_release)?),
            restarted: never(),
            failure: None,
            reported_keys: PressedKeys::default(),
            is_deflection_reported: false,
            is_unresponsive: false,
            last_heartbeat: Instant::now(),
            active_since: Instant::now(),
            has_released,
        })
    }

    /// Reports a key before its press. Returns `false` if the watchdog does not know of it, or may have released what is
    /// pressed: then it must not be pressed.
    pub fn report_press(&mut self, key: KeyCode) -> bool {
        if self.reported_keys.contains(key) {
            return true;
        }
        if !self.is_state_known() {
            return false;
        }
        let is_reported = self.report(|client| client.report_key(key, KeyDirection::Press));
        if is_reported {
            self.reported_keys.press(key);
        }
        is_reported
    }

    /// Returns `true` if the watchdog has released keys since the last call.
    pub fn take_released(&self) -> bool {
        // A load costs less than an exchange, and is nearly always enough.
        self.has_released.load(Ordering::Acquire) && self.has_released.swap(false, Ordering::AcqRel)
    }

    /// Returns `true` if what is pressed cannot have been released by the watchdog, which a gap between two heartbeats causes.
    fn is_state_known(&mut self) -> bool {
        let now = Instant::now();
        if self.is_idle() {
            self.active_since = now;
        }
        let has_reply = |client: &WatchdogClient| client.has_fresh_reply(now);
        now - self.active_since < MAX_REPLY_AGE || self.client.as_ref().is_none_or(has_reply)
    }

    fn is_idle(&self) -> bool {
        self.reported_keys.is_empty() && !self.is_deflection_reported
    }

    /// Reports that an axis leaves its center, with the result of [`report_press`](Self::report_press).
    pub fn report_deflection(&mut self) -> bool {
        if !self.is_deflection_reported {
            if self.is_idle() {
                self.active_since = Instant::now();
            }
            self.is_deflection_reported = self.report(|client| client.report_axes(true));
        }
        self.is_deflection_reported
    }

    /// Reports the keys that are no longer pressed and the axes if all are centered, and sends a heartbeat if one is
    /// due.
    pub fn report_releases(&mut self, is_pressed: impl Fn(KeyCode) -> bool, is_deflected: bool) {
        if self.is_deflection_reported && !is_deflected {
            self.is_deflection_reported = false;
            self.report(|client| client.report_axes(false));
        }
        if !self.reported_keys.is_empty() {
            let reported = self.reported_keys.clone();
            for key in reported.release_order().filter(|key| !is_pressed(*key)) {
                self.reported_keys.release(key);
                self.report(|client| client.report_key(key, KeyDirection::Release));
            }
        }
        if !self.is_idle() && self.last_heartbeat.elapsed() >= HEARTBEAT_INTERVAL {
            self.last_heartbeat = Instant::now();
            let sent = self.client.as_mut().map(WatchdogClient::send_heartbeat);
            self.is_unresponsive |= sent == Some(Err(WatchdogLost));
        }
    }

    /// Returns `true` if the watchdog is lost: then everything must be released and the watchdog
    /// [restarted](Self::restart).
    pub fn is_lost(&mut self) -> bool {
        match self.restarted.try_recv() {
            Ok(Ok(client)) => self.client = Some(client),
            Ok(Err(reason)) => self.failure = Some(reason),
            // Without a failure every press would be dropped in silence.
            Err(TryRecvError::Disconnected) if self.client.is_none() => {
                let reason = "the restart of the watchdog panicked; start the run again";
                self.failure.get_or_insert_with(|| reason.to_owned());
            }
            Err(_) => {}
        }
        let has_exited =
            |client: &WatchdogClient| client.exited().try_recv() == Err(TryRecvError::Disconnected);
        self.is_unresponsive || self.client.as_ref().is_some_and(has_exited)
    }

    /// Returns the reason why the watchdog will not be restarted.
    pub fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    /// Restarts the watchdog in another thread, as that blocks. Until it is ready nothing is reported, so nothing may
    /// be pressed.
    pub fn restart(&mut self) {
        self.is_unresponsive = false;
        self.reported_keys = PressedKeys::default();
        self.is_deflection_reported = false;
        let Some(mut client) = self.client.take() else {
            return;
        };
        let (sender, restarted) = bounded(1);
        let thread = thread::Builder::new().name("watchdog".into());
        let started = thread.spawn(move || {
            let result = client.restart();
            let _ = sender.send(result.map(|()| client));
        });
        match started {
            Ok(_) => self.restarted = restarted,
            Err(error) => {
                self.failure = Some(format!("cannot start a thread for the watchdog: {error}"));
            }
        }
    }

    fn report(&mut self, send: impl Fn(&WatchdogClient) -> Result<(), WatchdogLost>) -> bool {
        let Some(client) = &self.client else {
            return false;
        };
        let is_accepted = send(client).is_ok();
        self.is_unresponsive |= !is_accepted;
        is_accepted
    }
}

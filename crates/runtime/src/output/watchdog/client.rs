//! The client side: the running watchdog, as the process that started it sees it.

use std::io;
use std::process::Child;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, bounded};

use super::message::{WatchdogLost, WatchdogMessage};
use super::replies::Replies;
use super::system::{Link, ReleaseTarget};
use super::{MAX_UNANSWERED, OnRelease, WatchdogSettings};
use crate::advice;
use crate::output::character_key::{CharacterKey, KeymapChange};
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::KeyDirection;

/// Longest time in which it exits after its connection is closed.
const EXIT_TIMEOUT: Duration = Duration::from_millis(200);

/// Shortest service of a replacement: one that is lost earlier is not replaced, as the next would be lost too.
const MIN_SERVICE: Duration = Duration::from_secs(10);

/// A running watchdog.
pub struct WatchdogClient {
    settings: WatchdogSettings,
    target: ReleaseTarget,
    process: Child,
    link: Link,
    exited: Receiver<()>,
    started: Instant,
    is_replacement: bool,
    on_release: OnRelease,
    replies: Arc<Replies>,
}

impl WatchdogClient {
    /// Starts a watchdog and waits until it is ready to release keys on `target`. On a display, the calling thread must not
    /// end before this is dropped: the watchdog releases keys when it does. Calls `on_release` when the watchdog has
    /// released keys while this process did not respond; it must not block.
    pub fn start(
        settings: &WatchdogSettings,
        target: ReleaseTarget,
        on_release: OnRelease,
    ) -> Result<Self, String> {
        let (process, link) = Link::start(settings).map_err(spawn_error)?;
        let mut watchdog = Self {
            settings: settings.clone(),
            target,
            process,
            link,
            exited: bounded(0).1,
            started: Instant::now(),
            is_replacement: false,
            replies: Arc::new(Replies::new(Arc::clone(&on_release))),
            on_release,
        };
        watchdog
            .link
            .prepare(&watchdog.target)
            .map_err(start_error)?;
        let replies = Arc::clone(&watchdog.replies);
        watchdog.exited = watchdog.link.receive(replies).map_err(spawn_error)?;
        Ok(watchdog)
    }

    /// Reports a key: before a press and after a release.
    #[cfg_attr(
        not(target_os = "linux"),
        expect(dead_code, reason = "only devices of `uinput` report here")
    )]
    pub fn report_key(&self, key: KeyCode, direction: KeyDirection) -> Result<(), WatchdogLost> {
        self.send(WatchdogMessage::from_key(key, direction))
    }

    /// Returns a way to report keys from another thread. It ends with this watchdog.
    pub fn reports(&self) -> WatchdogReports {
        WatchdogReports {
            link: self.link.clone(),
            replies: Arc::clone(&self.replies),
        }
    }

    /// Reports deflected axes: `true` before the first leaves its center, `false` after the last is centered.
    #[cfg_attr(
        not(target_os = "linux"),
        expect(dead_code, reason = "only devices of `uinput` report here")
    )]
    pub fn report_axes(&self, are_deflected: bool) -> Result<(), WatchdogLost> {
        self.send(if are_deflected {
            WatchdogMessage::AxesDeflected
        } else {
            WatchdogMessage::AxesCentered
        })
    }

    /// Sends a heartbeat. Fails if too many have no reply.
    pub fn send_heartbeat(&mut self) -> Result<(), WatchdogLost> {
        if self.replies.unanswered() >= MAX_UNANSWERED {
            return Err(WatchdogLost);
        }
        self.replies.note_heartbeat();
        self.send(WatchdogMessage::Heartbeat)
    }

    /// Returns `true` if a heartbeat that was sent a short time before `now` was answered. Then the watchdog has not
    /// released keys, or has reported it.
    pub fn has_fresh_reply(&self, now: Instant) -> bool {
        self.replies.are_fresh(now)
    }

    /// Sends a heartbeat unless there is a [fresh reply](Self::has_fresh_reply), and waits for the reply until `deadline`.
    /// Returns `true` if it came.
    pub fn wait_for_fresh_reply(&mut self, deadline: Instant) -> Result<bool, WatchdogLost> {
        if self.has_fresh_reply(Instant::now()) {
            return Ok(true);
        }
        self.send_heartbeat()?;
        Ok(self.replies.wait_until_fresh(deadline))
    }

    /// Returns a channel that is closed when the watchdog has exited.
    pub fn exited(&self) -> &Receiver<()> {
        &self.exited
    }

    /// Reports the loss of the watchdog and starts another one; no key may be pressed. Fails if this one is a
    /// replacement that was lost soon.
    pub fn restart(&mut self) -> Result<(), String> {
        (self.settings.on_lost)();
        // A stopped watchdog that continues later would release keys that are pressed then.
        let _ = self.process.kill();
        if self.is_replacement && self.started.elapsed() < MIN_SERVICE {
            return Err(
                "the watchdog was lost a second time within 10 s; start the run again".into(),
            );
        }
        let target = std::mem::take(&mut self.target);
        *self = Self::start(&self.settings, target, Arc::clone(&self.on_release))?;
        self.is_replacement = true;
        Ok(())
    }

    fn send(&self, message: WatchdogMessage) -> Result<(), WatchdogLost> {
        self.link.send(message)
    }
}

/// The reports of keys to a watchdog.
#[derive(Clone)]
pub struct WatchdogReports {
    link: Link,
    replies: Arc<Replies>,
}

impl WatchdogReports {
    /// Reports a key: before a press and after a release.
    pub fn report_key(&self, key: KeyCode, direction: KeyDirection) -> Result<(), WatchdogLost> {
        self.link.send(WatchdogMessage::from_key(key, direction))
    }

    /// Returns the result of [`WatchdogClient::has_fresh_reply`].
    pub fn has_fresh_reply(&self, now: Instant) -> bool {
        self.replies.are_fresh(now)
    }

    /// Reports a change of the keymap: before a key is added and after it is removed.
    pub fn report_character_key(&self, key: CharacterKey, change: KeymapChange) {
        // A lost watchdog shows at the next report of a press.
        let _ = self.link.send(WatchdogMessage::CharacterKey(key, change));
    }
}

impl Drop for WatchdogClient {
    fn drop(&mut self) {
        self.link.close();
        let start = Instant::now();
        while matches!(self.process.try_wait(), Ok(None)) && start.elapsed() < EXIT_TIMEOUT {
            thread::sleep(Duration::from_millis(1));
        }
        // One that still runs releases keys on a display that does not respond; it exits afterwards.
    }
}

fn spawn_error(error: io::Error) -> String {
    match error.kind() {
        // The limit of threads and processes is reached.
        io::ErrorKind::WouldBlock => start_error(advice::no_thread(&error)),
        _ => start_error(error),
    }
}

fn start_error(reason: impl std::fmt::Display) -> String {
    format!("cannot start the watchdog: {reason}")
}

//! The guardian of devices, as the loop has it.
//!
//! The kernel lets go of the keys of a program that has ended, but not of one that is stopped or stands still.

use std::thread;
use std::time::Instant;

use crossbeam_channel::{Receiver, TryRecvError, bounded, never};
use enigo::Direction;

use crate::device::KeyCode;
use crate::output::pressed_keys::PressedKeys;
use crate::output::watchdog::{
    HEARTBEAT_INTERVAL, ReleaseTarget, WatchdogClient, WatchdogSettings,
};

/// A guardian and what it has been told. Nothing here waits, so that the loop may call it.
pub struct WatchdogSupervisor {
    guard: Option<WatchdogClient>,
    /// Another one in the place of one that was lost, or why there is none.
    replaced: Receiver<Result<WatchdogClient, String>>,
    /// Why there will be no guardian any more.
    pub failure: Option<String>,
    noted: PressedKeys,
    is_deflected: bool,
    /// Whether it did not take what it was told.
    is_deaf: bool,
    beat: Instant,
}

impl WatchdogSupervisor {
    /// Starts a guardian and waits until it is ready.
    pub fn start(launch: &WatchdogSettings, means: ReleaseTarget) -> Result<Self, String> {
        Ok(Self {
            guard: Some(WatchdogClient::start(launch, means)?),
            replaced: never(),
            failure: None,
            noted: PressedKeys::default(),
            is_deflected: false,
            is_deaf: false,
            beat: Instant::now(),
        })
    }

    /// Tells that a key goes down. `false` when no guardian knows of it: it could stay down.
    pub fn may_go_down(&mut self, key: KeyCode) -> bool {
        if self.noted.contains(key) {
            return true;
        }
        let may = self.tell(|guard| guard.report_key(key, Direction::Press).is_ok());
        if may {
            self.noted.press(key);
        }
        may
    }

    /// Tells that an axis leaves its rest, as [`may_go_down`](Self::may_go_down).
    pub fn may_be_deflected(&mut self) -> bool {
        if !self.is_deflected {
            self.is_deflected = self.tell(|guard| guard.report_axes(true).is_ok());
        }
        self.is_deflected
    }

    /// Tells of all that has come up by now, and gives a sign of life while something is down.
    pub fn note_rest(&mut self, is_down: impl Fn(KeyCode) -> bool, is_deflected: bool) {
        if self.is_deflected && !is_deflected {
            self.is_deflected = false;
            self.tell(|guard| guard.report_axes(false).is_ok());
        }
        if !self.noted.is_empty() {
            for key in self
                .noted
                .clone()
                .release_order()
                .filter(|key| !is_down(*key))
            {
                self.noted.release(key);
                self.tell(|guard| guard.report_key(key, Direction::Release).is_ok());
            }
        }
        let is_at_rest = self.noted.is_empty() && !self.is_deflected;
        if !is_at_rest && self.beat.elapsed() >= HEARTBEAT_INTERVAL {
            self.beat = Instant::now();
            self.tell(|guard| guard.send_heartbeat().is_ok());
        }
    }

    /// Whether the guardian has gone: what is down is to come up, and it is to be [replaced](Self::replace).
    pub fn is_lost(&mut self) -> bool {
        match self.replaced.try_recv() {
            Ok(Ok(guard)) => self.guard = Some(guard),
            Ok(Err(reason)) => self.failure = Some(reason),
            Err(_) => {}
        }
        let has_ended =
            |guard: &WatchdogClient| guard.exited().try_recv() == Err(TryRecvError::Disconnected);
        self.is_deaf || self.guard.as_ref().is_some_and(has_ended)
    }

    /// Starts another one, elsewhere, as that takes its time. Until it is there nothing may go down.
    pub fn replace(&mut self) {
        self.is_deaf = false;
        self.noted = PressedKeys::default();
        self.is_deflected = false;
        let Some(mut guard) = self.guard.take() else {
            return;
        };
        let (done, replaced) = bounded(1);
        let thread = thread::Builder::new().name("guardian".into());
        let started = thread.spawn(move || {
            let outcome = guard.restart();
            let _ = done.send(outcome.map(|()| guard));
        });
        match started {
            Ok(_) => self.replaced = replaced,
            Err(error) => self.failure = Some(format!("no thread for another guardian: {error}")),
        }
    }

    fn tell(&mut self, word: impl Fn(&WatchdogClient) -> bool) -> bool {
        let is_told = self.guard.as_ref().is_some_and(word);
        // One that is on its way is not deaf.
        self.is_deaf |= !is_told && self.guard.is_some();
        is_told
    }
}

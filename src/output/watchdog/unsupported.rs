//! The stand-in on operating systems that have no watchdog yet.

use std::convert::Infallible;
use std::time::Instant;

use crossbeam_channel::Receiver;

use super::{OnRelease, WatchdogSettings};
use crate::device::KeyCode;
use crate::device::pressed_keys::KeyDirection;
use crate::output::character_key::{CharacterKey, KeymapChange};

/// No handle is passed to another process.
#[derive(Debug, Default)]
pub struct ReleaseTarget;

/// A watchdog that cannot exist.
pub struct WatchdogClient(Infallible);

/// The reports of keys to a watchdog that cannot exist.
#[derive(Clone)]
pub struct WatchdogReports(Infallible);

impl WatchdogReports {
    pub fn report_key(&self, _: KeyCode, _: KeyDirection) -> Result<(), WatchdogLost> {
        match self.0 {}
    }

    pub fn has_fresh_reply(&self, _: Instant) -> bool {
        match self.0 {}
    }

    pub fn report_character_key(&self, _: CharacterKey, _: KeymapChange) {
        match self.0 {}
    }
}

/// The watchdog has exited.
pub struct WatchdogLost;

impl WatchdogClient {
    pub fn start(_: &WatchdogSettings, _: ReleaseTarget, _: OnRelease) -> Result<Self, String> {
        Err("cannot start the watchdog: it needs Linux".into())
    }

    pub fn reports(&self) -> WatchdogReports {
        match self.0 {}
    }

    pub fn send_heartbeat(&mut self) -> Result<(), WatchdogLost> {
        match self.0 {}
    }

    pub fn wait_for_fresh_reply(&mut self, _: Instant) -> Result<bool, WatchdogLost> {
        match self.0 {}
    }

    pub fn exited(&self) -> &Receiver<()> {
        match self.0 {}
    }

    pub fn restart(&mut self) -> Result<(), String> {
        match self.0 {}
    }
}

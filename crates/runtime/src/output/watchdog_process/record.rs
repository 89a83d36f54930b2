//! The keys and axes of the client, shared by the main loop and the release thread.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::output::character_key::AddedKeys;
use crate::output::watchdog::WatchdogMessage;
use ademan_core::device::pressed_keys::PressedKeys;

/// Keys and axes that the client may have pressed or deflected, as reported by its messages.
///
/// A key stays in the record until the client reports its release, also if the watchdog has released it: on a display
/// that hangs, a press of the client can be executed after a release by the watchdog.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The keys.
    pub pressed: PressedKeys,
    /// `true` if an axis is off its center.
    pub are_axes_deflected: bool,
    /// The keys that the client has added to the keymap.
    pub added_keys: AddedKeys,
}

impl Record {
    /// Returns `true` if there is nothing to release.
    pub fn is_empty(&self) -> bool {
        self.pressed.is_empty() && !self.are_axes_deflected
    }

    /// Applies a message of the client.
    pub fn apply(&mut self, message: WatchdogMessage) {
        match message {
            WatchdogMessage::KeyDown(key) => _ = self.pressed.press(key),
            WatchdogMessage::KeyUp(key) => _ = self.pressed.release(key),
            WatchdogMessage::AxesDeflected => self.are_axes_deflected = true,
            WatchdogMessage::AxesCentered => self.are_axes_deflected = false,
            WatchdogMessage::CharacterKey(key, change) => self.added_keys.apply(key, change),
            WatchdogMessage::Heartbeat | WatchdogMessage::Probe => {}
        }
    }
}

/// A record that two threads share, and the state of the client.
#[derive(Debug, Default)]
pub struct SharedRecord {
    record: Mutex<Record>,
    is_client_lost: AtomicBool,
}

impl SharedRecord {
    /// Locks the record.
    pub fn lock(&self) -> MutexGuard<'_, Record> {
        self.record.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns `true` while the client is silent or gone.
    pub fn is_client_lost(&self) -> bool {
        self.is_client_lost.load(Ordering::Acquire)
    }

    /// Sets the state of the client.
    pub fn set_client_lost(&self, is_lost: bool) {
        self.is_client_lost.store(is_lost, Ordering::Release);
    }
}

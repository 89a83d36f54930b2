//! The reports of pressed keys to those who release them if this process cannot.

use std::sync::Arc;
use std::time::Instant;

use crate::output::character_key::{AddedKeys, CharacterKey, KeymapChange};
use crate::output::pressed_key_file::PressedKeyFile;
use crate::output::watchdog::{WatchdogClient, WatchdogReports};
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::KeyDirection;

/// The watchdog, and the file for the case that this process and the watchdog are killed in the same instant.
#[derive(Clone, Default)]
pub struct KeyReporter {
    watchdog: Option<WatchdogReports>,
    file: Option<Arc<PressedKeyFile>>,
    added_keys: AddedKeys,
}

impl KeyReporter {
    /// Creates a reporter to this watchdog and to this file.
    pub fn new(watchdog: Option<&WatchdogClient>, file: Option<PressedKeyFile>) -> Self {
        Self {
            watchdog: watchdog.map(WatchdogClient::reports),
            file: file.map(Arc::new),
            added_keys: AddedKeys::default(),
        }
    }

    /// Replaces the watchdog. Copies keep the earlier one.
    pub fn set_watchdog(&mut self, watchdog: Option<&WatchdogClient>) {
        self.watchdog = watchdog.map(WatchdogClient::reports);
        if let Some(reports) = &self.watchdog {
            for key in self.added_keys.as_slice() {
                reports.report_character_key(*key, KeymapChange::Added);
            }
        }
    }

    /// Returns `false` if the watchdog may have released keys, or may not work, without the knowledge of this process.
    pub fn has_fresh_reply(&self, now: Instant) -> bool {
        let watchdog = self.watchdog.as_ref();
        watchdog.is_none_or(|watchdog| watchdog.has_fresh_reply(now))
    }

    /// Returns `true` if a report may wait for a disk. One to the watchdog never waits.
    pub fn may_wait(&self) -> bool {
        self.file.as_ref().is_some_and(|file| !file.is_in_memory())
    }

    /// Reports a key: before a press and after a release. Returns `false` if the watchdog did not accept the report.
    pub fn report(&self, key: KeyCode, direction: KeyDirection) -> bool {
        if let Some(file) = &self.file {
            file.record(key, direction);
        }
        let report = |watchdog: &WatchdogReports| watchdog.report_key(key, direction).is_ok();
        self.watchdog.as_ref().is_none_or(report)
    }

    /// Reports a change of the keymap: before a key is added and after it is removed.
    #[cfg_attr(
        not(target_os = "linux"),
        allow(
            dead_code,
            reason = "only the connection to an X server on Linux adds keys"
        )
    )]
    pub fn report_character_key(&mut self, key: CharacterKey, change: KeymapChange) {
        self.added_keys.apply(key, change);
        if let Some(file) = &self.file {
            file.record_character_key(key, change);
        }
        if let Some(watchdog) = &self.watchdog {
            watchdog.report_character_key(key, change);
        }
    }

    /// Leaves the file behind at the end: keys could not be released.
    pub fn abandon_file(&self) {
        if let Some(file) = &self.file {
            file.abandon();
        }
    }
}

//! The watchdog: a second, small process that releases keys if this one cannot.
//!
//! An X server keeps a key pressed after its client is gone, a Wayland compositor keeps buttons pressed, and every
//! receiver, including the kernel, keeps the keys of a stopped process pressed. A process that presses keys therefore
//! starts a watchdog and reports every key to it, before the press and after the release. The watchdog releases all
//! pressed keys if the process exits for any reason, or sends no heartbeat for 200 ms while a key is pressed.
//!
//! On X11 the watchdog has a connection of its own. A compositor and the kernel accept a release only from the device
//! that sent the press, so there it has a duplicate of the connection or of the device (see `ReleaseTarget`).

use std::ffi::OsString;
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub(super) use linux::{
    DeviceHandle, READY, ReleaseTarget, WatchdogClient, WatchdogLost, WatchdogMessage,
};

#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
pub(super) use unsupported::{ReleaseTarget, WatchdogClient, WatchdogLost};

/// Interval of the heartbeats while a key is pressed.
pub(super) const HEARTBEAT_INTERVAL: Duration = Duration::from_millis(50);

/// Time without a heartbeat after which the watchdog releases all keys; three heartbeats may be late.
#[cfg_attr(not(target_os = "linux"), expect(dead_code))]
pub(super) const HEARTBEAT_TIMEOUT: Duration = Duration::from_millis(200);

/// The command with which a process starts its watchdog.
#[derive(Clone)]
pub struct WatchdogSettings {
    /// The executable, usually that of this process.
    pub program: PathBuf,
    /// The arguments that make it call [`run_watchdog`](crate::output::run_watchdog).
    pub arguments: Vec<OsString>,
    /// Called when the watchdog has exited unexpectedly, after all keys were released. The watchdog is restarted once.
    /// Must not block.
    pub on_lost: Arc<dyn Fn() + Send + Sync>,
}

impl fmt::Debug for WatchdogSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} {:?}", self.program, self.arguments)
    }
}

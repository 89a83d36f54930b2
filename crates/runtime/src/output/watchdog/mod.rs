//! The watchdog: a second, small process that releases keys if this one cannot.
//!
//! An X server keeps a key pressed after its client is gone, a Wayland compositor keeps buttons pressed, and every
//! receiver, including the kernel, keeps the keys of a stopped process pressed. A process that presses keys therefore
//! starts a watchdog and reports every key to it, before the press and after the release. The watchdog releases all
//! pressed keys if the process exits for any reason, or sends no heartbeat for 200 ms while a key is pressed. It replies
//! to each heartbeat: if it does not for 300 ms, the process releases all keys and replaces it. While no heartbeats are
//! sent, it replies on Linux to a probe every 0.4 s.
//!
//! The reply says whether the watchdog has released keys. After a process was stopped for a moment, its record of pressed keys
//! may be wrong, so it presses a key only if the last reply is recent.
//!
//! On X11 the watchdog has a connection of its own. A compositor and the kernel accept a release only from the device
//! that sent the press, so there it has a duplicate of the connection or of the device (see `ReleaseTarget`).
//!
//! The watchdog leaves the terminal session of the program (on Windows its console), and its control group where a user manager
//! of systemd runs, so that what kills the program by either does not kill both.
//!
//! Windows and macOS let any process release a key, so there the watchdog needs no handle, and pipes replace the socket.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

mod client;
mod message;
mod ready;
mod replies;

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
use linux as system;
#[cfg(target_os = "linux")]
pub(super) use linux::DeviceHandle;
#[cfg(target_os = "linux")]
pub(crate) use linux::scope_name;

#[cfg(not(target_os = "linux"))]
mod pipes;
#[cfg(not(target_os = "linux"))]
use pipes as system;

pub(super) use client::{WatchdogClient, WatchdogReports};
#[cfg(target_os = "linux")]
pub(super) use message::WatchdogLost;
pub(super) use message::{READY, WatchdogMessage, WatchdogReply};
pub(super) use system::ReleaseTarget;

/// Interval of the heartbeats while a key is pressed.
pub(super) const HEARTBEAT_INTERVAL: Duration = Duration::from_millis(50);

/// Time without a heartbeat after which the watchdog releases all keys; three heartbeats may be late.
pub(super) const HEARTBEAT_TIMEOUT: Duration = Duration::from_millis(200);

/// Number of heartbeats without a reply after which the watchdog counts as lost: it has not replied for 300 ms. They are
/// counted instead of timed, as this process may have been stopped itself.
pub(super) const MAX_UNANSWERED: u64 = 6;

/// Interval of the probes while no reply arrives.
#[cfg_attr(not(target_os = "linux"), expect(dead_code))]
pub(super) const PROBE_INTERVAL: Duration = Duration::from_millis(400);

/// Number of probes without a reply after which the watchdog counts as lost.
#[cfg_attr(not(target_os = "linux"), expect(dead_code))]
pub(super) const MAX_UNANSWERED_PROBES: u32 = 3;

/// Age of the last answered heartbeat up to which the watchdog can neither be stopped for long nor have released keys:
/// below [`HEARTBEAT_TIMEOUT`].
pub(super) const MAX_REPLY_AGE: Duration = Duration::from_millis(150);

/// Name of the process. It does not contain the name of the program, so that a signal to all processes of that name
/// (`killall`, `pkill`, `pidof`) does not reach both.
#[cfg_attr(not(target_os = "linux"), expect(dead_code))]
pub(super) const PROCESS_NAME: &str = "key-watchdog";

/// Longest time in which a watchdog connects to the display.
const START_TIMEOUT: Duration = Duration::from_secs(5);

/// Called when the watchdog has released keys of this process, before the process can press another one.
pub(super) type OnRelease = Arc<dyn Fn() + Send + Sync>;

/// The command with which a process starts its watchdog.
#[derive(Clone)]
pub struct WatchdogSettings {
    /// The executable, usually the executable of this process.
    pub program: PathBuf,
    /// The arguments that make it call [`run_watchdog`](crate::output::run_watchdog).
    pub arguments: Vec<OsString>,
    /// Called when the watchdog has exited unexpectedly or does not respond, after all keys were released. The watchdog
    /// is replaced, unless it is lost within 10 s of a replacement. Must not block.
    pub on_lost: Arc<dyn Fn() + Send + Sync>,
}

//! The [watchdog](super::watchdog) process.

mod client_signs;
mod record;
mod release_thread;

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub use linux::{release_abandoned_keys, run};

// Its tests run on any system; the rest of it is used where no handle can be passed.
#[cfg(any(not(target_os = "linux"), test))]
#[cfg_attr(target_os = "linux", allow(dead_code))]
mod pipes;
#[cfg(not(target_os = "linux"))]
pub use pipes::{release_abandoned_keys, run};

use std::time::Duration;

/// Shortest time-out of a wait, so that messages that have already arrived are read before the client counts as hung.
const MIN_READ_TIMEOUT: Duration = Duration::from_millis(1);

/// The loss of the client.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClientLoss {
    /// The process has exited or closed its socket, or the thread that presses keys has ended.
    Exited,
    /// The process has sent no message for [`HEARTBEAT_TIMEOUT`] while a key is pressed.
    Hung,
}

/// The result of [`release_abandoned_keys`].
#[derive(Debug, Default)]
pub struct AbandonedRelease {
    /// The number of released keys.
    pub released: usize,
    /// One line for each record that cannot be used here.
    pub skipped: Vec<String>,
    /// One line for each record whose display cannot be reached, or refused a release. A further call tries again.
    pub failed: Vec<String>,
}

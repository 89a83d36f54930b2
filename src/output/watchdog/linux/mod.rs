//! The client side of the watchdog, and what both sides exchange over a Unix socket pair.

mod client;
mod message;
mod replies;
mod release_target;

pub use client::{WatchdogClient, WatchdogReports};
pub use message::{READY, WatchdogLost, WatchdogMessage, WatchdogReply};
pub use release_target::{DeviceHandle, ReleaseTarget};

/// Returns the name of the systemd scope of the watchdog with this process id.
pub fn scope_name(process: u32) -> String {
    format!("ademan-watchdog-{process}.scope")
}

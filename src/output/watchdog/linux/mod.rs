//! The client side of the watchdog, and what both sides exchange over a Unix socket pair.

mod client;
mod message;
mod release_target;

pub use client::{WatchdogClient, WatchdogLost};
pub use message::{READY, WatchdogMessage};
pub use release_target::{DeviceHandle, ReleaseTarget};

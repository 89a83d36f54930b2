//! The [watchdog](super::watchdog) process.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub use linux::{AbandonedRelease, release_abandoned_keys, run};

#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
pub use unsupported::{AbandonedRelease, release_abandoned_keys, run};

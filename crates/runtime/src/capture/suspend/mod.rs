//! Detection of a system suspend: readings taken before it are stale.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(target_os = "linux"))]
mod unsupported;

#[cfg(target_os = "linux")]
pub(super) use linux::SuspendDetector;
#[cfg(all(test, target_os = "linux"))]
pub(super) use linux::monotonic;
#[cfg(not(target_os = "linux"))]
pub(super) use unsupported::SuspendDetector;

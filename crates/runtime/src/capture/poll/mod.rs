//! Cancellable waits for bytes.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(target_os = "linux"))]
mod unsupported;

#[cfg(target_os = "linux")]
pub use linux::Readiness;
#[cfg(target_os = "linux")]
pub(in crate::capture) use linux::timespec;
#[cfg(not(target_os = "linux"))]
pub use unsupported::Readiness;

//! Waiting for bytes on a file descriptor, cancellable and with an optional timeout.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(target_os = "linux"))]
mod unsupported;

#[cfg(target_os = "linux")]
pub(in crate::capture) use linux::{Readiness, TerminalName, open_to_read};
#[cfg(not(target_os = "linux"))]
pub(in crate::capture) use unsupported::{Readiness, TerminalName, open_to_read};

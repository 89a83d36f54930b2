//! Cancellable waits for bytes, and the identity of the files that are waited on.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(target_os = "linux"))]
mod unsupported;

#[cfg(target_os = "linux")]
pub(super) use linux::{Readiness, TerminalIdentity, open_stdin, open_to_read};
#[cfg(not(target_os = "linux"))]
pub(super) use unsupported::{Readiness, TerminalIdentity, open_stdin, open_to_read};

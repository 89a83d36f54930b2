//! Descriptors whose reads do not block, and the identity of the files behind them.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(target_os = "linux"))]
mod unsupported;

#[cfg(target_os = "linux")]
pub(super) use linux::{TerminalIdentity, open_stdin, open_to_read, read_available};
#[cfg(not(target_os = "linux"))]
pub(super) use unsupported::{TerminalIdentity, open_stdin, open_to_read, read_available};

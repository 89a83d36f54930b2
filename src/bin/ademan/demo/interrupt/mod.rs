//! Ctrl-C in a terminal in raw mode, which sends no signal for it.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(target_os = "linux"))]
mod unsupported;

#[cfg(target_os = "linux")]
pub use linux::{check, discard_input, enable};
#[cfg(not(target_os = "linux"))]
pub use unsupported::{check, discard_input, enable};

//! The client side where no handle can be passed to another process: the watchdog connects to the desktop itself, and messages
//! pass through its standard input and output.
//!
//! The system closes the pipes of a process that ends, however it ends, so the watchdog reads their end.

mod link;

pub use link::Link;

/// No handle is passed to the watchdog.
#[derive(Debug, Default)]
pub struct ReleaseTarget;

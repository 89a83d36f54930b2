//! Signals that the program does not handle: by default most of them end a process.

#[cfg(unix)]
mod unix;
#[cfg(not(unix))]
mod unsupported;

#[cfg(unix)]
use unix as system;
#[cfg(not(unix))]
use unsupported as system;

#[cfg(feature = "tls")]
pub use system::block_background_reads;
pub use system::{block_all, block_emergency_stop, block_unused};

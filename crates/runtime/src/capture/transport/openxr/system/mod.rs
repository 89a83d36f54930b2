//! The loader and the clock of each operating system.

#[cfg(windows)]
mod windows;
#[cfg(windows)]
pub use self::windows::{CLOCK, LOADER, has_clock, use_clock};

#[cfg(not(windows))]
mod unix;
#[cfg(not(windows))]
pub use self::unix::{CLOCK, LOADER, has_clock, use_clock};

//! The abilities of the desktop that the overlay needs.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub use linux::{ability, prefer_x11};

#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
pub use unsupported::{ability, prefer_x11};

/// The kind of window that a desktop can show above the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ability {
    /// Transparent windows.
    Transparent,
    /// Opaque windows: no compositor runs.
    Opaque,
    /// None: no window stays above the others or lets clicks through.
    None,
}

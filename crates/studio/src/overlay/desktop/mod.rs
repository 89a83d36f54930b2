//! The abilities of the desktop that the overlay needs.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub use linux::{ability, prefer_x11};

#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
pub use unsupported::{ability, prefer_x11};

use crate::texts::text;

/// The kind of window that a desktop can show above the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ability {
    /// Transparent windows.
    Transparent,
    /// Opaque windows: no compositor runs. Other systems always compose.
    #[cfg(target_os = "linux")]
    Opaque,
    /// None: no window stays above the others or lets clicks through.
    None,
}

impl Ability {
    /// Returns words for the terminal if the desktop cannot show what was asked for.
    pub fn limitation(self) -> Option<&'static str> {
        match self {
            Self::Transparent => None,
            #[cfg(target_os = "linux")]
            Self::Opaque => Some(text("overlay-opaque")),
            Self::None => Some(text("overlay-window-only")),
        }
    }
}

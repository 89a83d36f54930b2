//! Desktops that always compose windows.

use eframe::EventLoopBuilderHook;

use super::Ability;

/// Returns the ability of the desktop.
pub fn ability() -> Ability {
    Ability::Transparent
}

/// Leaves the choice of the window system to the toolkit.
pub fn prefer_x11() -> Option<EventLoopBuilderHook> {
    None
}

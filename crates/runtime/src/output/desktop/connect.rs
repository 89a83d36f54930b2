//! The connection to the desktop: a Wayland compositor, an X server, or the desktop of Windows or macOS.

use super::injector::Injector;
use super::{wayland, x11};

/// Connects to `display`, or to the desktop of the session.
///
/// If the compositor refuses, there is no fallback to its X server (XWayland), because keys from there do not reach
/// the focused Wayland window.
pub fn connect(display: Option<&str>, needs_pointer: bool) -> Result<Box<dyn Injector>, String> {
    match wayland::compositor(display) {
        Some(name) => wayland::connect(&name, needs_pointer),
        None => x11::connect(display),
    }
}

//! The Wayland side of the output `desktop`; it needs Linux and the feature `wayland`.

use std::env;
use std::ffi::OsString;

#[cfg(all(feature = "wayland", target_os = "linux"))]
mod linux;
#[cfg(all(feature = "wayland", target_os = "linux"))]
pub use linux::connect;
#[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
pub use linux::connect_composing;

#[cfg(not(all(feature = "wayland", target_os = "linux")))]
mod unsupported;
#[cfg(not(all(feature = "wayland", target_os = "linux")))]
pub use unsupported::connect;

/// `true` if this build can connect to a Wayland compositor.
pub const SUPPORTS_WAYLAND: bool = cfg!(all(feature = "wayland", target_os = "linux"));

/// `true` on operating systems that may run a Wayland compositor.
const HAS_COMPOSITORS: bool = cfg!(all(unix, not(target_os = "macos")));

/// Returns the name of the compositor to connect to: `display` unless it has a colon, as the names of X servers do, or
/// else `WAYLAND_DISPLAY`. `None` if there is no compositor.
pub fn compositor(display: Option<&str>) -> Option<OsString> {
    match display {
        _ if !HAS_COMPOSITORS => None,
        Some(display) if display.contains(':') => None,
        Some(display) => Some(display.into()),
        None => env::var_os("WAYLAND_DISPLAY").filter(|name| !name.is_empty()),
    }
}

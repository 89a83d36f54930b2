//! The parts of the output `desktop` that depend on the operating system.

#[allow(
    dead_code,
    reason = "each operating system uses one of its tables, or none"
)]
mod named_keys;

#[cfg(all(unix, not(target_os = "macos")))]
mod unix;
#[cfg(all(unix, not(target_os = "macos")))]
pub use unix::{has_key, inject_key, no_display};

#[cfg(not(all(unix, not(target_os = "macos"))))]
mod named;
#[cfg(not(all(unix, not(target_os = "macos"))))]
pub use named::{has_key, inject_key, no_display};

#[cfg(not(any(target_os = "windows", all(unix, not(target_os = "macos")))))]
use named_keys::MACOS_KEY_CODES as KEY_CODES;
#[cfg(target_os = "windows")]
use named_keys::WINDOWS_KEY_CODES as KEY_CODES;

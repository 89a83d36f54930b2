//! Stand-in for systems on which other keyboards cannot be read.

use ademan_core::device::KeyCode;

/// Fails.
pub(super) fn check(_: &[KeyCode]) -> Result<(), String> {
    Err("not supported on this system".into())
}

/// Fails.
pub(super) fn watch(_: &[KeyCode], _: impl Fn() + Send + 'static) -> Result<(), String> {
    Err("not supported on this system".into())
}

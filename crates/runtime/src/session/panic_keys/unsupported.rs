//! Stand-in for systems on which other keyboards cannot be read.

use std::convert::Infallible;

use ademan_core::device::KeyCode;

/// There is nothing to cancel.
pub(super) type Cancel = Infallible;

/// Fails.
pub(super) fn check(_: &[KeyCode]) -> Result<(), String> {
    Err("not supported on this system".into())
}

/// Fails.
pub(super) fn watch(_: &[KeyCode], _: impl Fn() + Send + 'static) -> Result<Cancel, String> {
    Err("not supported on this system".into())
}

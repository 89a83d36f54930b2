//! What stands in for Wayland in a program that was built without it: it refuses.

use std::ffi::OsStr;

use super::worker::Injector;
use crate::advice;

/// Refuses.
pub fn connect(_: &OsStr, _: bool) -> Result<Box<dyn Injector>, String> {
    Err(advice::built_without_wayland().to_string())
}

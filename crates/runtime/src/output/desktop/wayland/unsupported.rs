//! The stand-in for builds without Wayland support.

use std::ffi::OsStr;

use crate::advice;
use crate::output::desktop::injector::Injector;

/// Returns an error with the advice to use a build that has Wayland support.
pub fn connect(_: &OsStr, _: bool) -> Result<Box<dyn Injector>, String> {
    Err(advice::built_without_wayland().to_string())
}

//! The stand-in on operating systems without `uinput`.

use super::BACKEND;
use crate::output::{OpenRequest, OutputError, Sink};

/// Returns an error.
pub fn open(_: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    Err(unsupported())
}

/// Returns an error.
pub fn check() -> Result<String, OutputError> {
    Err(unsupported())
}

fn unsupported() -> OutputError {
    let reason = "uinput is part of the Linux kernel; use the output `desktop`";
    OutputError::open(BACKEND.name, reason)
}

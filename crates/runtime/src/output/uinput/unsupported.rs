//! The stand-in on operating systems without `uinput`.

use super::BACKEND;
use crate::output::{OpenRequest, OutputError, Sink};

/// Returns an error.
pub fn open(_: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let reason = "uinput is part of the Linux kernel; use the output `desktop`";
    Err(OutputError::open(BACKEND.name, reason))
}

/// Returns an error.
pub fn check() -> Result<String, OutputError> {
    let required = Default::default();
    let request = OpenRequest {
        name: BACKEND.name,
        argument: None,
        required: &required,
        watchdog: None,
    };
    open(&request).map(|_| String::new())
}

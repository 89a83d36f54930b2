//! The stand-in on operating systems without a spacenav server.

use crate::output::{OpenRequest, OutputError, Sink};

/// The reason and the remedy.
const REASON: &str = "it needs Linux; remove it from the outputs";

/// Returns an error.
pub fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    Err(OutputError::open(request.name, REASON))
}

/// Fails as [`open`] does.
pub fn check_presence(_: Option<&str>) -> Result<(), String> {
    Err(REASON.into())
}

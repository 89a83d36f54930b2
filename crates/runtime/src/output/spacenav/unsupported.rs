//! The stand-in on operating systems without a spacenav server.

use crate::output::{OpenRequest, OutputError, Sink};

/// Returns an error.
pub fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let reason = "it needs Linux; remove it from the outputs";
    Err(OutputError::open(request.name, reason))
}

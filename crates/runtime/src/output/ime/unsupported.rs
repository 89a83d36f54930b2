//! The stand-in of builds without an input method.

use crate::output::{OpenRequest, OutputError, Sink};

/// Returns an error.
pub fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let reason = if cfg!(target_os = "linux") {
        "this build has no input method; build it with `--features ime`, or use the output `desktop`"
    } else {
        "it needs Linux; use the output `desktop`"
    };
    Err(OutputError::open(request.name, reason))
}

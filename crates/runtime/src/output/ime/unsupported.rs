//! The stand-in of builds without an input method.

use crate::output::{OpenRequest, OutputError, Sink};

/// The reason why the output cannot be opened, and the remedy.
const REASON: &str = if cfg!(target_os = "linux") {
    "this build has no input method; build it with `--features ime`, or use the output `desktop`"
} else {
    "it needs Linux; use the output `desktop`"
};

/// Returns an error.
pub fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    Err(OutputError::open(request.name, REASON))
}

/// Fails: this build has no input method.
pub fn check_build() -> Result<(), String> {
    Err(REASON.into())
}

//! Systems on which the two programs are started by hand.

use std::process::Child;

use crate::bridge::CameraArgs;
use crate::failure::Failure;

/// Fails with the command that does the same.
pub fn connect(_: &CameraArgs) -> Result<Child, Failure> {
    Err(Failure::job(
        "`ademan webcam` does not run on this system; `ademan bridge webcam --run | ademan run --source \"stdin:?protocol=hand-landmarks\" --layout webcam-mouse` does the same",
    ))
}

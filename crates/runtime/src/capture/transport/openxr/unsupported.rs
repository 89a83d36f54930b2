//! The stand-in of a program without OpenXR.

use std::convert::Infallible;
use std::io::Result;

use super::TrackedHands;
use crate::capture::connection::ConnectError;

const REASON: &str = "this program was built without OpenXR; build it with `--features openxr`";

/// Returns the reason.
pub fn describe_runtime() -> std::result::Result<String, String> {
    Err(REASON.to_owned())
}

/// Never created.
pub struct HandSession(Infallible);

impl HandSession {
    /// Returns the reason.
    pub fn open(_: &str) -> std::result::Result<Self, ConnectError> {
        Err(ConnectError::Unusable(REASON.to_owned()))
    }

    pub fn runtime(&self) -> &str {
        match self.0 {}
    }

    pub fn display_rate_hz(&self) -> Option<u32> {
        match self.0 {}
    }

    pub fn locate(&mut self) -> Result<TrackedHands> {
        match self.0 {}
    }
}

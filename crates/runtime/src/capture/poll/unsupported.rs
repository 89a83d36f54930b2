//! Stand-in for systems without a cancellable wait: each read blocks for its own timeout.

use std::convert::Infallible;
use std::io::Result;
use std::time::Duration;

use crate::capture::cancel::CancelToken;

/// Never created.
#[derive(Debug)]
pub struct Readiness(Infallible);

impl Readiness {
    /// Returns `None`.
    pub fn new<T>(_descriptor: &T) -> Option<Self> {
        None
    }

    /// Never called.
    pub fn poll(&self, _: Option<&CancelToken>, _: Option<Duration>) -> Result<bool> {
        match self.0 {}
    }
}

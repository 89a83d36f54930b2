//! Stand-in for systems without a cancellable wait: sources have a thread of their own.

use std::convert::Infallible;
use std::time::Duration;

use crate::capture::poll::Readiness;

/// Never created.
#[derive(Clone, Debug)]
pub struct WakeUp(Infallible);

impl WakeUp {
    /// Returns `None`.
    pub fn new() -> Option<Self> {
        None
    }

    /// Never called.
    pub fn wake(&self) {
        match self.0 {}
    }

    /// Never called.
    pub fn reset(&self) {
        match self.0 {}
    }

    /// Never called.
    pub fn readiness(&self) -> Option<Readiness> {
        match self.0 {}
    }

    /// Never called.
    pub fn wait(&self, _: Option<&Readiness>, _: Duration) -> bool {
        match self.0 {}
    }
}

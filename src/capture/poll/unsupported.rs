//! Stand-in for systems without a cancellable wait: each read blocks for its own timeout.

use std::convert::Infallible;
use std::fs::File;
use std::io::{Read, Result};
use std::time::Duration;

use crate::capture::cancel::CancelToken;

/// Never created.
pub(in crate::capture) struct Readiness(Infallible);

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

/// Returns `None`: a port is read through its own handle.
pub(in crate::capture) fn open_to_read(_port: &str) -> Option<File> {
    None
}

/// Opens the standard input, whose reads block.
pub(in crate::capture) fn open_stdin() -> Result<(Box<dyn Read + Send>, Option<Readiness>)> {
    Ok((Box::new(std::io::stdin()), None))
}

/// Identity of a pseudo-terminal. It is never known here.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::capture) enum TerminalIdentity {}

impl TerminalIdentity {
    /// Returns `None`.
    pub fn read(_: &str) -> Option<Self> {
        None
    }
}

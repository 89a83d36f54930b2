//! Where nothing can be waited for that somebody may interrupt: each read waits for as long as it may.

use std::convert::Infallible;
use std::fs::File;
use std::io::Result;
use std::time::Duration;

use crate::capture::cancel::CancelToken;

/// There is none.
pub(in crate::capture) struct Readiness(Infallible);

impl Readiness {
    /// None.
    pub fn of<L>(_line: &L) -> Option<Self> {
        None
    }

    /// Never asked.
    pub fn wait(&self, _: Option<&CancelToken>, _: Option<Duration>) -> Result<bool> {
        match self.0 {}
    }
}

/// None.
pub(in crate::capture) fn open_to_read(_place: &str) -> Option<File> {
    None
}

/// The name of a pseudo-terminal; nothing is known of them here.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::capture) enum TerminalName {}

impl TerminalName {
    pub fn of(_: &str) -> Option<Self> {
        None
    }
}

//! What stands in for the socket on systems where it has not been made yet: it is never there.

use std::io;
use std::net::TcpStream;
use std::path::{Path, PathBuf};

use super::ControlError;

const REASON: &str = "the control socket needs Linux";

/// There is none; the type is that of the other streams of these systems.
pub(super) type Stream = TcpStream;

/// No path is usual here.
pub(super) fn default_path() -> Option<PathBuf> {
    None
}

/// There is none.
pub(super) enum Listener {}

impl Listener {
    /// Refuses.
    pub fn open(path: &Path) -> Result<Self, ControlError> {
        Err(ControlError::open(path, REASON))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        match *self {}
    }

    /// The next client.
    pub fn accept(&self) -> io::Result<Stream> {
        match *self {}
    }

    /// Takes the socket away.
    pub fn close(&self) {
        match *self {}
    }
}

/// None can.
pub(super) fn fits(path: &Path) -> Result<(), ControlError> {
    Err(ControlError::open(path, REASON))
}

/// Refuses.
pub(super) fn connect(_: &Path) -> io::Result<Stream> {
    Err(io::Error::new(io::ErrorKind::Unsupported, REASON))
}

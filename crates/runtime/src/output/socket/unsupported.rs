//! The stand-in on operating systems that have no such sockets yet.

use std::fs::File;
use std::io;
use std::net::TcpStream;
use std::path::{Path, PathBuf};

use super::SocketError;

const REASON: &str = "it needs Linux";

/// A stream type for signatures; no connection exists.
pub(crate) type Stream = TcpStream;

/// Returns `None`.
pub(crate) fn default_path(_: &str) -> Option<PathBuf> {
    None
}

/// A socket that cannot exist.
pub(crate) enum Listener {}

impl Listener {
    /// Returns an error.
    pub fn open(_: &Path) -> Result<Self, SocketError> {
        Err(SocketError::Other(REASON.into()))
    }

    pub fn path(&self) -> &Path {
        match *self {}
    }

    pub fn wait_for_client(&self) -> io::Result<()> {
        match *self {}
    }

    pub fn accept(&self) -> io::Result<Stream> {
        match *self {}
    }

    pub fn spare_descriptor(&self) -> io::Result<File> {
        match *self {}
    }

    pub fn close(&self) {
        match *self {}
    }
}

/// Returns an error.
pub(crate) fn connect(_: &Path) -> io::Result<Stream> {
    Err(io::Error::new(io::ErrorKind::Unsupported, REASON))
}

/// Accepts every path.
pub(crate) fn check_path(_: &Path) -> Result<(), SocketError> {
    Ok(())
}

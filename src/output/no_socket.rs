//! What stands in for the socket on systems where it has not been made yet: it is never there.

use std::io;
use std::net::TcpStream;
use std::path::{Path, PathBuf};

const REASON: &str = "it needs Linux";

/// Why a socket cannot be had.
#[derive(Debug, thiserror::Error)]
#[expect(
    dead_code,
    reason = "only a socket that is there can be in use, or its path too long"
)]
pub(crate) enum SocketError {
    /// The path is longer than that of a socket can be.
    #[error("the path has {length} bytes, that of a socket {most} at most")]
    Long { length: usize, most: usize },
    /// A program that is alive listens there.
    #[error("another program listens there")]
    InUse,
    /// It cannot be made.
    #[error("{0}")]
    Other(String),
}

/// There is none; the type is that of the other streams of these systems.
pub(crate) type Stream = TcpStream;

/// No path is usual here.
pub(crate) fn default_path(_: &str) -> Option<PathBuf> {
    None
}

/// There is none.
pub(crate) enum Listener {}

impl Listener {
    /// Refuses.
    pub fn open(_: &Path) -> Result<Self, SocketError> {
        Err(SocketError::Other(REASON.into()))
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

/// Refuses.
pub(crate) fn connect(_: &Path) -> io::Result<Stream> {
    Err(io::Error::new(io::ErrorKind::Unsupported, REASON))
}

/// Where there are no sockets every path fits.
pub(crate) fn fits(_: &Path) -> Result<(), SocketError> {
    Ok(())
}

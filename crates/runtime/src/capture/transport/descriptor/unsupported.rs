//! Stand-in for systems without a cancellable wait: each read blocks for its own timeout.

use std::fs::File;
use std::io::{Read, Result};
use std::net::TcpStream;

use crate::capture::connection::ByteStream;
use crate::capture::poll::Readiness;

/// Returns `None`: a port is read through its own handle.
pub fn open_to_read(_port: &str) -> Option<File> {
    None
}

/// Opens the standard input, whose reads block.
pub fn open_stdin() -> Result<(Box<dyn ByteStream>, Option<Readiness>)> {
    let stdin: Box<dyn Read + Send> = Box::new(std::io::stdin());
    Ok((Box::new(stdin), None))
}

/// Reads until the timeout of the socket.
pub fn read_available(mut stream: &TcpStream, buffer: &mut [u8]) -> Result<usize> {
    stream.read(buffer)
}

/// Identity of a pseudo-terminal. It is never known here.
#[derive(Clone, Debug, PartialEq)]
pub enum TerminalIdentity {}

impl TerminalIdentity {
    /// Returns `None`.
    pub fn read(_: &str) -> Option<Self> {
        None
    }
}

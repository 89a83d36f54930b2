//! The stand-in of a program without zenoh.

use std::convert::Infallible;
use std::io::{self, Read, Write};
use std::net::SocketAddr;

use super::ZenohError;
use crate::network::Stream;

/// Never created.
pub struct Subscriber(Infallible);

impl Subscriber {
    /// Returns the reason.
    pub fn open(_: SocketAddr, _: &str) -> Result<Self, ZenohError> {
        Err(ZenohError::NotBuilt)
    }
}

impl Read for Subscriber {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        match self.0 {}
    }
}

/// Never created.
pub struct Publisher(Infallible);

impl Publisher {
    /// Returns the reason.
    pub fn open(_: SocketAddr, _: &str) -> Result<Self, ZenohError> {
        Err(ZenohError::NotBuilt)
    }
}

impl Stream for Publisher {
    /// No call waits in any case.
    fn set_nonblocking(&self, _: bool) -> io::Result<()> {
        match self.0 {}
    }
}

impl Read for Publisher {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        match self.0 {}
    }
}

impl Write for Publisher {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        match self.0 {}
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.0 {}
    }
}

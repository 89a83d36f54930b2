//! Transports: carriers of byte streams and datagrams.
//!
//! To add a transport, write its file with a [`Transport`] constant and list the constant in [`TRANSPORTS`].

mod file;
pub mod loopback;
#[cfg(unix)]
mod pty;
mod serial;
mod stdin;
mod tcp;
mod udp;
mod usb_port;

use std::io::{Error, ErrorKind, Read, Result};
use std::num::NonZeroU32;
use std::time::Duration;

use super::cancel::CancelToken;
use super::poll::Readiness;
use super::stream::StreamSource;
use super::uri::{Scheme, StreamUri};
use super::{CaptureError, Source};

/// All transports.
pub const TRANSPORTS: &[&Transport] = &[
    &serial::TRANSPORT,
    &tcp::TRANSPORT,
    &udp::TRANSPORT,
    &file::TRANSPORT,
    &stdin::TRANSPORT,
];

/// A carrier of bytes: the form of its URI and how it is opened.
#[derive(Debug)]
pub struct Transport {
    /// Form of its URI.
    pub scheme: Scheme,
    /// Other programs on the network may send readings too.
    pub is_remote: bool,
    /// The device or server may appear after the program has started.
    pub is_device: bool,
    /// The URI has an address.
    pub has_address: bool,
    /// Bit rate if neither the URI nor the protocol states one. `None` if the transport is not a serial line.
    pub default_baud: Option<NonZeroU32>,
    /// Checks an address; an error states what is wrong with it.
    pub(super) check_address: fn(&str) -> std::result::Result<(), String>,
    /// Opens the source.
    pub(super) open: fn(&StreamUri) -> std::result::Result<Box<dyn Source>, CaptureError>,
}

impl PartialEq for Transport {
    fn eq(&self, other: &Self) -> bool {
        self.scheme == other.scheme
    }
}

impl Eq for Transport {}

/// Opens the source of `uri` through `connector`.
fn open_stream(
    uri: &StreamUri,
    connector: impl Connector,
) -> std::result::Result<Box<dyn Source>, CaptureError> {
    let source = StreamSource::open(uri.to_string(), uri.format.clone(), connector)?;
    Ok(Box::new(source))
}

/// Longest time that one read blocks if it cannot be cancelled.
pub(super) const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// Opens a connection, and opens it again after it was lost.
///
/// A clone reconnects on its own thread, because opening may block.
pub(super) trait Connector: Clone + Send + 'static {
    /// Bytes arrive at their own pace. Otherwise readings have nominal times and wait for the consumer.
    const IS_LIVE: bool;

    /// The end of the stream and read errors are a loss, after which the connection is opened again. Otherwise they
    /// end the source.
    const RECONNECTS: bool;

    /// Each read returns a whole datagram, which contains whole packets.
    const IS_DATAGRAM: bool = false;

    /// Size of the read buffer. Longer datagrams are truncated.
    const READ_BYTES: usize = 512;

    /// Longest silence before the connection counts as lost. `None` for no limit.
    const IDLE_TIMEOUT: Option<Duration> = None;

    /// Opens the connection. Its reads block for [`READ_TIMEOUT`] at most; with a [`Readiness`] they do not block.
    fn connect(&mut self) -> std::result::Result<Connection, ConnectError>;
}

/// An open connection.
pub(super) struct Connection {
    /// Bytes received.
    pub bytes: Box<dyn Read + Send>,
    /// Reports when bytes can be read. `None` if a read has to be tried.
    pub readiness: Option<Readiness>,
    /// Port, address or path in use.
    pub endpoint: String,
}

impl Connection {
    /// Reads the bytes that are available, and waits for them until `timeout` or cancellation. A timeout of `None`
    /// blocks indefinitely. The error is [`ErrorKind::WouldBlock`] or [`ErrorKind::TimedOut`] if there are none.
    pub fn read(
        &mut self,
        buffer: &mut [u8],
        cancel: Option<&CancelToken>,
        timeout: Option<Duration>,
    ) -> Result<usize> {
        if let Some(readiness) = &self.readiness
            && !readiness.poll(cancel, timeout)?
        {
            return Err(Error::from(ErrorKind::WouldBlock));
        }
        self.bytes.read(buffer)
    }
}

/// Reason why a connection cannot be opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum ConnectError {
    /// The device is absent, as while a cable is unplugged.
    Absent(String),
    /// The device is present, but its user has to do something before it can be used.
    Unusable(String),
}

impl ConnectError {
    /// Returns the reason as text.
    pub fn into_reason(self) -> String {
        match self {
            Self::Absent(reason) | Self::Unusable(reason) => reason,
        }
    }
}

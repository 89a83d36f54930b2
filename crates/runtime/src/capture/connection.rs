//! Connections that carry bytes, and the trait that opens them.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result, Write};
use std::thread;
use std::time::Duration;

use super::HeadsetList;
use super::cancel::CancelToken;
use super::poll::Readiness;
use super::protocol::{Decoder, StreamFormat};

/// Longest time that one read blocks if it cannot be cancelled.
pub(super) const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// Longest time that one write to a device blocks.
pub(super) const WRITE_TIMEOUT: Duration = Duration::from_millis(50);

/// Kind of the error of a read that dropped a packet of another sender. No read of a socket has it.
pub(super) const UNKNOWN_SENDER: ErrorKind = ErrorKind::PermissionDenied;

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

    /// Several senders can send to it, and a read fails with [`UNKNOWN_SENDER`] when it dropped a packet.
    const HAS_SENDERS: bool = false;

    /// Size of the read buffer. Longer datagrams are truncated.
    const READ_BYTES: usize = 512;

    /// Longest silence before the connection counts as lost. `None` for no limit.
    const IDLE_TIMEOUT: Option<Duration> = None;

    /// Longest silence after the first connection before a warning. `None` for no warning.
    const FIRST_BYTE_TIMEOUT: Option<Duration> = None;

    /// The device may send before the connection is open, so the stream may begin within a packet.
    const STARTS_ANYWHERE: bool = false;

    /// Returns the headsets that are connected, if it waits for headsets.
    fn headsets(&self) -> Option<HeadsetList> {
        None
    }

    /// Creates the decoder of its bytes.
    fn decoder(format: &StreamFormat) -> Box<dyn Decoder> {
        let mut decoder = format.decoder();
        if Self::STARTS_ANYWHERE {
            decoder.start_anywhere();
        }
        decoder
    }

    /// Opens the connection. Its reads block for [`READ_TIMEOUT`] at most; with a [`Readiness`] they do not block.
    fn connect(&mut self) -> std::result::Result<Connection, ConnectError>;
}

/// The bytes of a connection.
pub(super) trait ByteStream: Read + Send {
    /// Returns the other direction of the connection, if it has one. Each write ends within [`WRITE_TIMEOUT`].
    fn writer(&self) -> Option<Box<dyn Write + Send>> {
        None
    }

    /// Returns `true` if a read may block although bytes were reported.
    fn may_block(&self) -> bool {
        false
    }

    /// Returns `true` if bytes of another sender were read since the previous call. The default, for connections with one sender, is
    /// `false`.
    fn take_sender_change(&mut self) -> bool {
        false
    }

    /// Accepts the sender of the latest read, whose bytes completed a valid packet: no other sender is read until this one is silent.
    /// Returns `true` if it is another one than the sender that was accepted before. The default, for connections with one sender, is
    /// `false`.
    fn accept_sender(&mut self) -> bool {
        false
    }
}

impl ByteStream for File {}

impl ByteStream for Box<dyn Read + Send> {}

/// An open connection.
pub(super) struct Connection {
    /// Bytes received.
    pub bytes: Box<dyn ByteStream>,
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

    /// Reads the bytes that are available, without waiting for them. Fails as [`read`](Self::read) does.
    pub fn read_available(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let result = self.bytes.read(buffer);
        if let Err(error) = &result
            && error.kind() == ErrorKind::WouldBlock
            && let Some(readiness) = &self.readiness
        {
            // A device that hung up has no bytes, and is always reported as ready: `poll` returns its error.
            readiness.poll(None, Some(Duration::ZERO))?;
        }
        result
    }

    /// Returns `true` if reads never block, and something reports when bytes can be read.
    pub fn can_be_polled(&self) -> bool {
        self.readiness.is_some() && !self.bytes.may_block()
    }
}

/// Reason why a connection cannot be opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum ConnectError {
    /// The device is absent, for example because its cable is unplugged.
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

/// Returns `true` if an error of a read means that there are no bytes yet.
pub fn is_idle(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::Interrupted | ErrorKind::WouldBlock | ErrorKind::TimedOut
    )
}

/// Closes a connection on its own thread: closing the port of an absent device can block for seconds.
pub fn close_on_thread(lost: impl Send + 'static) {
    let thread = thread::Builder::new()
        .name("close".to_owned())
        .spawn(move || drop(lost));
    if let Err(error) = thread {
        tracing::debug!("cannot start a thread, the port was closed in place: {error}");
    }
}

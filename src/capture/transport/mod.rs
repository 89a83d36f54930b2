//! What a kind of line has to know: how it is opened.

pub(in crate::capture) mod file;
pub mod loopback;
#[cfg(unix)]
mod pty;
pub(in crate::capture) mod serial;
pub(in crate::capture) mod tcp;
mod usb_port;

use std::io::{Error, ErrorKind, Read, Result};
use std::time::Duration;

use crate::capture::cancel::CancelToken;
use crate::capture::poll::Readiness;

/// The longest time that one read may block where it cannot be interrupted.
pub(in crate::capture) const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// How a line is opened, and opened again after it was lost.
///
/// A clone of it looks for the lost device on a thread of its own, because opening may block.
pub(in crate::capture) trait Connector: Clone + Send + 'static {
    /// Whether bytes come at their own pace and the end of the stream is a loss. A line that is not live
    /// ends with its stream, and its time is that of the nominal baud.
    const IS_LIVE: bool;

    /// How long a connection may be silent before it counts as lost.
    const IDLE_TIMEOUT: Option<Duration> = None;

    /// Opens the line. Its reads block for [`READ_TIMEOUT`] at most, or not at all where it says when it is ready.
    fn connect(&mut self) -> std::result::Result<Connection, ConnectError>;
}

/// An open line.
pub(in crate::capture) struct Connection {
    /// The bytes that come in.
    pub bytes: Box<dyn Read + Send>,
    /// Says when there are some; `None` where a read has to be tried.
    pub readiness: Option<Readiness>,
    /// Where it was found: the port or address in use.
    pub endpoint: String,
}

impl Connection {
    /// Reads what there is, and waits for it where need be: for `patience` at most and only until `interrupt` rings,
    /// without a patience for good. Nothing by then is [`ErrorKind::WouldBlock`] or [`ErrorKind::TimedOut`].
    pub fn read(
        &mut self,
        buffer: &mut [u8],
        interrupt: Option<&CancelToken>,
        patience: Option<Duration>,
    ) -> Result<usize> {
        if let Some(readiness) = &self.readiness
            && !readiness.wait(interrupt, patience)?
        {
            return Err(Error::from(ErrorKind::WouldBlock));
        }
        self.bytes.read(buffer)
    }
}

/// Why a line does not open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::capture) enum ConnectError {
    /// It is not there: what is usual while a cable is out.
    Absent(String),
    /// It is there and cannot be used before its user does something.
    Unusable(String),
}

impl ConnectError {
    pub fn into_reason(self) -> String {
        match self {
            Self::Absent(reason) | Self::Unusable(reason) => reason,
        }
    }
}

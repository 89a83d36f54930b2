//! What a kind of line has to know: how it is opened.

use std::io::Read;
use std::time::Duration;

/// The longest time that one read may block.
pub(super) const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// How a line is opened, and opened again after it was lost.
///
/// A clone of it looks for the lost device on a thread of its own, because opening may block.
pub(super) trait Connect: Clone + Send + 'static {
    /// Whether bytes come at their own pace and the end of the stream is a loss. A line that is not live
    /// ends with its stream, and its time is that of the nominal baud.
    const LIVE: bool;

    /// How long a connection may be silent before it counts as lost.
    const SILENCE_LIMIT: Option<Duration> = None;

    /// Opens the line. Its reads block for [`READ_TIMEOUT`] at most.
    fn connect(&mut self) -> Result<Connection, Refusal>;
}

/// An open line.
pub(super) struct Connection {
    /// The bytes that come in.
    pub bytes: Box<dyn Read + Send>,
    /// Where it was found: the port or address in use.
    pub place: String,
}

/// Why a line does not open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It is not there: what is usual while a cable is out.
    Absent(String),
    /// It is there and cannot be used before its user does something.
    Unusable(String),
}

impl Refusal {
    pub fn into_reason(self) -> String {
        match self {
            Self::Absent(reason) | Self::Unusable(reason) => reason,
        }
    }
}

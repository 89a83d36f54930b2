//! 1 · A sensor → [`Reading`].
//!
//! A [`SourceName`] says where readings come from, [`open`] makes a [`Source`] of it, [`on_thread`] lets that run
//! by itself:
//!
//! ```no_run
//! use ademan::capture::{Arrival, SourceName, on_thread, open};
//!
//! let name: SourceName = "serial:/dev/ttyUSB0?protocol=hc11&baud=9600".parse()?;
//! let captured = on_thread(open(&name)?)?;
//! for arrival in captured.arrivals() {
//!     match arrival {
//!         Arrival::Reading { reading, .. } => println!("{reading:?}"),
//!         Arrival::Lost(error) | Arrival::Failed(error) => eprintln!("{error}"),
//!         Arrival::Noise(counts) | Arrival::End(counts) => println!("{counts:?}"),
//!     }
//! }
//! # Ok::<(), ademan::capture::CaptureError>(())
//! ```

pub mod uri;
pub mod protocol;
pub mod transport;
pub mod cancel;
mod poll;
mod packet_clock;
mod garbage;
mod reconnect;
mod stream;
pub mod recording;
pub mod pace;
mod suspend;
pub mod thread;
mod merge;
#[cfg(test)]
mod test_random;

use std::time::Duration;

use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};

use crate::hand::{JointAngles, Side};
use crate::time::Timestamp;

pub use cancel::CancelToken;
pub use merge::MergedSource;
pub use pace::PacedSource;
pub use protocol::hc11;
pub use reconnect::BackOff;
pub use thread::{CaptureEvent, CaptureThread, spawn};
pub use transport::loopback::{self, Loopback, open_loopback};
pub use uri::{Protocol, SourceUri, StreamOptions};

use stream::StreamSource;
use transport::file::FileConnector;
use transport::serial::SerialConnector;
use transport::tcp::TcpConnector;

/// Opens a source whose bytes come over a line: `serial:`, `tcp:` or `file:`.
///
/// Recordings and the simulated hand are made by modules of their own; their names are refused.
pub fn open(name: &SourceUri) -> Result<Box<dyn Source>, CaptureError> {
    let text = name.to_string();
    match name {
        SourceUri::Serial { port, line } => {
            let connector = SerialConnector::new(port, line.baud.get());
            Ok(Box::new(StreamSource::open(text, *line, connector)?))
        }
        SourceUri::Tcp { address, line } => {
            let connector = TcpConnector::new(address);
            Ok(Box::new(StreamSource::open(text, *line, connector)?))
        }
        SourceUri::File { path, line } => {
            let connector = FileConnector::new(path);
            Ok(Box::new(StreamSource::open(text, *line, connector)?))
        }
        SourceUri::Recording { .. } | SourceUri::Typist { .. } | SourceUri::Script { .. } => {
            Err(CaptureError::InvalidUri {
                text,
                reason: "it is not a line of bytes; use a `serial:`, `tcp:` or `file:` source"
                    .to_owned(),
            })
        }
    }
}

/// Whether asking for the serial ports is safe: on Linux, `serialport` panics where the kernel's list is not mounted.
fn lists_serial_ports() -> bool {
    !cfg!(target_os = "linux") || std::path::Path::new("/sys/class/tty").is_dir()
}

/// The most channels that one reading carries: the eight converters of the HC11 glove, eight inputs each.
pub const MAX_CHANNELS: usize = 64;

/// What a sensor saw at one moment.
///
/// Written as `{"time_us":12500,"full_scale":255,"channels":[3,141,…]}`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// When it was complete.
    #[serde(rename = "time_us")]
    pub time: Timestamp,
    /// Of which hand it is, where a source has both; else of the only one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<Side>,
    /// The values.
    #[serde(flatten)]
    pub sample: Sample,
}

/// The values of a reading, by kind of sensor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Sample {
    /// One count per sensor channel.
    Channels(Channels),
    /// Joint angles.
    Angles {
        /// The angles that the source provides, in radians.
        #[serde(rename = "angles_rad")]
        angles: JointAngles,
    },
}

/// Counts of an analogue-to-digital converter, in wire order.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Channels {
    /// The largest count that the converter can give (255 for 8 bits).
    pub full_scale: u16,
    /// One count per channel, 0..=`full_scale`.
    #[serde(rename = "channels")]
    pub counts: ArrayVec<u16, MAX_CHANNELS>,
}

/// What a source has to say when it is asked for the next reading.
#[derive(Clone, Debug, PartialEq)]
pub enum SourceEvent {
    /// A reading.
    Reading(Reading),
    /// Nothing for the moment; ask again.
    Idle,
    /// The stream is over; there will be no more.
    End,
}

/// A sensor, a stream or a recording.
pub trait Source: Send {
    /// The next reading.
    ///
    /// May block, but answers within [`PATIENCE`], with [`Capture::Quiet`] when there is nothing, so that
    /// its thread can be stopped; one that [heeds](Self::heed) an interrupt answers at the latest when it rings.
    /// After a [recoverable](CaptureError::is_recoverable) error it may be
    /// asked again: a source that was lost looks for its device at each call.
    fn next(&mut self) -> Result<SourceEvent, CaptureError>;

    /// Takes what rings when the thread of the source is to stop: from then on the source may wait for as long as
    /// there is nothing, so that a sensor at rest costs nothing. By default it is not heeded.
    fn set_cancel_token(&mut self, cancel: &CancelToken) {
        let _ = cancel;
    }

    /// The source as its user named it.
    fn name(&self) -> &str;

    /// The time between two readings, where the source knows it.
    fn packet_period(&self) -> Option<Duration> {
        None
    }

    /// Whether readings come at their own pace and are lost when nobody takes them.
    fn is_live(&self) -> bool {
        true
    }

    /// What has come in so far.
    fn stats(&self) -> SourceStats {
        SourceStats::default()
    }
}

impl Source for Box<dyn Source> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        (**self).next()
    }

    fn set_cancel_token(&mut self, cancel: &CancelToken) {
        (**self).set_cancel_token(cancel);
    }

    fn name(&self) -> &str {
        (**self).name()
    }

    fn packet_period(&self) -> Option<Duration> {
        (**self).packet_period()
    }

    fn is_live(&self) -> bool {
        (**self).is_live()
    }

    fn stats(&self) -> SourceStats {
        (**self).stats()
    }
}

/// The longest time that [`Source::next`] blocks, unless the source heeds an interrupt.
pub const MAX_BLOCK: Duration = Duration::from_millis(100);

/// What came in at a source: every byte and every reading is in exactly one place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SourceStats {
    /// Bytes received.
    pub bytes: u64,
    /// Bytes that belong to no frame: noise, cut frames, resynchronisation.
    pub skipped_bytes: u64,
    /// Times that decoding had to look for the next frame.
    pub resyncs: u64,
    /// Readings that came out.
    pub readings: u64,
    /// Readings that were replaced by a newer one before anybody took them, or still waited at the end.
    pub dropped: u64,
    /// Times that the device was lost.
    pub losses: u64,
}

/// Why a source gives no reading. Each text says what was tried, what happened and what to do.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// The text does not name a source.
    #[error("cannot read `{text}` as a source: {reason}")]
    InvalidUri {
        /// The text as given.
        text: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The device or file cannot be opened.
    #[error("cannot open {source_name}: {reason}")]
    Open {
        /// The source as named.
        source_name: String,
        /// What happened and what to do.
        reason: String,
    },
    /// The device was there and is gone; the source keeps looking for it.
    #[error("lost {source_name}: {reason}; looking for it")]
    Lost {
        /// The source as named.
        source_name: String,
        /// What happened.
        reason: String,
    },
    /// What came before and what comes now may have nothing to do with each other.
    #[error("{source_name} was interrupted: {reason}; hold the hand off all keys for a moment")]
    Interrupted {
        /// The source as named.
        source_name: String,
        /// What happened.
        reason: String,
    },
    /// What came in cannot be used.
    #[error("cannot use {source_name}: {reason}")]
    Malformed {
        /// The source as named.
        source_name: String,
        /// Where and why.
        reason: String,
    },
}

impl CaptureError {
    /// Whether the source goes on trying, so that it may be asked again.
    pub fn is_recoverable(&self) -> bool {
        matches!(self, Self::Lost { .. } | Self::Interrupted { .. })
    }
}

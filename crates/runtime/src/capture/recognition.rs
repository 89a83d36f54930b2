//! Recognition of what a serial port sends, by its bytes alone.

use std::num::NonZeroU32;
use std::time::{Duration, Instant};

use super::SourceUri;
use super::protocol::StreamFormat;
use super::stream::unknown_bytes::UnknownBytes;
use super::transport::{StreamUri, serial};

pub use super::transport::serial::port_names;

/// Longest time until a device sends: some restart when their port is opened.
const LISTEN_TIME: Duration = Duration::from_secs(4);

/// Bytes after which a format is recognized.
const ENOUGH_BYTES: usize = 400;

/// The source that the bytes of a serial port look like.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Recognition {
    /// Packets of one of these sources, which differ only in their format.
    Sources(Vec<SourceUri>),
    /// Bytes of no known format: their number.
    Unknown(usize),
    /// No bytes.
    Silent,
}

/// Listens to a serial port for a few seconds. An error states the reason and the remedy.
pub fn recognize(port: &str) -> Result<Recognition, String> {
    let mut baud = serial::DEFAULT_BAUD;
    let mut heard = listen(port, baud)?;
    let mut formats = heard.likely_formats();
    if formats.is_empty()
        && let Some(slower) = heard.slower_sender(baud)
    {
        baud = slower;
        heard = listen(port, baud)?;
        formats = heard.likely_formats();
    }
    if formats.is_empty() {
        return Ok(match heard.len() {
            0 => Recognition::Silent,
            bytes => Recognition::Unknown(bytes),
        });
    }
    let source = |format| {
        let format = StreamFormat {
            baud: Some(baud),
            ..format
        };
        SourceUri::Stream(StreamUri::new(&serial::TRANSPORT, port.to_owned(), format))
    };
    Ok(Recognition::Sources(
        formats.into_iter().map(source).collect(),
    ))
}

/// Returns the first bytes of a port: until a format is recognized, for at most [`LISTEN_TIME`].
fn listen(port: &str, baud: NonZeroU32) -> Result<UnknownBytes, String> {
    let start = Instant::now();
    let mut heard = UnknownBytes::new(false);
    let (mut total, mut tried) = (0, 0);
    serial::listen(port, baud, |bytes| {
        let now = Instant::now();
        heard.update(now, false, bytes);
        total += bytes.len();
        if total >= tried + ENOUGH_BYTES {
            tried = total;
            if !heard.likely_formats().is_empty() {
                return false;
            }
        }
        now.duration_since(start) < LISTEN_TIME
    })?;
    Ok(heard)
}

//! Protocols whose packets are whole datagrams.

use super::{Decoder, InvalidPacket, Packet, PacketError};
use crate::capture::SourceStats;

/// Parser of a datagram. The ends of the packets are filled in later.
pub trait DatagramParser: Send {
    /// Longest datagram in bytes. A longer one is invalid.
    const MAX_BYTES: usize;

    /// Parses a datagram and passes its packets to `emit`; a valid datagram may have none.
    ///
    /// Returns the error of a part that was left out in `Ok`.
    fn parse(
        &mut self,
        datagram: &[u8],
        emit: &mut dyn FnMut(Packet),
    ) -> Result<Option<PacketError>, PacketError>;

    /// Forgets earlier datagrams, after the source was lost.
    fn reset(&mut self) {}
}

/// Decoder of datagrams. The bytes since the start, [`finish`](Decoder::finish) or [`reset`](Decoder::reset) are one
/// datagram.
#[derive(Clone, Debug)]
pub struct DatagramDecoder<P> {
    parser: P,
    /// The datagram so far, at most `MAX_BYTES`.
    datagram: Vec<u8>,
    /// Length of the datagram so far, including the bytes that do not fit.
    length: usize,
    stats: SourceStats,
    last_error: Option<PacketError>,
}

impl<P: DatagramParser> DatagramDecoder<P> {
    /// Creates a decoder before the first datagram.
    pub(super) fn with_parser(parser: P) -> Self {
        Self {
            parser,
            datagram: Vec::with_capacity(P::MAX_BYTES),
            length: 0,
            stats: SourceStats::default(),
            last_error: None,
        }
    }
}

impl<P: DatagramParser> Decoder for DatagramDecoder<P> {
    fn push(&mut self, bytes: &[u8], _emit: &mut dyn FnMut(Packet)) {
        self.stats.bytes += bytes.len() as u64;
        self.length += bytes.len();
        let room = P::MAX_BYTES - self.datagram.len();
        self.datagram
            .extend_from_slice(&bytes[..bytes.len().min(room)]);
    }

    fn finish(&mut self, emit: &mut dyn FnMut(Packet)) {
        if self.length == 0 {
            return;
        }
        let end = self.stats.bytes;
        let mut packets = 0;
        let result = if self.length > P::MAX_BYTES {
            Err(PacketError::new(
                InvalidPacket::WrongSize,
                format!("{} bytes, more than {}", self.length, P::MAX_BYTES),
            ))
        } else {
            self.parser.parse(&self.datagram, &mut |packet| {
                packets += 1;
                emit(Packet { end, ..packet });
            })
        };
        self.stats.readings += packets;
        if result.is_err() {
            self.stats.skipped_bytes += self.length as u64;
        }
        self.last_error = result.unwrap_or_else(Some);
        if let Some(error) = &self.last_error {
            self.stats.invalid.count(error.reason);
        }
        self.datagram.clear();
        self.length = 0;
    }

    fn reset(&mut self) {
        self.stats.skipped_bytes += self.length as u64;
        self.datagram.clear();
        self.length = 0;
        self.parser.reset();
    }

    fn pending_bytes(&self) -> usize {
        self.length
    }

    fn stats(&self) -> SourceStats {
        self.stats
    }

    fn last_error(&self) -> Option<&PacketError> {
        self.last_error.as_ref()
    }
}

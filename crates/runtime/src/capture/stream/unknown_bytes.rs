//! Bytes that form no packet: for how long they have arrived, and which format or bit rate they look like.

use std::num::NonZeroU32;
use std::time::Instant;

use super::bit_rate;
use crate::capture::SourceStats;
use crate::capture::garbage::{GarbageDetector, InvalidDetector};
use crate::capture::protocol::{Carriers, PROTOCOLS, StreamFormat, hc11};

/// Most bytes that are kept: packets of each protocol, of a fast line in 0.3 s.
const CAPACITY: usize = 4096;

/// Most datagrams that are kept.
const MAX_DATAGRAMS: usize = 64;

/// The bytes since the latest packet.
pub struct UnknownBytes {
    detector: GarbageDetector,
    invalid: InvalidDetector,
    /// The first of the bytes.
    bytes: Vec<u8>,
    /// The ends of datagrams in `bytes`; none of a stream.
    ends: Vec<usize>,
    is_datagram: bool,
}

impl UnknownBytes {
    /// Creates an empty store, of whole datagrams or of a stream.
    pub fn new(is_datagram: bool) -> Self {
        Self {
            detector: GarbageDetector::default(),
            invalid: InvalidDetector::default(),
            bytes: Vec::with_capacity(CAPACITY),
            ends: Vec::with_capacity(if is_datagram { MAX_DATAGRAMS } else { 0 }),
            is_datagram,
        }
    }

    /// Handles bytes that arrived at `now`. Returns `true` if a warning is due. Does not allocate.
    pub fn update(&mut self, now: Instant, has_packet: bool, bytes: &[u8]) -> bool {
        if has_packet {
            self.forget()
        } else {
            self.keep(bytes)
        }
        self.detector.update(now, has_packet)
    }

    /// Handles the statistics of the decoder. Returns `true` if a warning is due that nearly all packets are invalid.
    pub fn update_invalid(&mut self, now: Instant, stats: &SourceStats) -> bool {
        (self.invalid).update(now, stats.readings, stats.invalid.total())
    }

    /// Forgets all bytes, and for how long they have arrived.
    pub fn clear(&mut self) {
        self.detector = GarbageDetector::default();
        self.invalid = InvalidDetector::default();
        self.forget();
    }

    fn forget(&mut self) {
        self.bytes.clear();
        self.ends.clear();
    }

    fn keep(&mut self, bytes: &[u8]) {
        let room = CAPACITY - self.bytes.len();
        if !self.is_datagram {
            self.bytes
                .extend_from_slice(&bytes[..bytes.len().min(room)]);
        } else if bytes.len() <= room && self.ends.len() < MAX_DATAGRAMS {
            self.bytes.extend_from_slice(bytes);
            self.ends.push(self.bytes.len());
        }
    }

    /// Returns what the bytes look like and what to do, such as `looks like LucidGloves: add protocol=lucidgloves`. `None` if no
    /// protocol fits better than `format`, and no other bit rate does.
    pub fn likely_format(&self, format: &StreamFormat) -> Option<String> {
        self.likely_protocols(format)
            .or_else(|| self.likely_bit_rate(format))
    }

    /// Returns the formats that decode the largest number of bytes, all of them equally many, if that is at least half of the bytes.
    pub fn likely_formats(&self) -> Vec<StreamFormat> {
        self.best_of(candidates(self.is_datagram))
    }

    fn best_of(&self, formats: impl Iterator<Item = StreamFormat>) -> Vec<StreamFormat> {
        let tried = formats.map(|format| (self.understood(&format), format));
        let tried: Vec<(usize, StreamFormat)> = tried.collect();
        let most = tried.iter().map(|(understood, _)| *understood).max();
        let most = most.unwrap_or_default();
        if most * 2 < self.bytes.len() || most == 0 {
            return Vec::new();
        }
        let best = tried.into_iter();
        let best = best.filter(|(understood, _)| *understood == most);
        best.map(|(_, format)| format).collect()
    }

    fn likely_protocols(&self, format: &StreamFormat) -> Option<String> {
        let others = candidates(self.is_datagram).filter(|other| is_other(other, format));
        let likely = self.best_of(others);
        if likely.is_empty() {
            return None;
        }
        let titles: Vec<&str> = likely.iter().map(|other| other.protocol.title()).collect();
        let options: Vec<String> = likely.iter().map(options).collect();
        let verb = if format.protocol == PROTOCOLS[0] {
            "add"
        } else {
            "set"
        };
        Some(format!(
            "looks like {}: {verb} {}",
            titles.join(" or "),
            options.join(" or ")
        ))
    }

    /// Returns the number of bytes that are packets of a format.
    fn understood(&self, format: &StreamFormat) -> usize {
        let mut decoder = format.decoder();
        let mut packets = 0;
        let mut start = 0;
        let stream = [self.bytes.len()];
        let ends = if self.is_datagram {
            &self.ends[..]
        } else {
            &stream
        };
        for &end in ends {
            decoder.push(&self.bytes[start..end], &mut |_| packets += 1);
            decoder.finish(&mut |_| packets += 1);
            start = end;
        }
        let stats = decoder.stats();
        let fewest = if self.is_datagram { 1 } else { 2 };
        if packets >= fewest {
            (stats.bytes - stats.skipped_bytes) as usize
        } else {
            0
        }
    }

    /// Returns the bit rate of the sender, if it is lower than the bit rate of the receiver.
    pub fn slower_sender(&self, baud: NonZeroU32) -> Option<NonZeroU32> {
        NonZeroU32::new(bit_rate::slower_sender(&self.bytes, baud)?)
    }

    /// Returns the number of bytes that are kept.
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    fn likely_bit_rate(&self, format: &StreamFormat) -> Option<String> {
        let baud = self.slower_sender(format.baud?)?;
        Some(format!(
            "looks like a sender at a lower bit rate: set baud={baud}"
        ))
    }
}

/// Returns the formats to try: all protocols with their default options, and the other framing of the HC11.
fn candidates(is_datagram: bool) -> impl Iterator<Item = StreamFormat> {
    let refused = if is_datagram {
        Carriers::Streams
    } else {
        Carriers::Datagrams
    };
    let protocols = PROTOCOLS.iter().map(|protocol| StreamFormat::new(protocol));
    let hash = hc11::Hc11Format {
        framing: hc11::Framing::Hash,
        ..hc11::Hc11Format::default()
    };
    protocols
        .chain([hash.into()])
        .filter(move |format| format.protocol.carriers != refused)
}

/// Returns `true` if `candidate` may decode packets that `format` does not: another protocol, or another framing of the HC11. All
/// other options of a protocol read the same packets.
fn is_other(candidate: &StreamFormat, format: &StreamFormat) -> bool {
    let is_same = candidate.protocol == format.protocol;
    !is_same || (format.protocol == &hc11::PROTOCOL && candidate.options != format.options)
}

/// Returns the options of a URI that give a format, with `&` between them.
fn options(format: &StreamFormat) -> String {
    let without_baud = StreamFormat {
        baud: None,
        ..format.clone()
    };
    without_baud.to_string().trim_start_matches('?').to_owned()
}

//! HC11 glove packets: 64 sensor counts between marks.

mod pauses;

use std::num::NonZeroU32;
use std::time::Duration;

use self::pauses::PacketPauses;
use super::restart_text::RestartTextDetector;
use super::{
    Carriers, Decoder, Packet, PositionNoise, Protocol, ProtocolOption, ProtocolOptions,
    StreamFormat, transmission_time,
};
use crate::capture::{Channels, Sample, SampleKind, SourceStats};
use crate::names::named_enum;

/// The HC11 protocol.
pub const PROTOCOL: Protocol = Protocol {
    name: "hc11",
    summary: "HC11: flex-sensor glove with the 68HC11 converter, 64 counts of 8 bits per packet",
    sample: SampleKind::Channels,
    has_both_hands: false,
    has_parts: false,
    position_noise: PositionNoise::None,
    carriers: Carriers::Any,
    min_packet_bytes: PACKET_BYTES,
    default_baud: Some(DEFAULT_BAUD),
    feedback: None,
    options: &[&FRAMING],
    nominal_rate_hz: |_| None,
    decoder: |options| Box::new(Hc11Decoder::new(framing(options))),
    encoder: |options, _| {
        let framing = framing(options);
        Ok(Box::new(move |readings, bytes| {
            let bodies = readings.iter().filter_map(|reading| body(&reading.sample));
            bodies.for_each(|body| bytes.extend(encode(framing, &body)));
        }))
    },
};

const FRAMING: ProtocolOption = ProtocolOption {
    name: "framing",
    default: Framing::Double06.name(),
    summary: "marks around a packet: `double06` (two bytes 06 before it) or `hash` (`#` before and after it)",
    check: |value| match value.parse::<Framing>() {
        Ok(_) => Ok(()),
        Err(error) => Err(error.to_string()),
    },
};

fn framing(options: &ProtocolOptions) -> Framing {
    let value = options.get(&FRAMING);
    value
        .parse()
        .expect("options are checked when they are set")
}

const DEFAULT_BAUD: NonZeroU32 = NonZeroU32::new(115_200).unwrap();

/// Bytes between the marks of a packet: one per sensor channel, in wire order.
pub const BODY_BYTES: usize = 64;
/// Bytes of a whole packet, marks included, in both framings.
pub const PACKET_BYTES: usize = 66;

named_enum! {
    /// Marks around a packet. Neither framing escapes its data: a body may contain its own mark.
    #[derive(Default)]
    pub enum Framing ("framing") {
        /// Two bytes 06 before the body, as the glove's firmware sends them. A packet is emitted when the
        /// two marks of the next one are received, when the stream ends, or after a pause of a sender that pauses after
        /// every packet.
        #[default]
        Double06 = "double06",
        /// A `#` before the body and one after it. A packet is emitted with its end mark.
        Hash = "hash",
    }
}

impl Framing {
    const fn mark(self) -> u8 {
        match self {
            Self::Double06 => 0x06,
            Self::Hash => b'#',
        }
    }

    /// Returns the offsets of the marks from the first byte of a packet. Offsets 66 and 67 are in the next packet.
    const fn mark_offsets(self) -> &'static [usize] {
        match self {
            Self::Double06 => &[0, 1, 66, 67],
            Self::Hash => &[0, 65],
        }
    }

    const fn body_start(self) -> usize {
        match self {
            Self::Double06 => 2,
            Self::Hash => 1,
        }
    }

    /// Returns the number of bytes, from the first mark, that confirm a packet while the stream continues.
    const fn bytes_to_confirm(self) -> usize {
        match self {
            Self::Double06 => PACKET_BYTES + 2,
            Self::Hash => PACKET_BYTES,
        }
    }

    /// Checks whether a packet starts at the start of `window`, as early as its bytes allow.
    fn check_start(self, window: &[u8], bytes_to_confirm: usize) -> StartCheck<'_> {
        let is_wrong =
            |&offset: &usize| window.get(offset).is_some_and(|&byte| byte != self.mark());
        if self.mark_offsets().iter().any(is_wrong) {
            return StartCheck::NoPacket;
        }
        if window.len() < bytes_to_confirm {
            return StartCheck::Undecided;
        }
        match window
            .get(self.body_start()..)
            .and_then(<[u8]>::first_chunk)
        {
            Some(body) => StartCheck::Packet(body),
            None => StartCheck::Undecided,
        }
    }
}

enum StartCheck<'a> {
    Packet(&'a [u8; BODY_BYTES]),
    NoPacket,
    Undecided,
}

/// Framing and bit rate of an HC11 glove.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hc11Format {
    /// Marks around a packet.
    pub framing: Framing,
    /// Bits per second; ten of them carry a byte.
    pub baud: NonZeroU32,
}

impl Default for Hc11Format {
    fn default() -> Self {
        Self {
            framing: Framing::default(),
            baud: DEFAULT_BAUD,
        }
    }
}

impl Hc11Format {
    /// Returns the time that the line needs for `bytes`, rounded down to nanoseconds.
    pub fn transmission_time(&self, bytes: usize) -> Duration {
        transmission_time(self.baud, bytes)
    }

    /// Returns the time that the line needs for a packet: the shortest time between two readings.
    pub fn packet_period(&self) -> Duration {
        self.transmission_time(PACKET_BYTES)
    }
}

impl From<Hc11Format> for StreamFormat {
    fn from(format: Hc11Format) -> Self {
        let mut options = ProtocolOptions::default();
        let framing = format.framing.name();
        if framing != FRAMING.default {
            let set = options.set(&FRAMING, framing);
            set.expect("it is the name of a framing");
        }
        Self {
            protocol: &PROTOCOL,
            options,
            baud: Some(format.baud),
        }
    }
}

/// Encodes `body` as the glove does, with the marks of `framing`.
pub fn encode(framing: Framing, body: &[u8; BODY_BYTES]) -> [u8; PACKET_BYTES] {
    let mut packet = [framing.mark(); PACKET_BYTES];
    packet[framing.body_start()..][..BODY_BYTES].copy_from_slice(body);
    packet
}

/// Returns the counts in the body of a packet: one byte per channel, in wire order.
pub fn channels(body: &[u8; BODY_BYTES]) -> Channels {
    Channels {
        full_scale: u16::from(u8::MAX),
        counts: body.iter().copied().map(u16::from).collect(),
        unsent: Default::default(),
    }
}

/// Returns the packet body of a sample. `None` unless it has 64 counts of 8 bits.
pub fn body(sample: &Sample) -> Option<[u8; BODY_BYTES]> {
    let Sample::Channels(channels) = sample else {
        return None;
    };
    let mut body = [0; BODY_BYTES];
    if channels.counts.len() != BODY_BYTES {
        return None;
    }
    for (byte, &count) in body.iter_mut().zip(&channels.counts) {
        *byte = u8::try_from(count).ok()?;
    }
    Some(body)
}

/// Decoder of HC11 packets.
///
/// Follows the rules `confirmed` (for [`Framing::Double06`]) and `rescan` (for [`Framing::Hash`]) of the glove's
/// specification: the earliest start whose marks all fit is a packet; a start that does not fit is one skipped byte.
///
/// A line of printable text between packets is the start message of a board that was reset.
#[derive(Clone, Debug)]
pub struct Hc11Decoder {
    framing: Framing,
    buffer: [u8; CAPACITY],
    start: usize,
    end: usize,
    stats: SourceStats,
    is_searching: bool,
    restart_text: RestartTextDetector,
    pauses: PacketPauses,
}

/// Room for the 67 bytes that may be undecided, and for enough new ones that moving them to the front is rare.
const CAPACITY: usize = 512;

impl Hc11Decoder {
    /// Creates a decoder at the start of a stream.
    pub fn new(framing: Framing) -> Self {
        Self {
            framing,
            buffer: [0; CAPACITY],
            start: 0,
            end: 0,
            stats: SourceStats::default(),
            is_searching: false,
            restart_text: RestartTextDetector::default(),
            pauses: PacketPauses::default(),
        }
    }

    fn decode_buffer(&mut self, bytes_to_confirm: usize, emit: &mut dyn FnMut(Packet)) {
        loop {
            let window = &self.buffer[self.start..self.end];
            match self.framing.check_start(window, bytes_to_confirm) {
                StartCheck::Packet(body) => {
                    let sample = Sample::Channels(channels(body));
                    self.start += PACKET_BYTES;
                    self.stats.readings += 1;
                    self.is_searching = false;
                    self.restart_text.push_packet();
                    let end = self.stats.readings * PACKET_BYTES as u64 + self.stats.skipped_bytes;
                    emit(Packet::new(sample, end));
                }
                StartCheck::NoPacket => self.skip_byte(),
                StartCheck::Undecided => return,
            }
        }
    }

    fn skip_byte(&mut self) {
        self.restart_text.push_byte(self.buffer[self.start]);
        self.start += 1;
        self.stats.skipped_bytes += 1;
        self.stats.resyncs += u64::from(!self.is_searching);
        self.is_searching = true;
    }

    /// Returns `true` if the pending bytes are a packet with nothing after it.
    fn is_complete(&self) -> bool {
        let window = &self.buffer[self.start..self.end];
        window.len() == PACKET_BYTES
            && matches!(
                self.framing.check_start(window, PACKET_BYTES),
                StartCheck::Packet(_)
            )
    }

    fn move_to_front_when_full(&mut self) {
        if self.end < CAPACITY {
            return;
        }
        self.buffer.copy_within(self.start..self.end, 0);
        (self.start, self.end) = (0, self.pending_bytes());
    }
}

impl Decoder for Hc11Decoder {
    fn push(&mut self, mut bytes: &[u8], emit: &mut dyn FnMut(Packet)) {
        self.pauses.push_bytes();
        self.stats.bytes += bytes.len() as u64;
        while !bytes.is_empty() {
            self.move_to_front_when_full();
            let (piece, rest) = bytes.split_at(bytes.len().min(CAPACITY - self.end));
            self.buffer[self.end..][..piece.len()].copy_from_slice(piece);
            self.end += piece.len();
            self.decode_buffer(self.framing.bytes_to_confirm(), emit);
            bytes = rest;
        }
    }

    fn finish(&mut self, emit: &mut dyn FnMut(Packet)) {
        self.decode_buffer(PACKET_BYTES, emit);
        self.reset();
    }

    fn awaits_pause(&self) -> bool {
        self.pauses.is_expected() && self.is_complete()
    }

    fn pause(&mut self, emit: &mut dyn FnMut(Packet)) {
        let is_after_packet = self.pending_bytes() == 0 || self.is_complete();
        if self.pauses.push_pause(is_after_packet) {
            self.decode_buffer(PACKET_BYTES, emit);
        }
    }

    fn reset(&mut self) {
        self.pauses = PacketPauses::default();
        self.stats.skipped_bytes += self.pending_bytes() as u64;
        (self.start, self.end) = (0, 0);
        self.is_searching = false;
    }

    /// Returns the number of undecided bytes, 0..=67.
    fn pending_bytes(&self) -> usize {
        self.end - self.start
    }

    fn stats(&self) -> SourceStats {
        self.stats
    }

    fn take_restart(&mut self) -> bool {
        self.restart_text.take()
    }
}

#[cfg(test)]
mod tests;

//! Byte protocols: one file per wire format, each with a [`Decoder`].
//!
//! To add a protocol, write its file with a [`Protocol`] constant and list the constant in [`PROTOCOLS`].

pub mod body_landmarks;
mod bone_lengths;
pub mod bvh;
mod datagrams;
mod encoder;
pub mod hand_landmarks;
pub mod hc11;
pub mod holistic;
pub mod imu;
mod invalid;
pub mod joint_sets;
mod line_times;
mod lines;
pub mod lucidgloves;
pub mod markers;
pub mod opentrack;
pub mod osc;
mod restart_text;
mod space;
pub mod text_line;
mod tracked_hands;
pub mod vmc;

use std::fmt;
use std::num::NonZeroU32;
use std::time::Duration;

use super::feedback::FeedbackFormat;
use super::{Sample, SampleKind, SourceStats};
use crate::hand::{HandPart, Side};
use crate::message::escape;
use crate::time::Timestamp;

pub use encoder::{Encoder, EncoderPlan};
pub use invalid::{InvalidPacket, InvalidPackets, PacketError};

/// All protocols. The first one is the default.
pub const PROTOCOLS: &[&Protocol] = &[
    &hc11::PROTOCOL,
    &text_line::PROTOCOL,
    &markers::PROTOCOL,
    &bvh::PROTOCOL,
    &body_landmarks::PROTOCOL,
    &lucidgloves::PROTOCOL,
    &hand_landmarks::PROTOCOL,
    &holistic::PROTOCOL,
    &joint_sets::OPENXR,
    &joint_sets::WEBXR,
    &opentrack::PROTOCOL,
    &imu::PROTOCOL,
    &vmc::PROTOCOL,
];

/// A wire format: its name, its options, its decoder and its encoder.
#[derive(Debug)]
pub struct Protocol {
    /// Name in source URIs.
    pub name: &'static str,
    /// One line for help texts, in lower case and without a full stop.
    pub summary: &'static str,
    /// Kind of sample that the decoder gives.
    pub sample: SampleKind,
    /// `true` if it shows both hands. A setup with one hand then reads the hand that the option `hand` names.
    pub has_both_hands: bool,
    /// `true` if it measures the arm and the fingers in packets of their own.
    pub has_parts: bool,
    /// Noise of the positions that it carries.
    pub position_noise: PositionNoise,
    /// Carriers of the packets.
    pub carriers: Carriers,
    /// Length of the shortest packet, in bytes.
    pub min_packet_bytes: usize,
    /// Bit rate of the serial line that usually carries the protocol. `None` if no serial line limits the rate.
    pub default_baud: Option<NonZeroU32>,
    /// Feedback that the device accepts over the same line. `None` if it accepts none.
    pub feedback: Option<&'static FeedbackFormat>,
    /// Options beside `protocol` and `baud`.
    pub options: &'static [&'static ProtocolOption],
    /// Returns the packets per second of a file, which has no time stamps. `None` derives the rate from the bit rate.
    pub nominal_rate_hz: fn(&ProtocolOptions) -> Option<f64>,
    /// Creates a decoder at the start of a stream.
    pub decoder: fn(&ProtocolOptions) -> Box<dyn Decoder>,
    /// Creates an encoder, with which simulated people send the protocol. An error states the option that it does not support.
    pub encoder: fn(&ProtocolOptions, &EncoderPlan) -> Result<Encoder, String>,
}

/// Noise of the positions that a protocol carries, which decides how a setup smooths them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PositionNoise {
    /// No positions, or smoothed by the sender: motion capture files and headsets.
    None,
    /// Tenths of a millimetre: optical markers.
    Markers,
    /// Millimetres: landmarks that a network finds in an image.
    Landmarks,
}

/// Kinds of transport that can carry the packets of a protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carriers {
    /// Streams, and datagrams of whole packets.
    Any,
    /// Streams from their start.
    Streams,
    /// Datagrams, each of which is a packet: nothing in a stream would separate them.
    Datagrams,
}

impl Protocol {
    /// Returns the option with this name.
    ///
    /// ```
    /// use ademan_core::capture::StreamFormat;
    /// use ademan_core::capture::protocol::hand_landmarks;
    ///
    /// let mut format = StreamFormat::new(&hand_landmarks::PROTOCOL);
    /// let camera = format.protocol.option("camera").expect("an option of the protocol");
    /// format.options.set(camera, "head")?;
    /// assert_eq!(format.to_string(), "?protocol=hand-landmarks&camera=head");
    /// # Ok::<(), String>(())
    /// ```
    pub fn option(&self, name: &str) -> Option<&'static ProtocolOption> {
        let mut options = self.options.iter().copied();
        options.find(|option| option.name == name)
    }

    /// Returns the name of the device or program that uses the protocol: the start of its summary.
    pub fn title(&self) -> &'static str {
        let end = self.summary.find([',', ':']);
        &self.summary[..end.unwrap_or(self.summary.len())]
    }
}

impl PartialEq for Protocol {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Protocol {}

/// An option of a protocol in source URIs.
#[derive(Debug)]
pub struct ProtocolOption {
    /// Name in source URIs.
    pub name: &'static str,
    /// Value if the option is not given.
    pub default: &'static str,
    /// One line for help texts, in lower case and without a full stop.
    pub summary: &'static str,
    /// Checks a value; an error states what is wrong with it.
    pub check: fn(&str) -> Result<(), String>,
}

/// Checked options of a protocol. Two with the same values are equal, whether defaults were stated or not.
#[derive(Clone, Debug, Default)]
pub struct ProtocolOptions(Vec<StatedOption>);

/// An option that was stated.
#[derive(Clone, Debug)]
struct StatedOption {
    name: &'static str,
    value: String,
    is_default: bool,
}

impl ProtocolOptions {
    /// Returns the value of `option`.
    pub fn get<'a>(&'a self, option: &ProtocolOption) -> &'a str {
        let stated = self.0.iter().find(|stated| stated.name == option.name);
        stated.map_or(option.default, |stated| stated.value.as_str())
    }

    /// Checks and stores a value.
    pub fn set(&mut self, option: &ProtocolOption, value: &str) -> Result<(), String> {
        // A message quotes the value; no valid one is escaped.
        (option.check)(&escape(value))?;
        self.0.retain(|stated| stated.name != option.name);
        self.0.push(StatedOption {
            name: option.name,
            value: value.to_owned(),
            is_default: value == option.default,
        });
        self.0.sort_unstable_by_key(|stated| stated.name);
        Ok(())
    }

    /// Returns `true` if a value was stated, be it the default.
    pub fn is_stated(&self, option: &ProtocolOption) -> bool {
        self.0.iter().any(|stated| stated.name == option.name)
    }

    /// Returns the values that differ from their defaults, by name.
    fn deviating(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let deviating = self.0.iter().filter(|stated| !stated.is_default);
        deviating.map(|stated| (stated.name, stated.value.as_str()))
    }
}

impl PartialEq for ProtocolOptions {
    fn eq(&self, other: &Self) -> bool {
        self.deviating().eq(other.deviating())
    }
}

impl Eq for ProtocolOptions {}

/// Returns options with these values.
#[cfg(test)]
fn options(pairs: &[(&ProtocolOption, &str)]) -> ProtocolOptions {
    let mut options = ProtocolOptions::default();
    for (option, value) in pairs {
        options.set(option, value).expect("a valid value");
    }
    options
}

/// A protocol with its options and the bit rate of the line that carries it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StreamFormat {
    /// The wire format.
    pub protocol: &'static Protocol,
    /// Options of the protocol.
    pub options: ProtocolOptions,
    /// Bits per second; ten of them carry a byte (8 data bits, no parity, 1 stop bit). `None` if the bytes are not
    /// paced by a serial line.
    pub baud: Option<NonZeroU32>,
}

/// Bits on the line for each byte: 8 data bits, a start bit and a stop bit.
const BITS_PER_BYTE: u64 = 10;

impl StreamFormat {
    /// Creates the format of `protocol` with its default options.
    pub fn new(protocol: &'static Protocol) -> Self {
        Self {
            protocol,
            options: ProtocolOptions::default(),
            baud: protocol.default_baud,
        }
    }

    /// Creates a decoder at the start of a stream.
    pub fn decoder(&self) -> Box<dyn Decoder> {
        (self.protocol.decoder)(&self.options)
    }

    /// Creates an encoder at the start of a stream. An error states the option that it does not support.
    pub fn encoder(&self, plan: &EncoderPlan) -> Result<Encoder, String> {
        (self.protocol.encoder)(&self.options, plan)
    }

    /// Returns the format of a stream that shows `side`. It differs only if the protocol has an option for the hand, and another value
    /// of it.
    #[must_use]
    pub fn for_hand(mut self, side: Side) -> Self {
        if self.hand().is_some_and(|shown| shown != side) {
            let set = self.options.set(&space::HAND, side.name());
            set.expect("every side is a hand");
        }
        self
    }

    /// Returns the format of a stream that shows `side` unless its options state a hand.
    #[must_use]
    pub fn for_hand_unless_stated(self, side: Side) -> Self {
        if self.options.is_stated(&space::HAND) {
            self
        } else {
            self.for_hand(side)
        }
    }

    /// Returns the hand that the option `hand` names; `None` if the protocol does not have it.
    pub fn hand(&self) -> Option<Side> {
        let option = self.protocol.option(space::HAND.name)?;
        self.options.get(option).parse().ok()
    }

    /// Returns the time that a serial line needs for `bytes`, rounded down to nanoseconds; zero without a bit rate.
    pub fn transmission_time(&self, bytes: usize) -> Duration {
        self.baud
            .map_or(Duration::ZERO, |baud| transmission_time(baud, bytes))
    }

    /// Returns the shortest silence after which a serial line has paused: one and a half bytes. `None` without a bit rate.
    pub fn pause_time(&self) -> Option<Duration> {
        self.baud?;
        Some(self.transmission_time(3) / 2)
    }

    /// Returns the shortest time between two packets. `None` if no bit rate limits it.
    pub fn packet_period(&self) -> Option<Duration> {
        self.baud?;
        Some(self.transmission_time(self.protocol.min_packet_bytes))
    }

    /// Returns the time at which packet number `packets` (from 1) of a file is complete at the nominal rate.
    pub fn nominal_time(&self, packets: u64) -> Timestamp {
        if let Some(rate_hz) = (self.protocol.nominal_rate_hz)(&self.options) {
            return Timestamp::from_seconds(packets as f64 / rate_hz);
        }
        let Some(baud) = self.baud else {
            return Timestamp(packets);
        };
        let bits = u128::from(packets)
            * self.protocol.min_packet_bytes as u128
            * u128::from(BITS_PER_BYTE);
        Timestamp((bits * 1_000_000 / u128::from(baud.get())) as u64)
    }
}

impl fmt::Display for StreamFormat {
    /// Writes the options of a source URI that give this format, with the leading `?`, and a default if it was stated.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "?protocol={}", self.protocol.name)?;
        for StatedOption { name, value, .. } in &self.options.0 {
            write!(f, "&{name}={value}")?;
        }
        match self.baud {
            Some(baud) => write!(f, "&baud={baud}"),
            None => Ok(()),
        }
    }
}

/// Returns the time that a serial line at `baud` bits per second needs for `bytes`, rounded down to nanoseconds.
pub(super) fn transmission_time(baud: NonZeroU32, bytes: usize) -> Duration {
    let nanoseconds = bytes as u64 * BITS_PER_BYTE * 1_000_000_000 / u64::from(baud.get());
    Duration::from_nanos(nanoseconds)
}

/// A packet that a decoder found.
#[derive(Clone, Debug, PartialEq)]
pub struct Packet {
    /// Sensor values of the packet.
    pub sample: Sample,
    /// Offset of the first byte after the packet, counted from the start of the stream.
    pub end: u64,
    /// Time by which files play, if the format has one: stated by the packet, or derived from its number.
    pub time: Option<Timestamp>,
    /// Time at which the values were complete on the clock of the sender, if the packet states it.
    pub sent_at: Option<Timestamp>,
    /// Hand that was measured, if the format states it.
    pub side: Option<Side>,
    /// Part of the hand that counts, if another packet of the same stream measures the rest.
    pub part: Option<HandPart>,
}

impl Packet {
    /// Creates a packet of a format that states neither a time nor a side.
    pub const fn new(sample: Sample, end: u64) -> Self {
        Self {
            sample,
            end,
            time: None,
            sent_at: None,
            side: None,
            part: None,
        }
    }

    /// Creates the packet of a line; `time` is the time that it states.
    fn of_line(sample: Sample, time: Option<Timestamp>) -> Self {
        Self {
            time,
            sent_at: time,
            ..Self::new(sample, 0)
        }
    }
}

/// Decoder of one byte stream.
///
/// The packets do not depend on how the stream is cut into pieces. A decoder stores a bounded number of bytes.
/// Every byte is counted once: `bytes` of the statistics are the bytes of packets, `skipped_bytes` and
/// [`pending_bytes`](Self::pending_bytes).
pub trait Decoder: Send {
    /// Decodes the next bytes of the stream and passes each packet that is complete to `emit`.
    fn push(&mut self, bytes: &[u8], emit: &mut dyn FnMut(Packet));

    /// Ends the stream or datagram: emits a packet that only waited for confirmation and skips the rest.
    fn finish(&mut self, emit: &mut dyn FnMut(Packet));

    /// Ends a stream that may have been cut anywhere, as a pipe whose writer was killed. The default is
    /// [`finish`](Self::finish), for packets that show whether they are complete.
    fn finish_cut(&mut self, emit: &mut dyn FnMut(Packet)) {
        self.finish(emit);
    }

    /// Returns `true` if the pending bytes may be a packet that a pause of the stream confirms.
    fn awaits_pause(&self) -> bool {
        false
    }

    /// Handles a pause after the latest byte. Emits the packet that it confirms. The default ignores it.
    fn pause(&mut self, emit: &mut dyn FnMut(Packet)) {
        let _ = emit;
    }

    /// Prepares for streams that may begin within a packet, as on a serial line: this one, and each that follows a
    /// [`reset`](Self::reset). Called before the first byte. The default ignores it, for packets whose start shows.
    fn start_anywhere(&mut self) {}

    /// Skips the pending bytes, after a stream broke off: the bytes that follow are unrelated.
    fn reset(&mut self);

    /// Returns the number of bytes that may still become part of a packet.
    fn pending_bytes(&self) -> usize;

    /// Returns the statistics. `readings` counts packets; `resyncs` counts runs of skipped bytes.
    fn stats(&self) -> SourceStats;

    /// Returns the error in the latest packet that was refused, as long as no valid one followed.
    fn last_error(&self) -> Option<&PacketError> {
        None
    }

    /// Returns once the reason why the rest of the stream cannot be decoded. Everything after it is skipped.
    fn take_error(&mut self) -> Option<String> {
        None
    }

    /// Returns the form of feedback that the sender of the latest packet reads, if its packets show it. `None`, the default, stands for
    /// the form of the protocol.
    fn feedback(&self) -> Option<&'static FeedbackFormat> {
        None
    }

    /// Returns `true` once after the stream showed that the sender has restarted.
    fn take_restart(&mut self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn protocol_names_are_unique_and_defaults_are_valid() {
        for (index, protocol) in PROTOCOLS.iter().enumerate() {
            assert!(!PROTOCOLS[..index].contains(protocol), "{}", protocol.name);
            assert!(protocol.min_packet_bytes > 0, "{}", protocol.name);
            for option in protocol.options {
                assert_eq!((option.check)(option.default), Ok(()), "{}", option.name);
                assert!(!["protocol", "baud"].contains(&option.name));
            }
        }
    }
}

//! Lines of LucidGloves in the alpha and the legacy encoding.
//!
//! An alpha line has a key and a decimal number for each field, without separators: `A100B200C300D400E500F2047G2047P0J`.
//! Keys of buttons have no number. Keys of splay and joints are in parentheses: `(BB)2047(BAC)120`. A legacy line has 13
//! numbers with `&` between them. A line ends with LF or CR LF.
//!
//! A line that names no finger is not a packet: blank lines, boot messages and device information are skipped. A line with a
//! key twice is skipped too, because it consists of two lines of which the first was cut. Unknown keys are ignored.
//!
//! opengloves-lib (`src/opengloves/alpha.hpp`) leaves out joints and splays of 0, which other lines of the same glove have.

mod alpha;
mod feedback;
mod legacy;

use arrayvec::ArrayVec;

use super::lines::{LineDecoder, LineParser};
use super::text_line::RATE;
use super::{
    Carriers, InvalidPacket, Packet, PacketError, PositionNoise, Protocol, ProtocolOption,
    ProtocolOptions, space,
};
use crate::capture::feedback::FeedbackFormat;
use crate::capture::{ChannelSet, Channels, Sample, SampleKind};
use crate::hand::Finger;

/// The LucidGloves protocol.
pub const PROTOCOL: Protocol = Protocol {
    name: "lucidgloves",
    summary: "LucidGloves, alpha or legacy encoding: finger curls, splay, joints, stick and buttons per line of text",
    sample: SampleKind::Channels,
    has_both_hands: false,
    has_parts: false,
    position_noise: PositionNoise::None,
    carriers: Carriers::Any,
    // A thumb with one digit.
    min_packet_bytes: 3,
    default_baud: std::num::NonZeroU32::new(115_200),
    feedback: Some(&feedback::ALPHA),
    options: &[&MAX, &RATE],
    nominal_rate_hz: |options| Some(space::number(options, &RATE)),
    decoder: |options| Box::new(decoder(max(options))),
    encoder: |options, _| {
        let max = max(options);
        Ok(Box::new(move |readings, bytes| {
            for reading in readings {
                if let Sample::Channels(channels) = &reading.sample {
                    let fields = Fields::from_channels(channels).scaled(max);
                    bytes.extend(fields.encode().into_bytes());
                }
            }
        }))
    },
};

/// The option for the largest value of the converter.
pub const MAX: ProtocolOption = ProtocolOption {
    name: "max",
    default: "4095",
    summary: "largest value of the converter: 4095 on an ESP32, 1023 on an AVR such as the Arduino Nano",
    check: |value| match value.parse::<u16>() {
        Ok(1..) => Ok(()),
        _ => Err(format!("`{value}` is not a whole number from 1 to 65535")),
    },
};

fn max(options: &ProtocolOptions) -> u16 {
    let value = options.get(&MAX);
    value
        .parse()
        .expect("options are checked when they are set")
}

/// Largest count of a sample. Counts of other converters are scaled to it.
pub const FULL_SCALE: u16 = 4095;

/// The count of a stick at rest and of a finger that is not spread.
pub const MIDDLE: u16 = 2047;

/// Joints of a finger, from the palm to the tip.
pub const JOINTS: usize = 4;

/// Channel of the curl of the thumb; the channels of the other fingers follow.
pub const CURL: usize = 0;
/// Channel of the splay of the thumb; the channels of the other fingers follow.
pub const SPLAY: usize = CURL + Finger::COUNT;
/// Channel of the first joint of the thumb; [`JOINTS`] channels for each finger follow.
pub const JOINT: usize = SPLAY + Finger::COUNT;
/// Channel of the stick, to the right.
pub const STICK_X: usize = JOINT + JOINTS * Finger::COUNT;
/// Channel of the stick, away from the wearer.
pub const STICK_Y: usize = STICK_X + 1;
/// Channel of the analogue trigger.
pub const TRIGGER: usize = STICK_Y + 1;
/// Channel of the first button, in the order of [`Button`].
pub const BUTTONS: usize = TRIGGER + 1;
/// Number of channels.
pub const CHANNELS: usize = BUTTONS + Button::KEYS.len();

/// The buttons and gestures of a glove.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// The stick is pushed in.
    Stick,
    /// The trigger is pulled to its end.
    Trigger,
    /// Button A.
    A,
    /// Button B.
    B,
    /// The hand grabs.
    Grab,
    /// The hand pinches.
    Pinch,
    /// The menu button.
    Menu,
    /// The calibration button.
    Calibrate,
}

impl Button {
    /// The keys of the alpha encoding, in the order of the buttons.
    const KEYS: [u8; 8] = *b"HIJKLMNO";
}

/// The values of a line: counts of the converter, before they are clamped and scaled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fields {
    /// Curl of each finger, in the order of [`Finger::ALL`]; `None` if the line does not name it.
    pub curls: [Option<i64>; Finger::COUNT],
    /// Splay of each finger.
    pub splays: [Option<i64>; Finger::COUNT],
    /// Joints of each finger.
    pub joints: [[Option<i64>; JOINTS]; Finger::COUNT],
    /// The stick: to the right, and away from the wearer.
    pub stick: [Option<i64>; 2],
    /// The analogue trigger.
    pub trigger: Option<i64>,
    /// The buttons, by the order of [`Button`].
    pub buttons: [bool; Button::KEYS.len()],
}

impl Fields {
    /// Reads a line without its line end, in either encoding. An error states why it is not a packet.
    pub fn parse(line: &[u8]) -> Result<Self, PacketError> {
        let line = line.trim_ascii();
        let fields = if is_legacy(line) {
            legacy::parse(line)?
        } else {
            alpha::parse(line)?
        };
        let joints = fields.joints.as_flattened();
        let mut fingers = fields.curls.iter().chain(joints);
        if fingers.any(Option::is_some) {
            Ok(fields)
        } else {
            Err(unknown("it names no finger"))
        }
    }

    /// Writes the fields as a line of the alpha encoding with its line end.
    pub fn encode(&self) -> String {
        alpha::encode(self)
    }

    /// Returns the values of a glove with a converter of 0..=`max` instead of 0..=[`FULL_SCALE`].
    #[must_use]
    fn scaled(mut self, max: u16) -> Self {
        let (full, max) = (i64::from(FULL_SCALE), i64::from(max));
        let fingers = self.curls.iter_mut().chain(&mut self.splays);
        let joints = self.joints.as_flattened_mut();
        let others = self.stick.iter_mut().chain([&mut self.trigger]);
        for value in fingers.chain(joints).chain(others).flatten() {
            *value = (*value * max + full / 2) / full;
        }
        self
    }

    /// Converts the values to counts of 0..=[`FULL_SCALE`]. Values outside 0..=`max` are clamped.
    ///
    /// A joint that the line does not name follows the curl of its finger. A finger without a value is
    /// [unknown](Channels::UNKNOWN). A splay, stick or trigger without a value is at rest, and [unsent](Channels::unsent).
    pub fn channels(&self, max: u16) -> Channels {
        let count = |value: i64| {
            let value = value.clamp(0, i64::from(max)) as u32;
            let (full, max) = (u32::from(FULL_SCALE), u32::from(max));
            ((value * full + max / 2) / max) as u16
        };
        let or = |value: Option<i64>, missing: u16| value.map_or(missing, count);
        let mut counts = ArrayVec::new();
        counts.extend(self.curls.map(|curl| or(curl, Channels::UNKNOWN)));
        counts.extend(self.splays.map(|splay| or(splay, MIDDLE)));
        for (joints, curl) in self.joints.iter().zip(self.curls) {
            counts.extend(joints.map(|joint| or(joint.or(curl), Channels::UNKNOWN)));
        }
        counts.extend(self.stick.map(|position| or(position, MIDDLE)));
        counts.push(or(self.trigger, 0));
        counts.extend(self.buttons.map(|is_down| FULL_SCALE * u16::from(is_down)));
        Channels {
            full_scale: FULL_SCALE,
            counts,
            unsent: self.unsent(),
        }
    }

    /// Sets splays and joints that the line leaves out to 0 if an earlier line had them, which `named` records. A finger without a curl
    /// stays unknown.
    fn restore_zeros(&mut self, named: &mut ChannelSet) {
        for (finger, curl) in self.curls.iter().enumerate() {
            let splay = (SPLAY + finger, &mut self.splays[finger]);
            let joints = (JOINT + JOINTS * finger..).zip(&mut self.joints[finger]);
            for (channel, value) in std::iter::once(splay).chain(joints) {
                if value.is_some() {
                    named.insert(channel);
                } else if curl.is_some() && named.contains(channel) {
                    *value = Some(0);
                }
            }
        }
    }

    /// Returns the channels of splays, stick and trigger that the line does not name.
    fn unsent(&self) -> ChannelSet {
        let splays = (SPLAY..).zip(self.splays);
        let others = [
            (STICK_X, self.stick[0]),
            (STICK_Y, self.stick[1]),
            (TRIGGER, self.trigger),
        ];
        let mut unsent = ChannelSet::NONE;
        for (channel, value) in splays.chain(others) {
            if value.is_none() {
                unsent.insert(channel);
            }
        }
        unsent
    }

    /// Returns the fields that a glove with a converter of [`FULL_SCALE`] sends for these channels.
    pub fn from_channels(channels: &Channels) -> Self {
        let value = |channel: usize| {
            let count = channels.counts.get(channel).copied();
            let is_sent =
                |sent: &u16| *sent != Channels::UNKNOWN && !channels.unsent.contains(channel);
            count.filter(is_sent).map(i64::from)
        };
        let finger = |first: usize| std::array::from_fn(|index| value(first + index));
        Self {
            curls: finger(CURL),
            splays: finger(SPLAY),
            joints: std::array::from_fn(|index| {
                std::array::from_fn(|joint| value(JOINT + JOINTS * index + joint))
            }),
            stick: [value(STICK_X), value(STICK_Y)],
            trigger: value(TRIGGER),
            buttons: std::array::from_fn(|index| {
                value(BUTTONS + index).is_some_and(|count| count > i64::from(MIDDLE))
            }),
        }
    }
}

/// Parser of one line.
#[derive(Clone, Copy, Debug)]
pub struct LucidParser {
    max: u16,
    /// The splays and joints that a line has had.
    named: ChannelSet,
    /// The feedback in the encoding of the latest packet.
    feedback: Option<&'static FeedbackFormat>,
}

/// Creates a decoder for a converter with values of 0..=`max`, which must not be 0.
pub fn decoder(max: u16) -> LineDecoder<LucidParser> {
    LineDecoder::with_parser(LucidParser {
        max,
        named: ChannelSet::NONE,
        feedback: None,
    })
}

impl LineParser for LucidParser {
    /// A line with all fields has 300 characters; the buffer of the firmware has 100.
    const MAX_LINE_BYTES: usize = 512;

    fn parse(&mut self, line: &[u8], emit: &mut dyn FnMut(Packet)) -> Result<(), PacketError> {
        let mut fields = Fields::parse(line)?;
        fields.restore_zeros(&mut self.named);
        self.feedback = Some(if is_legacy(line) {
            &feedback::LEGACY
        } else {
            &feedback::ALPHA
        });
        emit(Packet::new(Sample::Channels(fields.channels(self.max)), 0));
        Ok(())
    }

    /// Forgets the splays and joints: the next line may be of another glove, or of the same one with other firmware.
    fn reset(&mut self) {
        self.named = ChannelSet::NONE;
    }

    fn may_lack_start(line: &[u8]) -> bool {
        // The first number of a legacy line may lack digits. An alpha line may lack its first fields, as if a finger had no sensor.
        is_legacy(line) || !line.starts_with(b"A")
    }

    fn feedback(&self) -> Option<&'static FeedbackFormat> {
        self.feedback
    }
}

fn is_legacy(line: &[u8]) -> bool {
    line.contains(&b'&')
}

/// Returns the error of a line that does not have the form of a packet.
fn unknown(text: &str) -> PacketError {
    PacketError::new(InvalidPacket::Unknown, text)
}

#[cfg(test)]
mod tests;

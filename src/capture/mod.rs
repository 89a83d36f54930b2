//! Stage 1: A sensor → [`Reading`].
//!
//! A [`SourceUri`] names a source, [`open`] opens it as a [`Source`], and [`spawn`] runs that on its own thread:
//!
//! ```no_run
//! use ademan::capture::{CaptureEvent, SourceUri, open, spawn};
//!
//! let uri: SourceUri = "serial:/dev/ttyUSB0?protocol=hc11&baud=9600".parse()?;
//! let capture = spawn(open(&uri)?)?;
//! for event in capture.events() {
//!     match event {
//!         CaptureEvent::Reading { reading, .. } => println!("{reading:?}"),
//!         CaptureEvent::Readings { readings, .. } => println!("{readings:?}"),
//!         CaptureEvent::Lost(error) | CaptureEvent::Failed(error) => eprintln!("{error}"),
//!         CaptureEvent::Elapsed(time) => println!("no reading until {time:?}"),
//!         CaptureEvent::Command(command) => println!("a recorded command: {command:?}"),
//!         CaptureEvent::Noise(stats) | CaptureEvent::End(stats) => println!("{stats:?}"),
//!     }
//! }
//! # Ok::<(), ademan::capture::CaptureError>(())
//! ```
//!
//! A byte stream consists of a [transport], which carries the bytes, and a [protocol], which decodes them. Any other
//! sensor implements [`Source`].

pub mod bvh;
pub mod body;
pub mod cancel;
mod error;
pub mod feedback;
pub mod markers;
pub mod protocol;
pub mod pace;
pub mod thread;
mod event;
mod event_queue;
mod clock_offset;
mod merge;
mod poll;
mod sides;

// Everything below needs an operating system with devices, files and sockets.
#[cfg(not(target_family = "wasm"))]
mod active_sender;
#[cfg(not(target_family = "wasm"))]
mod connection;
#[cfg(not(target_family = "wasm"))]
mod garbage;
#[cfg(not(target_family = "wasm"))]
pub mod loopback;
#[cfg(not(target_family = "wasm"))]
mod packet_clock;
#[cfg(not(target_family = "wasm"))]
mod in_place;
#[cfg(not(target_family = "wasm"))]
mod reconnect;
#[cfg(not(target_family = "wasm"))]
mod sender_clock;
#[cfg(not(target_family = "wasm"))]
pub mod recording;
#[cfg(not(target_family = "wasm"))]
mod stream;
#[cfg(not(target_family = "wasm"))]
pub mod transport;
#[cfg(not(target_family = "wasm"))]
pub mod uri;
#[cfg(not(target_family = "wasm"))]
mod wake_up;
mod suspend;

use std::time::{Duration, Instant};

use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};

use self::body::BodyLandmarks;
use self::feedback::FeedbackDevice;
use crate::command::Command;
use crate::hand::{BoneRotations, Displacement, HandPart, JointAngles, JointPositions, Side};
use crate::time::Timestamp;

pub use cancel::CancelToken;
pub use error::CaptureError;
pub use event::CaptureEvent;
pub use feedback::Haptics;
pub use merge::{MAX_SOURCES, MergedSource, PartialSource};
pub use pace::PacedSource;
pub use poll::Readiness;
pub use protocol::hc11::{self, Hc11Format};
pub use protocol::{InvalidPacket, InvalidPackets, PositionNoise, StreamFormat};
pub use sides::SidedSource;
pub use thread::{CaptureThread, spawn, spawn_batched};
#[cfg(not(target_family = "wasm"))]
pub(crate) use {in_place::InPlaceCapture, wake_up::WakeUp};
#[cfg(not(target_family = "wasm"))]
pub use {
    loopback::{Loopback, open_loopback},
    reconnect::BackOff,
    transport::StreamUri,
    uri::SourceUri,
};

/// Opens the source of a byte stream.
///
/// Recordings and simulated hands are opened by their own modules; their URIs are an error here.
#[cfg(not(target_family = "wasm"))]
pub fn open(uri: &SourceUri) -> Result<Box<dyn Source>, CaptureError> {
    match uri {
        SourceUri::Stream(stream) => (stream.transport.open)(stream),
        SourceUri::Recording { .. } | SourceUri::Typist { .. } | SourceUri::Script { .. } => {
            let schemes = transport::TRANSPORTS.iter();
            let schemes: Vec<String> = schemes
                .map(|transport| format!("`{}:`", transport.scheme.name))
                .collect();
            Err(CaptureError::InvalidUri {
                text: uri.to_string(),
                reason: format!("it is not a byte stream; use one of {}", schemes.join(", ")),
            })
        }
    }
}

/// Largest number of channels in a reading: the eight converters of the HC11 glove have eight inputs each.
pub const MAX_CHANNELS: usize = 64;

/// Sensor values at one moment.
///
/// As JSON: `{"time_us":12500,"full_scale":255,"channels":[3,141,…]}` or
/// `{"time_us":12500,"angles_rad":{"elbow-flexion":0.5,…}}` or `{"time_us":12500,"joints_m":{"wrist":[0.0,1.0,-0.3],…}}`
/// or `{"time_us":12500,"side":"right","body_landmarks":[[0.1,-0.5,0.0,0.99],…]}`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Time at which the values were complete, on the clock of the source.
    #[serde(rename = "time_us")]
    pub time: Timestamp,
    /// Hand that was measured. `None` if the source measures only one, or both at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<Side>,
    /// Part of the hand that counts, if another source measures the rest. `None` if all of it counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<HandPart>,
    /// The values.
    #[serde(flatten)]
    pub sample: Sample,
}

impl Reading {
    /// Creates a reading whose values all count.
    pub const fn new(time: Timestamp, side: Option<Side>, sample: Sample) -> Self {
        Self {
            time,
            side,
            part: None,
            sample,
        }
    }
}

/// Sensor values by kind of sensor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Sample {
    /// Counts of a glove, which its glove file maps to joint angles.
    Channels(Channels),
    /// Joint angles.
    Angles {
        /// Angles in radians. Those that the sensor does not measure are unknown.
        #[serde(rename = "angles_rad")]
        angles: JointAngles,
    },
    /// Positions of joints.
    Joints {
        /// Positions in the world, in metres. Those that the sensor does not measure are unknown.
        #[serde(rename = "joints_m")]
        positions: JointPositions,
    },
    /// Landmarks of a body with both arms. An estimator uses the arm on the [side](Reading::side) of the reading, the right
    /// one if that has none.
    Body(BodyLandmarks),
    /// Rotations of the bones of both arms, used as those of a body.
    Bones {
        /// Rotations from the T pose.
        bones: BoneRotations,
    },
    /// The displacement of the arm or the hand from its pose at rest.
    Displacement {
        /// Translation and rotation in the world.
        displacement: Displacement,
    },
}

/// Kind of a [`Sample`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SampleKind {
    /// [`Sample::Channels`].
    Channels,
    /// [`Sample::Angles`].
    Angles,
    /// [`Sample::Joints`].
    Joints,
    /// [`Sample::Body`].
    Body,
    /// [`Sample::Bones`].
    Bones,
    /// [`Sample::Displacement`].
    Displacement,
}

impl SampleKind {
    /// Returns `true` if a glove file has to map the values to joint angles.
    pub const fn needs_glove(self) -> bool {
        matches!(self, Self::Channels)
    }

    /// Returns `true` if each sample shows both arms; see [`SidedSource`].
    pub const fn shows_both_arms(self) -> bool {
        matches!(self, Self::Body | Self::Bones)
    }
}

impl Sample {
    /// Returns the kind of the sample.
    pub const fn kind(&self) -> SampleKind {
        match self {
            Self::Channels(_) => SampleKind::Channels,
            Self::Angles { .. } => SampleKind::Angles,
            Self::Joints { .. } => SampleKind::Joints,
            Self::Body(_) => SampleKind::Body,
            Self::Bones { .. } => SampleKind::Bones,
            Self::Displacement { .. } => SampleKind::Displacement,
        }
    }
}

/// Counts of an analogue-to-digital converter, in wire order.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Channels {
    /// Largest count of the converter (255 for 8 bits).
    pub full_scale: u16,
    /// One count per channel, 0..=`full_scale`; [`UNKNOWN`](Self::UNKNOWN) for one that was not measured.
    #[serde(rename = "channels")]
    pub counts: ArrayVec<u16, MAX_CHANNELS>,
    /// Channels that the packet does not carry: their counts are those of a sensor at rest.
    #[serde(skip)]
    pub unsent: ChannelSet,
}

impl Channels {
    /// The count of a channel that was not measured. No converter has so large a count.
    pub const UNKNOWN: u16 = u16::MAX;

    /// Returns `true` if a channel that was measured has a count larger than the full scale.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn has_impossible_counts(&self) -> bool {
        let mut counts = self.counts.iter();
        counts.any(|&count| count > self.full_scale && count != Self::UNKNOWN)
    }
}

/// A set of channels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChannelSet(u64);

impl ChannelSet {
    /// No channel.
    pub const NONE: Self = Self(0);

    /// All channels.
    pub const ALL: Self = Self(u64::MAX);

    /// Creates the set whose channels are the bits that are set, the lowest for channel 0.
    pub const fn from_bits(bits: u64) -> Self {
        Self(bits)
    }

    /// Returns a bit for each channel, the lowest for channel 0.
    pub const fn bits(self) -> u64 {
        self.0
    }

    /// Adds a channel. A reading has none of 64 or more.
    pub fn insert(&mut self, channel: usize) {
        debug_assert!(channel < MAX_CHANNELS);
        self.0 |= 1 << (channel % MAX_CHANNELS);
    }

    /// Returns whether a channel is in the set.
    pub const fn contains(self, channel: usize) -> bool {
        channel < MAX_CHANNELS && self.0 >> channel & 1 == 1
    }

    /// Returns the channels that are in both sets.
    #[must_use]
    pub const fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

/// Result of a call to [`Source::next`].
#[expect(
    clippy::large_enum_variant,
    reason = "a reading is passed on without an allocation"
)]
#[derive(Clone, Debug, PartialEq)]
pub enum SourceEvent {
    /// A reading.
    Reading(Reading),
    /// A command that a recorded session executed between two readings.
    Command(Command),
    /// Nothing new. Call again.
    Idle,
    /// End of the readings.
    End,
}

/// A sensor, a stream or a recording.
pub trait Source: Send {
    /// Returns the next reading.
    ///
    /// Blocks for at most [`MAX_BLOCK`], so that its thread can be stopped. A source with a
    /// [cancel token](Self::set_cancel_token) may block until cancellation.
    ///
    /// May be called again after a [recoverable](CaptureError::is_recoverable) error. A source whose device was lost
    /// then reconnects.
    fn next(&mut self) -> Result<SourceEvent, CaptureError>;

    /// Registers the token that cancels a blocking [`next`](Self::next), so that an idle source wakes no thread. The
    /// default ignores it.
    fn set_cancel_token(&mut self, cancel: &CancelToken) {
        let _ = cancel;
    }

    /// Makes [`next`](Self::next) return at once, with [`Idle`](SourceEvent::Idle) if nothing has arrived. Its caller waits
    /// as [`wait`](Self::wait) says. Returns `false` if the source has to block and needs a thread of its own, which is the
    /// default.
    fn set_polled(&mut self) -> bool {
        false
    }

    /// Returns what a [polled](Self::set_polled) source waits for, or `None` if [`next`](Self::next) has something already.
    fn wait(&self) -> Option<SourceWait<'_>> {
        None
    }

    /// Returns the device that measures the fingers of a hand, if feedback can be sent to it. It is returned once. The
    /// default is `None`.
    fn take_feedback_device(&mut self, side: Side) -> Option<FeedbackDevice> {
        let _ = side;
        None
    }

    /// Sets the age above which a source on the network drops a reading that states its time, see
    /// [`InvalidPacket::TooOld`]. The default ignores it.
    fn set_max_age(&mut self, age: Duration) {
        let _ = age;
    }

    /// Returns the name for messages: the URI, if the source has one.
    fn name(&self) -> &str;

    /// Returns the shortest time between two readings, if the source knows it.
    fn packet_period(&self) -> Option<Duration> {
        None
    }

    /// Returns `true` if readings arrive at their own pace and are dropped when the consumer is slow.
    fn is_live(&self) -> bool {
        true
    }

    /// Returns `true` if the next call of [`next`](Self::next) returns at once, so that readings may be passed on together. The
    /// default is `false`, as suits a source with a pace of its own.
    fn is_ready(&self) -> bool {
        false
    }

    /// Returns the present time on the clock of the source while it waits for a reading that it knows already; `None` if
    /// it knows none. It is earlier than that reading.
    ///
    /// A replay in real time knows it, so that its consumer detects a long gap before the gap ends.
    fn clock(&self) -> Option<Timestamp> {
        None
    }

    /// Returns the statistics since the source was opened.
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

    fn set_polled(&mut self) -> bool {
        (**self).set_polled()
    }

    fn wait(&self) -> Option<SourceWait<'_>> {
        (**self).wait()
    }

    fn take_feedback_device(&mut self, side: Side) -> Option<FeedbackDevice> {
        (**self).take_feedback_device(side)
    }

    fn set_max_age(&mut self, age: Duration) {
        (**self).set_max_age(age);
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

    fn is_ready(&self) -> bool {
        (**self).is_ready()
    }

    fn clock(&self) -> Option<Timestamp> {
        (**self).clock()
    }

    fn stats(&self) -> SourceStats {
        (**self).stats()
    }
}

/// The wait of a [polled](Source::set_polled) source: for bytes or a time, whichever comes first.
#[derive(Clone, Copy, Debug)]
pub struct SourceWait<'a> {
    /// Reports bytes; `None` if none can arrive.
    pub readiness: Option<&'a Readiness>,
    /// Time of the next call without bytes.
    pub deadline: Option<Instant>,
}

/// Longest time that [`Source::next`] blocks without a cancel token.
pub const MAX_BLOCK: Duration = Duration::from_millis(100);

/// Statistics of a source. Every byte and every reading is counted once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SourceStats {
    /// Bytes received.
    pub bytes: u64,
    /// Bytes that belong to no packet: noise and incomplete packets.
    pub skipped_bytes: u64,
    /// Number of times that the decoder had to search for the next packet.
    pub resyncs: u64,
    /// Packets that the decoder refused, by reason. Formats that mark no ends of packets have none.
    pub invalid: InvalidPackets,
    /// Readings returned.
    pub readings: u64,
    /// Readings that were dropped for a newer one, or were still queued at the end.
    pub dropped: u64,
    /// Number of times that the device was lost.
    pub losses: u64,
}

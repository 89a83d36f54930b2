//! Stage 1: The bytes of a sensor → [`Reading`].
//!
//! A [`protocol`] decodes the bytes of a stream. Files of motion capture ([`bvh`]) and markers seen by cameras ([`markers`]) have
//! decoders of their own. Nothing here opens a file, a socket or a device.

pub mod body;
pub mod bvh;
mod error;
pub mod feedback;
pub mod markers;
pub mod protocol;

use std::time::Duration;

use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};

use self::body::BodyLandmarks;
use crate::hand::{BoneRotations, Displacement, HandPart, JointAngles, JointPositions, Side};
use crate::time::Timestamp;

pub use error::CaptureError;
pub use feedback::Haptics;
pub use protocol::hc11::{self, Hc11Format};
pub use protocol::{InvalidPacket, InvalidPackets, PositionNoise, StreamFormat};

/// Largest number of channels in a reading: the eight converters of the HC11 glove have eight inputs each.
pub const MAX_CHANNELS: usize = 64;

/// Pause before the readings of a sender that has started again, in a file: longer than the stall timeout unless the setup says otherwise.
pub const RESTART_PAUSE: Duration = Duration::from_secs(1);

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
    /// Rotations of the bones of both arms, used as a body is.
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

    /// Returns `true` if each sample shows both arms.
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
    /// One count for each channel, 0..=`full_scale`; [`UNKNOWN`](Self::UNKNOWN) for a channel that was not measured.
    #[serde(rename = "channels")]
    pub counts: ArrayVec<u16, MAX_CHANNELS>,
    /// Channels that the packet does not carry: they have the counts of a sensor at rest.
    #[serde(skip)]
    pub unsent: ChannelSet,
}

impl Channels {
    /// The count of a channel that was not measured. No converter has so large a count.
    pub const UNKNOWN: u16 = u16::MAX;

    /// Returns `true` if a channel that was measured has a count larger than the full scale.
    pub fn has_impossible_counts(&self) -> bool {
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

    /// Adds a channel, which must be less than [`MAX_CHANNELS`].
    pub fn insert(&mut self, channel: usize) {
        debug_assert!(channel < MAX_CHANNELS);
        self.0 |= 1 << (channel % MAX_CHANNELS);
    }

    /// Returns `true` if a channel is in the set.
    pub const fn contains(self, channel: usize) -> bool {
        channel < MAX_CHANNELS && self.0 >> channel & 1 == 1
    }

    /// Returns the channels that are in both sets.
    #[must_use]
    pub const fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

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
    /// Readings of a hand that the setup does not use. They are not counted in `readings`.
    #[serde(skip)]
    pub left_out: u64,
    /// Number of times that another sender has followed the previous one, for a source that accepts several senders.
    #[serde(skip)]
    pub sender_changes: u64,
    /// The offset of the byte at which a recording is cut off, once the reader has reached it.
    pub cut_at: Option<u64>,
}

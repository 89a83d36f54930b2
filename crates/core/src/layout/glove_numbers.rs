//! The numbers of glove files, with their ranges.

use serde::Deserialize;

use crate::capture::{Channels, MAX_CHANNELS};
use crate::document::{FieldType, Shape, ranged_numbers};

ranged_numbers! {
    /// An offset of a channel, in counts.
    OffsetCounts = "an offset", -1e6 ..= 1e6, " counts";
    /// An offset of an angle, in radians.
    OffsetRad = "an offset", -1e6 ..= 1e6, " rad";
    /// The change of an angle over the range of a channel, in radians.
    AngleRange = "an angle", -1e6 ..= 1e6, " rad";
}

/// Index of a channel.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "i64")]
pub(super) struct Channel(pub(super) usize);

impl FieldType for Channel {
    fn shape() -> Shape {
        Shape::Integer {
            min: 0,
            max: MAX_CHANNELS as i64 - 1,
        }
    }
}

impl TryFrom<i64> for Channel {
    type Error = String;

    fn try_from(index: i64) -> Result<Self, String> {
        let channel = usize::try_from(index).ok();
        let channel = channel.filter(|channel| *channel < MAX_CHANNELS);
        channel.map(Self).ok_or_else(|| {
            let last = MAX_CHANNELS - 1;
            format!("channel {index} does not exist, channels are 0 to {last}")
        })
    }
}

/// The largest count of a channel.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "i64")]
pub(super) struct FullScaleCounts(pub(super) u16);

impl FieldType for FullScaleCounts {
    fn shape() -> Shape {
        Shape::Integer {
            min: 2,
            max: i64::from(Channels::UNKNOWN) - 1,
        }
    }
}

impl TryFrom<i64> for FullScaleCounts {
    type Error = &'static str;

    fn try_from(counts: i64) -> Result<Self, Self::Error> {
        let counts = u16::try_from(counts).ok();
        let counts = counts.filter(|counts| (2..Channels::UNKNOWN).contains(counts));
        counts
            .map(Self)
            .ok_or("this is the largest count of a channel, 2 to 65534, such as 255 for 8 bits")
    }
}

/// The change of an angle over the range of a channel, in radians, not 0.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "AngleRange")]
pub(super) struct FullScaleRad(pub(super) f64);

impl FieldType for FullScaleRad {
    fn shape() -> Shape {
        AngleRange::shape()
    }
}

impl TryFrom<AngleRange> for FullScaleRad {
    type Error = &'static str;

    fn try_from(angle: AngleRange) -> Result<Self, Self::Error> {
        match angle.get() {
            0.0 => Err(
                "an angle that does not change is 0: set another value, or `disabled` for the row",
            ),
            angle => Ok(Self(angle)),
        }
    }
}

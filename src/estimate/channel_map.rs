//! Channel maps: the assignment of sensor channels to joint angles.

use super::calibration::AffineMap;
use crate::capture::MAX_CHANNELS;
use crate::hand::{Dof, FingerSet};

/// The most rows of a channel map: two for each degree of freedom, more than any glove needs.
pub const MAX_ROWS: usize = 2 * Dof::COUNT;

/// The assignment of one sensor channel to one angle. Several rows may share a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelRow {
    /// The name of the sensor in the documentation of the glove.
    pub label: String,
    /// The angle that the sensor measures.
    pub dof: Dof,
    /// The index of the channel in a reading.
    pub channel: usize,
    /// The map from counts to radians.
    pub calibration: AffineMap,
}

/// The channels of a glove that are in use. If two rows have the same angle, the later one takes precedence.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelMap {
    rows: Vec<ChannelRow>,
    full_scale: u16,
}

impl ChannelMap {
    /// Creates a map for converters with counts of 0..=`full_scale`.
    ///
    /// # Panics
    /// If a row has a channel of 64 or more, which no reading has.
    pub fn new(rows: Vec<ChannelRow>, full_scale: u16) -> Self {
        assert!(
            rows.iter().all(|row| row.channel < MAX_CHANNELS),
            "a channel is at most {}",
            MAX_CHANNELS - 1
        );
        Self { rows, full_scale }
    }

    /// Returns the rows, in order.
    pub fn rows(&self) -> &[ChannelRow] {
        &self.rows
    }

    /// Returns the largest count of a channel.
    pub fn full_scale(&self) -> u16 {
        self.full_scale
    }

    /// Returns the number of channels that a reading must have.
    pub fn required_channels(&self) -> usize {
        self.rows
            .iter()
            .map(|row| row.channel + 1)
            .max()
            .unwrap_or(0)
    }

    /// Returns the fingers whose position depends on `channel`: all if it moves the whole hand.
    pub fn fingers_affected_by(&self, channel: usize) -> FingerSet {
        self.rows.iter().filter(|row| row.channel == channel).fold(
            FingerSet::NONE,
            |fingers, row| match row.dof.finger() {
                Some(finger) => fingers.with(finger),
                None => FingerSet::ALL,
            },
        )
    }
}

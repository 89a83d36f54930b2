//! Which sensor channel tells which angle.

use super::calibration::AffineMap;
use crate::capture::MAX_CHANNELS;
use crate::hand::{Dof, FingerSet};

/// One sensor channel that tells one angle. Several rows may share a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelRow {
    /// What the glove's makers call it.
    pub label: String,
    /// The angle that it tells.
    pub dof: Dof,
    /// The channel in wire order, from 0.
    pub channel: usize,
    /// From counts to radians.
    pub calibration: AffineMap,
}

/// All channels of a glove that are in use. Where two rows tell the same angle, the later one counts.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelMap {
    rows: Vec<ChannelRow>,
    full_scale: u16,
}

impl ChannelMap {
    /// A map for converters that give counts of 0..=`full_scale`.
    ///
    /// # Panics
    /// When a row names a channel that no reading can carry (64 or more).
    pub fn new(rows: Vec<ChannelRow>, full_scale: u16) -> Self {
        assert!(
            rows.iter().all(|row| row.channel < MAX_CHANNELS),
            "a channel is at most {}",
            MAX_CHANNELS - 1
        );
        Self { rows, full_scale }
    }

    /// The rows, in order.
    pub fn rows(&self) -> &[ChannelRow] {
        &self.rows
    }

    /// The largest count of a channel.
    pub fn full_scale(&self) -> u16 {
        self.full_scale
    }

    /// How many channels a reading needs to have.
    pub fn required_channels(&self) -> usize {
        self.rows
            .iter()
            .map(|row| row.channel + 1)
            .max()
            .unwrap_or(0)
    }

    /// The fingers that cannot be placed without `channel`: all of them when it moves the whole hand.
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

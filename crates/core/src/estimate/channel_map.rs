//! Channel maps: the assignment of sensor channels to joint angles.

use super::calibration::{AffineMap, CountRange};
use super::learned_range::LearnedRange;
use super::linearity::Linearity;
use crate::capture::MAX_CHANNELS;
use crate::hand::{Dof, FingerSet, Input};

/// Maximum number of rows of a channel map: two for each degree of freedom, more than any glove needs.
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

/// The assignment of one channel to a stick, trigger or button of the glove.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputRow {
    /// The input that the channel measures.
    pub input: Input,
    /// The index of the channel in a reading.
    pub channel: usize,
    /// The map from counts to the value of the input, which is clamped to −1..=1.
    pub calibration: AffineMap,
}

/// The channels of a glove that are in use. If two rows have the same angle, the later one takes precedence.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelMap {
    rows: Vec<ChannelRow>,
    inputs: Vec<InputRow>,
    assumed: Vec<(Dof, f64)>,
    curvatures: Vec<(usize, f64)>,
    hystereses: Vec<(usize, f64)>,
    ranges: Vec<(usize, CountRange)>,
    full_scale: u16,
    uses_full_range: bool,
}

/// The largest [curvature](ChannelMap::with_curvatures) as a fraction of the full scale. The linear counts of more than a
/// quarter would not rise with every count.
pub const MAX_CURVATURE: f64 = 0.2;

/// The largest [hysteresis](ChannelMap::with_hystereses) as a fraction of the full scale.
pub const MAX_HYSTERESIS: f64 = 0.2;

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
        Self {
            rows,
            inputs: Vec::new(),
            assumed: Vec::new(),
            curvatures: Vec::new(),
            hystereses: Vec::new(),
            ranges: Vec::new(),
            full_scale,
            uses_full_range: false,
        }
    }

    /// Adds the sticks, triggers and buttons of the glove.
    ///
    /// # Panics
    /// If a row has a channel of 64 or more, which no reading has.
    #[must_use]
    pub fn with_inputs(self, inputs: Vec<InputRow>) -> Self {
        assert!(inputs.iter().all(|row| row.channel < MAX_CHANNELS));
        Self { inputs, ..self }
    }

    /// Sets the angles that the glove does not measure, in radians.
    #[must_use]
    pub fn with_assumed_angles(self, assumed: Vec<(Dof, f64)>) -> Self {
        Self { assumed, ..self }
    }

    /// Sets the curvatures of channels: the counts by which a channel is above a straight line in the middle of the full scale,
    /// less by a parabola towards its ends.
    ///
    /// # Panics
    /// If a curvature is larger than [`MAX_CURVATURE`] of the full scale.
    #[must_use]
    pub fn with_curvatures(self, curvatures: Vec<(usize, f64)>) -> Self {
        let limit = MAX_CURVATURE * f64::from(self.full_scale);
        assert!(curvatures.iter().all(|(_, counts)| counts.abs() <= limit));
        Self { curvatures, ..self }
    }

    /// Sets the hystereses of channels: the difference between the counts of one bend after the sensor has moved to it from either
    /// side. A channel without one has none.
    ///
    /// # Panics
    /// If a hysteresis is negative, or larger than [`MAX_HYSTERESIS`] of the full scale.
    #[must_use]
    pub fn with_hystereses(self, hystereses: Vec<(usize, f64)>) -> Self {
        let limit = MAX_HYSTERESIS * f64::from(self.full_scale);
        let mut counts = hystereses.iter().map(|(_, counts)| *counts);
        assert!(counts.all(|counts| (0.0..=limit).contains(&counts)));
        Self { hystereses, ..self }
    }

    /// Sets the smallest and the largest count of channels in the poses of their calibration. A channel without a range, or with
    /// an empty one, is not widened by [learning](super::EstimatorSettings::learn_ranges).
    #[must_use]
    pub fn with_ranges(self, ranges: Vec<(usize, CountRange)>) -> Self {
        Self { ranges, ..self }
    }

    /// Returns the map with the learned ranges of its channels.
    #[must_use]
    pub fn with_learned_ranges(mut self, learned: &[LearnedRange]) -> Self {
        for range in learned {
            let Some(counts) = self.range(range.channel) else {
                continue;
            };
            let linearity = self.linearity(range.channel);
            let ends = (linearity.apply(counts.0), linearity.apply(counts.1));
            let correction = range.correction(ends);
            let rows = self.rows.iter_mut();
            for row in rows.filter(|row| row.channel == range.channel) {
                row.calibration = row.calibration.after(&correction);
            }
        }
        self
    }

    /// Returns the map with other calibrations of its rows, in their order.
    #[must_use]
    pub fn with_calibrations(mut self, calibrations: &[AffineMap]) -> Self {
        for (row, &calibration) in self.rows.iter_mut().zip(calibrations) {
            row.calibration = calibration;
        }
        self
    }

    /// Returns the map with the channel `new_channel(old)` in place of each channel `old` of its rows.
    ///
    /// # Panics
    /// If a new channel is 64 or more, which no reading has.
    #[must_use]
    pub fn with_channels(mut self, new_channel: impl Fn(usize) -> usize) -> Self {
        for row in &mut self.rows {
            row.channel = new_channel(row.channel);
            assert!(row.channel < MAX_CHANNELS);
        }
        self
    }

    /// Sets whether counts are at the ends of their range in normal use, as in a glove that scales them itself. In other
    /// gloves such a count is a broken wire.
    #[must_use]
    pub fn with_full_range(self, uses_full_range: bool) -> Self {
        Self {
            uses_full_range,
            ..self
        }
    }

    /// Returns the sticks, triggers and buttons.
    pub fn inputs(&self) -> &[InputRow] {
        &self.inputs
    }

    /// Returns the angles that the glove does not measure, in radians.
    pub fn assumed_angles(&self) -> &[(Dof, f64)] {
        &self.assumed
    }

    /// Returns the curvatures of channels, in counts; see [`with_curvatures`](Self::with_curvatures).
    pub fn curvatures(&self) -> &[(usize, f64)] {
        &self.curvatures
    }

    /// Returns the hystereses of channels, in counts; see [`with_hystereses`](Self::with_hystereses).
    pub fn hystereses(&self) -> &[(usize, f64)] {
        &self.hystereses
    }

    /// Returns the hysteresis of a channel in counts, 0 if it has none.
    pub fn hysteresis(&self, channel: usize) -> f64 {
        value_of(&self.hystereses, channel).unwrap_or(0.0)
    }

    /// Returns the calibrated ranges of channels, in counts; see [`with_ranges`](Self::with_ranges).
    pub fn ranges(&self) -> &[(usize, CountRange)] {
        &self.ranges
    }

    /// Returns the calibrated range of a channel; `None` if it is not known or empty.
    pub fn range(&self, channel: usize) -> Option<CountRange> {
        value_of(&self.ranges, channel).filter(|range| range.0 < range.1)
    }

    /// Returns the map from the counts of a channel to linear counts.
    pub fn linearity(&self, channel: usize) -> Linearity {
        let curvature = value_of(&self.curvatures, channel).unwrap_or(0.0);
        Linearity::new(curvature, self.full_scale)
    }

    /// Returns the angle of a row at a count, in radians.
    pub fn radians(&self, row: &ChannelRow, count: f64) -> f64 {
        row.calibration
            .apply(self.linearity(row.channel).apply(count))
    }

    /// Returns `true` if counts are at the ends of their range in normal use.
    pub fn uses_full_range(&self) -> bool {
        self.uses_full_range
    }

    /// Returns the rows, in order.
    pub fn rows(&self) -> &[ChannelRow] {
        &self.rows
    }

    /// Returns the largest count of a channel.
    pub fn full_scale(&self) -> u16 {
        self.full_scale
    }

    /// Returns the channels of all rows and inputs, some of them more than once.
    pub fn channels(&self) -> impl Iterator<Item = usize> {
        let angles = self.rows.iter().map(|row| row.channel);
        angles.chain(self.inputs.iter().map(|row| row.channel))
    }

    /// Returns the channels that measure angles, each once, in ascending order.
    pub fn angle_channels(&self) -> Vec<usize> {
        channels_of(&self.rows)
    }

    /// Returns the number of channels that a reading must have.
    pub fn required_channels(&self) -> usize {
        self.channels().max().map_or(0, |channel| channel + 1)
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

/// Returns the first value of a channel in a list of channels and values.
fn value_of<T: Copy>(values: &[(usize, T)], channel: usize) -> Option<T> {
    let own = values.iter().find(|(other, _)| *other == channel);
    own.map(|(_, value)| *value)
}

/// Returns the channels of rows, each once, in ascending order.
pub(crate) fn channels_of(rows: &[ChannelRow]) -> Vec<usize> {
    let mut channels: Vec<usize> = rows.iter().map(|row| row.channel).collect();
    channels.sort_unstable();
    channels.dedup();
    channels
}

//! The sensors of a simulated glove: joint angles to counts.

use super::noise::Noise;
use super::simulated_hand::GloveCounts;
use crate::capture::{Channels, MAX_CHANNELS, Sample};
use crate::estimate::{AffineMap, ChannelMap, InputRow, JointAngles, Linearity};
use crate::hand::{Dof, Input};

/// A glove on a simulated hand, with its converter. It knows the joint angles and nothing else of the person.
#[derive(Clone)]
pub(super) struct GloveSensor {
    full_scale: u16,
    /// The counts before the angles are added: the counts of the inputs, and of converters without a sensor.
    other_counts: GloveCounts,
    inputs: Vec<InputRow>,
    channels: Vec<SensedChannel>,
    noise: Noise,
}

/// A channel, and the angles that bend its sensor.
#[derive(Clone)]
struct SensedChannel {
    channel: usize,
    mappings: Vec<(Dof, AffineMap)>,
    linearity: Linearity,
    /// Half of the hysteresis of the glove file, in counts.
    reach: f64,
    /// The count in the middle of the hysteresis; `None` before the first reading.
    middle: Option<f64>,
}

impl GloveSensor {
    /// Creates the sensors of a glove.
    pub(super) fn new(map: &ChannelMap, noise: Noise) -> Self {
        let channels = map.angle_channels();
        let sensed = channels.into_iter().map(|channel| SensedChannel {
            channel,
            mappings: mappings(map, channel),
            linearity: map.linearity(channel),
            reach: map.hysteresis(channel) / 2.0,
            middle: None,
        });
        Self {
            full_scale: map.full_scale(),
            other_counts: resting_counts(map),
            inputs: map.inputs().to_vec(),
            channels: sensed.collect(),
            noise,
        }
    }

    /// Sets a stick, trigger or button.
    pub(super) fn set_input(&mut self, input: Input, value: f64) {
        for row in self.inputs.iter().filter(|row| row.input == input) {
            let count = row.calibration.apply_inverse(value).round();
            self.other_counts[row.channel] = count.clamp(0.0, f64::from(self.full_scale)) as u16;
        }
    }

    /// Sets the sticks, triggers and buttons of another glove of this kind.
    pub(super) fn keep_inputs(&mut self, other: &Self) {
        self.other_counts.clone_from(&other.other_counts);
    }

    /// Returns what the glove measures of a hand with these angles.
    pub(super) fn measure(&mut self, angles: &JointAngles) -> Sample {
        let mut channels = self.resting();
        self.measure_counts(angles, &mut channels.counts);
        Sample::Channels(channels)
    }

    /// Writes what the glove measures of a hand with these angles into an earlier sample.
    pub(super) fn measure_into(&mut self, angles: &JointAngles, sample: &mut Sample) {
        if !matches!(sample, Sample::Channels(_)) {
            *sample = Sample::Channels(self.resting());
        }
        if let Sample::Channels(channels) = sample {
            channels.counts.clone_from(&self.other_counts);
            self.measure_counts(angles, &mut channels.counts);
        }
    }

    fn resting(&self) -> Channels {
        Channels {
            full_scale: self.full_scale,
            counts: self.other_counts.clone(),
            unsent: Default::default(),
        }
    }

    fn measure_counts(&mut self, angles: &JointAngles, counts: &mut GloveCounts) {
        for sensed in &mut self.channels {
            let count = sensed.follow(angles) + self.noise.value();
            // The ends of the range are left out, as they mean a broken wire.
            let max = f64::from(self.full_scale - 1);
            counts[sensed.channel] = count.round().clamp(1.0, max) as u16;
        }
    }
}

impl SensedChannel {
    /// Bends the sensor, which follows the joint at a distance of half its hysteresis, and returns its count.
    fn follow(&mut self, angles: &JointAngles) -> f64 {
        let goal = self.linearity.apply_inverse(self.linear_count(angles));
        let middle = self.middle.unwrap_or(goal);
        let middle = middle.clamp(goal - self.reach, goal + self.reach);
        self.middle = Some(middle);
        middle
    }

    /// Returns the count of a channel without curvature: the mean over its angles, which describe the same bend.
    fn linear_count(&self, angles: &JointAngles) -> f64 {
        let counts = self.mappings.iter();
        let counts = counts.map(|(dof, map)| map.apply_inverse(angles.get(*dof)));
        counts.sum::<f64>() / self.mappings.len() as f64
    }
}

/// Returns the angles that a channel measures, without those that a later channel measures too, which the estimator uses.
fn mappings(map: &ChannelMap, channel: usize) -> Vec<(Dof, AffineMap)> {
    let rows = map.rows();
    let own = || rows.iter().filter(|row| row.channel == channel);
    let is_last = |dof: Dof| {
        let mut others = rows.iter().filter(|row| row.dof == dof);
        others.all(|row| row.channel <= channel)
    };
    let mut mappings: Vec<(Dof, AffineMap)> = own()
        .filter(|row| is_last(row.dof))
        .map(|row| (row.dof, row.calibration))
        .collect();
    if mappings.is_empty() {
        mappings.extend(own().map(|row| (row.dof, row.calibration)));
    }
    mappings
}

/// Returns the counts of a glove of which no stick, trigger and button is used.
fn resting_counts(map: &ChannelMap) -> GloveCounts {
    // The input of an unused converter floats. Half of the range cannot be taken for a packet header.
    let mut counts: GloveCounts = (0..MAX_CHANNELS).map(|_| map.full_scale() / 2).collect();
    for row in map.inputs() {
        counts[row.channel] = row.calibration.apply_inverse(0.0).round() as u16;
    }
    counts
}

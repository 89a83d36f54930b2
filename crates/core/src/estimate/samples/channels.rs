//! Samples of sensor channels: conversion to angles, and detection of broken sensors.

use std::time::Duration;

use super::channel_table::{ChannelTable, Conversion};
use crate::capture::Channels;
use crate::estimate::learned_range::RangeLearner;
use crate::estimate::limits::JointRange;
use crate::estimate::plausibility::Plausibility;
use crate::estimate::{
    AffineMap, ChannelMap, Estimate, EstimatorSettings, InputRow, LearnedRange, Linearity,
    Rejection,
};
use crate::hand::{Dof, DofSet, FingerSet, InputValues, JointAngles};
use crate::time::Timestamp;

/// The converter of one glove.
#[derive(Clone, Debug)]
pub(in crate::estimate) struct ChannelConverter {
    full_scale: u16,
    required_channels: usize,
    rows: Vec<ConverterRow>,
    inputs: Vec<InputRow>,
    assumed: Vec<(Dof, f64)>,
    health: Vec<ChannelHealth>,
    /// `true` if a channel was at an end of its range in the latest reading.
    was_at_rail: bool,
    /// All rows at once, for readings without exceptions.
    table: Option<ChannelTable>,
    /// `true` if a count at an end of the range is not a broken wire.
    uses_full_range: bool,
    /// The learners of channels with a calibrated range; none unless ranges are learned.
    learners: Vec<ChannelLearner>,
}

/// The conversion of one channel to one angle.
#[derive(Clone, Debug)]
struct ConverterRow {
    dof: Dof,
    linearity: Linearity,
    /// The calibration of the glove file.
    calibrated: AffineMap,
    /// The calibration for the learned range of the channel.
    calibration: AffineMap,
    range: JointRange,
    channel: usize,
    /// The index of the channel's [`ChannelHealth`].
    health: usize,
}

/// The learner of one channel, which measures a finger.
#[derive(Clone, Debug)]
struct ChannelLearner {
    learner: RangeLearner,
    /// The index of the channel's [`ChannelHealth`].
    health: usize,
}

/// The state of a channel in use: it is railed if its counts stay at one end of the range, as with a broken wire or a
/// short circuit.
#[derive(Clone, Debug)]
struct ChannelHealth {
    channel: usize,
    /// The fingers whose position depends on the channel.
    fingers: FingerSet,
    at_rail_since: Option<Timestamp>,
    is_railed: bool,
}

/// The exceptions in the channels of a reading.
#[derive(Default)]
struct Exceptions {
    has_unknown: bool,
    is_at_rail: bool,
}

impl ChannelConverter {
    pub(super) fn new(map: &ChannelMap, settings: &EstimatorSettings) -> Self {
        let limits = settings.limits.as_ref();
        let mut health: Vec<ChannelHealth> = Vec::new();
        let mut health_index = |channel: usize| {
            if let Some(index) = health.iter().position(|other| other.channel == channel) {
                return index;
            }
            health.push(ChannelHealth {
                channel,
                fingers: map.fingers_affected_by(channel),
                at_rail_since: None,
                is_railed: false,
            });
            health.len() - 1
        };
        let rows = map.rows().iter().map(|row| ConverterRow {
            dof: row.dof,
            linearity: map.linearity(row.channel),
            calibrated: row.calibration,
            calibration: row.calibration,
            range: limits.map_or(JointRange::ANY, |limits| limits.joint_range(row.dof)),
            channel: row.channel,
            health: health_index(row.channel),
        });
        let rows: Vec<ConverterRow> = rows.collect();
        let learners = if settings.learn_ranges {
            learners(map, &health)
        } else {
            Vec::new()
        };
        Self {
            full_scale: map.full_scale(),
            required_channels: map.required_channels(),
            rows,
            learners,
            inputs: map.inputs().to_vec(),
            assumed: map.assumed_angles().to_vec(),
            health,
            was_at_rail: false,
            table: ChannelTable::new(map, limits),
            uses_full_range: map.uses_full_range(),
        }
    }

    /// Converts counts to angles, adds `offsets`, and keeps them within the joint limits. Angles that are far outside are noted,
    /// and are an error unless they are unreliable or their channel is railed. A channel is railed once it has been at one end of
    /// its range for `rail_timeout`. Fingers with an unknown channel are untrusted.
    pub(super) fn convert(
        &mut self,
        channels: &Channels,
        rail_timeout: Option<Duration>,
        offsets: &JointAngles,
        plausibility: &mut Plausibility,
        estimate: &mut Estimate,
    ) -> Result<(), Rejection> {
        if channels.full_scale != self.full_scale || channels.counts.len() < self.required_channels
        {
            return Err(Rejection::WrongShape);
        }
        let table = self.table.as_ref();
        let converted = table.map(|table| table.convert(channels, offsets, &mut estimate.angles));
        let are_plain = converted.as_ref().is_some_and(|all| !all.has_exceptions);
        let Exceptions {
            has_unknown,
            is_at_rail,
        } = if are_plain {
            Exceptions::default()
        } else {
            self.exceptions(channels)
        };
        if let Some(timeout) = rail_timeout.filter(|_| !self.uses_full_range)
            && (is_at_rail || self.was_at_rail)
        {
            self.was_at_rail = is_at_rail;
            estimate.untrusted = self.update_health(estimate.time, channels, timeout);
        }
        if has_unknown {
            let unknown = self.unknown_fingers(channels);
            estimate.untrusted = estimate.untrusted.union(unknown);
        }
        self.write_inputs(channels, &mut estimate.inputs);
        let is_accepted = |all: &Conversion| all.are_accepted && !has_unknown;
        if !converted.as_ref().is_some_and(is_accepted) {
            estimate.angles = JointAngles::default();
            self.write_angles(channels, offsets, plausibility, &mut estimate.angles)?;
        }
        if estimate.angles.is_empty() && !self.rows.is_empty() {
            return Err(Rejection::WrongShape);
        }
        for &(dof, radians) in &self.assumed {
            estimate.angles.set(dof, radians);
        }
        Ok(())
    }

    /// Returns the channel that measures an angle.
    pub(in crate::estimate) fn channel_of(&self, dof: Dof) -> Option<usize> {
        let row = self.rows.iter().find(|row| row.dof == dof)?;
        Some(row.channel)
    }

    /// Adds an accepted reading to the learning of ranges, except for sensors of `unreliable` angles. Does not allocate.
    pub(in crate::estimate) fn observe_ranges(
        &mut self,
        time: Timestamp,
        channels: &Channels,
        unreliable: DofSet,
    ) {
        for ChannelLearner { learner, health } in &mut self.learners {
            let health = &self.health[*health];
            if health.is_railed {
                learner.note_fault();
            }
            // A count at a rail shows no joint: the sensor cannot say by how much it is beyond.
            if is_unknown(channels, health.channel)
                || health.at_rail_since.is_some()
                || unreliable.contains(learner.learned().dof)
            {
                learner.interrupt()
            } else {
                learner.observe(time, f64::from(channels.counts[health.channel]))
            }
        }
    }

    /// Discards what was observed of ranges and not learned yet.
    pub(in crate::estimate) fn forget_excursions(&mut self) {
        self.learners
            .iter_mut()
            .for_each(|own| own.learner.forget());
    }

    /// Returns `true` if a range is to be widened.
    pub(in crate::estimate) fn is_widening_due(&self) -> bool {
        self.learners.iter().any(|own| own.learner.is_due())
    }

    /// Widens the ranges that are due by a small step.
    pub(in crate::estimate) fn widen_ranges(&mut self) {
        self.learners.iter_mut().for_each(|own| own.learner.widen());
        self.apply_ranges();
    }

    /// Returns to the calibrated ranges.
    pub(in crate::estimate) fn undo_learning(&mut self) {
        self.learners.iter_mut().for_each(|own| own.learner.undo());
        self.apply_ranges();
    }

    /// Returns the ranges that were widened.
    pub(in crate::estimate) fn learned_ranges(&self) -> impl Iterator<Item = LearnedRange> {
        let learned = self.learners.iter().map(|own| *own.learner.learned());
        learned.filter(|learned| learned.largest() > 0.0)
    }

    fn apply_ranges(&mut self) {
        for ChannelLearner { learner, health } in &self.learners {
            let correction = learner.correction();
            let rows = self.rows.iter_mut();
            for row in rows.filter(|row| row.health == *health) {
                row.calibration = row.calibrated.after(&correction);
                if let Some(table) = &mut self.table {
                    table.set_calibration(row.dof, row.calibration);
                }
            }
        }
    }

    /// Looks for exceptions in the channels of all angles.
    fn exceptions(&self, channels: &Channels) -> Exceptions {
        let mut found = Exceptions::default();
        for health in &self.health {
            let count = channels.counts[health.channel];
            found.has_unknown |= count == Channels::UNKNOWN;
            found.is_at_rail |= (count == 0) | (count == self.full_scale);
        }
        found
    }

    /// Returns the fingers that depend on a channel that was not measured.
    fn unknown_fingers(&self, channels: &Channels) -> FingerSet {
        let is_unknown = |health: &&ChannelHealth| is_unknown(channels, health.channel);
        let unknown = self.health.iter().filter(is_unknown);
        unknown.fold(FingerSet::NONE, |fingers, health| {
            fingers.union(health.fingers)
        })
    }

    fn write_inputs(&self, channels: &Channels, inputs: &mut InputValues) {
        for row in &self.inputs {
            if !is_unknown(channels, row.channel) {
                let value = row
                    .calibration
                    .apply(f64::from(channels.counts[row.channel]));
                inputs.set(row.input, value.clamp(-1.0, 1.0) as f32);
            }
        }
    }

    /// Updates the state of every channel, and returns the fingers that depend on a railed one.
    fn update_health(
        &mut self,
        time: Timestamp,
        channels: &Channels,
        timeout: Duration,
    ) -> FingerSet {
        let mut untrusted = FingerSet::NONE;
        for health in &mut self.health {
            health.update(time, channels, timeout);
            if health.is_railed {
                untrusted = untrusted.union(health.fingers);
            }
        }
        untrusted
    }

    fn write_angles(
        &self,
        channels: &Channels,
        offsets: &JointAngles,
        plausibility: &mut Plausibility,
        angles: &mut JointAngles,
    ) -> Result<(), Rejection> {
        let mut outcome = Ok(());
        for row in &self.rows {
            if is_unknown(channels, row.channel) {
                continue;
            }
            let count = f64::from(channels.counts[row.channel]);
            let linear = row.linearity.apply(count);
            let radians = row.calibration.apply(linear) + offsets.get(row.dof);
            if !radians.is_finite() {
                return Err(Rejection::NotFinite);
            }
            if row.range.checked_clamp(radians).is_none()
                && !plausibility.note_outside(row.dof)
                && !self.health[row.health].is_railed
            {
                outcome = Err(Rejection::OutsideLimits);
            }
            angles.set(row.dof, row.range.clamp(radians));
        }
        outcome
    }
}

/// Returns a learner for each channel that measures only fingers and has a calibrated range. The arm moves all fingertips, so a
/// wrong range of its sensors does more harm than a drift.
fn learners(map: &ChannelMap, health: &[ChannelHealth]) -> Vec<ChannelLearner> {
    let learner = |(index, state): (usize, &ChannelHealth)| {
        let channel = state.channel;
        let range = map.range(channel)?;
        let mut rows = map.rows().iter().filter(|row| row.channel == channel);
        let dof = rows.clone().next()?.dof;
        let is_of_fingers = rows.all(|row| row.dof.finger().is_some());
        is_of_fingers.then(|| ChannelLearner {
            learner: RangeLearner::new(channel, dof, map.linearity(channel), range),
            health: index,
        })
    };
    health.iter().enumerate().filter_map(learner).collect()
}

fn is_unknown(channels: &Channels, channel: usize) -> bool {
    channels.counts[channel] == Channels::UNKNOWN
}

impl ChannelHealth {
    fn update(&mut self, time: Timestamp, channels: &Channels, timeout: Duration) {
        let count = channels.counts[self.channel];
        if count != 0 && count != channels.full_scale {
            self.at_rail_since = None;
            self.is_railed = false;
            return;
        }
        let since = *self.at_rail_since.get_or_insert(time);
        self.is_railed = time.since(since) >= timeout;
    }
}

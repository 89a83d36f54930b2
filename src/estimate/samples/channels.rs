//! Samples of sensor channels: conversion to angles, and detection of broken sensors.

use std::time::Duration;

use crate::capture::Channels;
use crate::estimate::limits::JointRange;
use crate::estimate::{
    AffineMap, ChannelMap, Estimate, InputRow, JointLimits, Linearity, Rejection,
};
use crate::hand::{Dof, FingerSet, InputValues, JointAngles};
use crate::time::Timestamp;

/// The converter of one glove.
#[derive(Clone, Debug)]
pub(super) struct ChannelConverter {
    full_scale: u16,
    required_channels: usize,
    rows: Vec<ConverterRow>,
    inputs: Vec<InputRow>,
    assumed: Vec<(Dof, f64)>,
    health: Vec<ChannelHealth>,
    /// A count at an end of the range is not a broken wire.
    uses_full_range: bool,
}

/// The conversion of one channel to one angle.
#[derive(Clone, Debug)]
struct ConverterRow {
    dof: Dof,
    linearity: Linearity,
    calibration: AffineMap,
    range: JointRange,
    channel: usize,
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

impl ChannelConverter {
    pub(super) fn new(map: &ChannelMap, limits: Option<&JointLimits>) -> Self {
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
            calibration: row.calibration,
            range: limits.map_or(JointRange::ANY, |limits| limits.joint_range(row.dof)),
            channel: row.channel,
            health: health_index(row.channel),
        });
        Self {
            full_scale: map.full_scale(),
            required_channels: map.required_channels(),
            rows: rows.collect(),
            inputs: map.inputs().to_vec(),
            assumed: map.assumed_angles().to_vec(),
            health,
            uses_full_range: map.uses_full_range(),
        }
    }

    /// Converts counts to angles, adds `offsets`, and keeps them within the joint limits. Angles of railed channels are clamped; others that are far
    /// outside are an error. A channel is railed once it has been at one end of its range for `rail_timeout`. Fingers with an
    /// unknown channel are untrusted.
    pub(super) fn convert(
        &mut self,
        channels: &Channels,
        rail_timeout: Option<Duration>,
        offsets: &JointAngles,
        estimate: &mut Estimate,
    ) -> Result<(), Rejection> {
        if channels.full_scale != self.full_scale || channels.counts.len() < self.required_channels
        {
            return Err(Rejection::WrongShape);
        }
        if let Some(timeout) = rail_timeout.filter(|_| !self.uses_full_range) {
            estimate.untrusted = self.update_health(estimate.time, channels, timeout);
        }
        estimate.untrusted = estimate.untrusted.union(self.unknown_fingers(channels));
        self.write_inputs(channels, &mut estimate.inputs);
        self.write_angles(channels, offsets, &mut estimate.angles)?;
        if estimate.angles.is_empty() && !self.rows.is_empty() {
            return Err(Rejection::WrongShape);
        }
        for &(dof, radians) in &self.assumed {
            estimate.angles.set(dof, radians);
        }
        Ok(())
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
        angles: &mut JointAngles,
    ) -> Result<(), Rejection> {
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
            let clamped = match row.range.checked_clamp(radians) {
                Some(clamped) => clamped,
                None if self.health[row.health].is_railed => row.range.clamp(radians),
                None => return Err(Rejection::OutsideLimits),
            };
            angles.set(row.dof, clamped);
        }
        Ok(())
    }
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

//! The channels of a glove: count, angle, and signs of a broken sensor.

use std::time::Duration;

use crate::capture::Channels;
use crate::estimate::ChannelMap;
use crate::hand::{Dof, JointAngles};
use crate::time::Timestamp;

/// Time without a change after which a channel is marked. A hand that is worn trembles.
const UNCHANGED_AFTER: Duration = Duration::from_secs(10);

/// The state of a channel, as far as its counts show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChannelState {
    /// No sign of a fault.
    Good,
    /// The count is at an end of its range, as with a broken wire.
    AtEnd,
    /// The count has not changed for 10 s.
    Unchanged,
}

/// A channel and the angle that it measures.
#[derive(Clone, Debug)]
pub struct SensorRow {
    /// Name in the documentation of the glove.
    pub label: String,
    /// The angle.
    pub dof: Dof,
    /// Index of the channel in a reading.
    pub channel: usize,
    /// The latest count; `None` before the first reading.
    pub count: Option<u16>,
    changed_at: Timestamp,
}

/// The channels of a glove in use.
#[derive(Clone, Debug, Default)]
pub struct SensorTable {
    rows: Vec<SensorRow>,
    full_scale: u16,
    time: Timestamp,
    is_seen: bool,
}

impl SensorTable {
    /// Creates the table of a glove.
    pub fn new(map: &ChannelMap) -> Self {
        let rows = map.rows().iter().map(|row| SensorRow {
            label: row.label.clone(),
            dof: row.dof,
            channel: row.channel,
            count: None,
            changed_at: Timestamp::default(),
        });
        Self {
            rows: rows.collect(),
            ..Self::default()
        }
    }

    /// Processes the counts of a reading.
    pub fn update(&mut self, time: Timestamp, channels: &Channels) {
        let is_first = !self.is_seen || time < self.time;
        (self.time, self.full_scale, self.is_seen) = (time, channels.full_scale, true);
        for row in &mut self.rows {
            let count = channels.counts.get(row.channel).copied();
            if is_first || count != row.count {
                row.changed_at = time;
            }
            row.count = count;
        }
    }

    /// Returns the rows, in the order of the glove file.
    pub fn rows(&self) -> &[SensorRow] {
        &self.rows
    }

    /// Returns `true` after the first reading with channels.
    pub fn is_seen(&self) -> bool {
        self.is_seen
    }

    /// Returns the count of a row as a fraction of the full scale.
    pub fn fraction(&self, row: &SensorRow) -> f32 {
        let count = row.count.filter(|count| *count <= self.full_scale);
        f32::from(count.unwrap_or_default()) / f32::from(self.full_scale.max(1))
    }

    /// Returns the state of the channel of a row.
    pub fn state(&self, row: &SensorRow) -> ChannelState {
        let is_at_end = |count| count == 0 || count >= self.full_scale;
        match row.count {
            Some(count) if is_at_end(count) => ChannelState::AtEnd,
            Some(_) if self.time.since(row.changed_at) >= UNCHANGED_AFTER => {
                ChannelState::Unchanged
            }
            _ => ChannelState::Good,
        }
    }
}

impl SensorRow {
    /// Returns the present angle in degrees.
    pub fn degrees(&self, angles: Option<&JointAngles>) -> Option<f64> {
        let angles = angles.filter(|angles| angles.is_known(self.dof))?;
        Some(angles.get(self.dof).to_degrees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{AffineMap, ChannelRow};

    #[test]
    fn broken_and_unchanged_channels_are_marked() {
        let row = |channel| ChannelRow {
            label: format!("S{channel}"),
            dof: Dof::ALL[channel],
            channel,
            calibration: AffineMap {
                gain: 0.01,
                offset: 0.0,
            },
        };
        let map = ChannelMap::new((0..3).map(row).collect(), 255);
        let mut table = SensorTable::new(&map);
        for second in 0..=10_u16 {
            let channels = Channels {
                full_scale: 255,
                counts: [255, 100, 100 + second].into_iter().collect(),
            };
            table.update(Timestamp(u64::from(second) * 1_000_000), &channels);
        }
        let states: Vec<_> = table.rows().iter().map(|row| table.state(row)).collect();
        let expected = [
            ChannelState::AtEnd,
            ChannelState::Unchanged,
            ChannelState::Good,
        ];
        assert_eq!(states, expected);
    }
}

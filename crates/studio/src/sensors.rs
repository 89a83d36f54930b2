//! The channels of a glove: count, joints, and signs of a broken sensor.

use ademan_core::estimate::{ChannelMap, CountRange, JointLimits};
use ademan_core::hand::{Dof, Finger, JointAngles, Side};
use ademan_core::time::Timestamp;
use ademan_runtime::capture::{Channels, Reading};
use ademan_runtime::setup::LoadedSetup;

/// Movement of a neighboring joint, as a fraction of the full scale, during which a working sensor of the same finger changes.
const NEIGHBOR_MOVEMENT: f64 = 0.15;

/// The state of a channel, as far as its counts show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChannelState {
    /// No sign of a fault.
    Good,
    /// The readings do not contain the channel, or not its value.
    Missing,
    /// The count is 0, as with a broken wire.
    AtLowEnd,
    /// The count is the full scale, as with a short circuit.
    AtHighEnd,
    /// The count has never changed, although the same finger has bent at another sensor.
    Stuck,
}

/// A joint that a channel measures.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelJoint {
    /// Index of the row in the channel map.
    pub row: usize,
    /// The angle.
    pub dof: Dof,
    /// The counts at the limits of the joint, in ascending order, as far as they are within the full scale.
    pub limits: [Option<f64>; 2],
}

/// A channel and the joints that it measures.
#[derive(Clone, Debug)]
pub struct SensorRow {
    /// Name in the documentation of the glove.
    pub label: String,
    /// Index of the channel in a reading.
    pub channel: usize,
    /// The joints, in the order of the glove file.
    pub joints: Vec<ChannelJoint>,
    /// The range of the calibration, in counts.
    pub range: Option<CountRange>,
    /// The latest count; `None` before the first reading and without a value.
    pub count: Option<u16>,
    /// The smallest and the largest count so far.
    seen: Option<(u16, u16)>,
}

/// The channels of a glove in use.
#[derive(Clone, Debug, Default)]
pub struct SensorTable {
    rows: Vec<SensorRow>,
    full_scale: u16,
    uses_full_range: bool,
    /// The hand is simulated: its sensors cannot get stuck, and without noise a joint is perfectly still.
    is_simulated: bool,
    /// The other hand of the session, whose readings are not of this glove.
    other_side: Option<Side>,
    time: Timestamp,
    is_seen: bool,
}

impl SensorTable {
    /// Creates the table of a glove.
    pub fn new(map: &ChannelMap) -> Self {
        let mut table = Self {
            full_scale: map.full_scale(),
            uses_full_range: map.uses_full_range(),
            ..Self::default()
        };
        for row in map.rows() {
            if table.rows.iter().all(|known| known.channel != row.channel) {
                table.rows.push(SensorRow {
                    label: row.label.clone(),
                    channel: row.channel,
                    joints: Vec::new(),
                    range: None,
                    count: None,
                    seen: None,
                });
            }
        }
        table.set_calibration(map);
        table
    }

    /// Sets whether the hand is simulated, whose still joints are no fault.
    #[must_use]
    pub fn with_simulated(self, is_simulated: bool) -> Self {
        Self {
            is_simulated,
            ..self
        }
    }

    /// Sets the other hand of the session, if it has one. Its readings have channels of their own with the same indices.
    #[must_use]
    pub fn with_other_hand(self, other_side: Option<Side>) -> Self {
        Self { other_side, ..self }
    }

    /// Returns `true` if a reading is of the first hand of the session, whose glove this is.
    pub fn is_of(&self, reading: &Reading) -> bool {
        is_of_first_hand(reading, self.other_side)
    }

    /// Returns the side of the first hand of a session with two.
    pub fn side_of_two(&self) -> Option<Side> {
        self.other_side.map(Side::opposite)
    }

    /// Shows another calibration of the same glove.
    pub fn set_calibration(&mut self, map: &ChannelMap) {
        for row in &mut self.rows {
            let indexed = map.rows().iter().enumerate();
            let own = indexed.filter(|(_, other)| other.channel == row.channel);
            row.joints = own
                .map(|(index, own)| ChannelJoint {
                    row: index,
                    dof: own.dof,
                    limits: limit_counts(map, index),
                })
                .collect();
            row.range = map.range(row.channel);
        }
    }

    /// Processes the counts of a reading.
    pub fn update(&mut self, time: Timestamp, channels: &Channels) {
        let is_first = !self.is_seen || time < self.time;
        (self.time, self.full_scale, self.is_seen) = (time, channels.full_scale, true);
        for row in &mut self.rows {
            let count = channels.counts.get(row.channel).copied();
            row.count = count.filter(|count| *count != Channels::UNKNOWN);
            if is_first {
                row.seen = None;
            }
            if let Some(present) = row.count {
                let (low, high) = row.seen.unwrap_or((present, present));
                row.seen = Some((low.min(present), high.max(present)));
            }
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

    /// Returns a number of counts as a fraction of the full scale, 0..=1.
    pub fn fraction(&self, count: f64) -> f32 {
        (count / f64::from(self.full_scale.max(1))).clamp(0.0, 1.0) as f32
    }

    /// Returns the full scale in counts.
    pub fn full_scale(&self) -> u16 {
        self.full_scale
    }

    /// Returns the state of the channel of a row.
    pub fn state(&self, row: &SensorRow) -> ChannelState {
        match row.count {
            None if self.is_seen => ChannelState::Missing,
            Some(0) if !self.uses_full_range => ChannelState::AtLowEnd,
            Some(count) if count >= self.full_scale && !self.uses_full_range => {
                ChannelState::AtHighEnd
            }
            Some(_) if self.is_stuck(row) => ChannelState::Stuck,
            _ => ChannelState::Good,
        }
    }

    fn is_stuck(&self, row: &SensorRow) -> bool {
        !self.is_simulated && row.is_constant() && self.has_neighbor_moved(row)
    }

    /// Returns `true` if another sensor has bent the finger of this one far. A finger bends at all its joints; a hand that rests may
    /// hold an arm still.
    fn has_neighbor_moved(&self, row: &SensorRow) -> bool {
        let Some(finger) = row.bent_finger() else {
            return false;
        };
        let enough = NEIGHBOR_MOVEMENT * f64::from(self.full_scale);
        let neighbors = self.rows.iter();
        let mut neighbors = neighbors
            .filter(|other| other.channel != row.channel && other.bent_finger() == Some(finger));
        neighbors.any(|other| {
            let seen = other.seen.unwrap_or_default();
            f64::from(seen.1 - seen.0) >= enough
        })
    }
}

impl SensorRow {
    /// Returns the present angle of a joint in degrees.
    pub fn degrees(dof: Dof, angles: Option<&JointAngles>) -> Option<f64> {
        let angles = angles.filter(|angles| angles.is_known(dof))?;
        Some(angles.get(dof).to_degrees())
    }

    fn is_constant(&self) -> bool {
        self.seen.is_some_and(|(low, high)| low == high)
    }

    /// Returns the finger whose bend the channel measures. Neither a spread nor the thumb bends with its neighbors.
    fn bent_finger(&self) -> Option<Finger> {
        let mut joints = self.joints.iter();
        let bent = joints.find(|joint| joint.dof.name().ends_with("-flexion"))?;
        bent.dof.finger().filter(|finger| *finger != Finger::Thumb)
    }
}

/// Returns the side of the other hand of a setup, if it has one.
pub fn other_side(setup: &LoadedSetup) -> Option<Side> {
    setup.other_hand.as_ref().map(|hand| hand.arm.side())
}

/// Returns `true` if a reading is of the first hand of a session whose other hand is on this side.
pub fn is_of_first_hand(reading: &Reading, other_side: Option<Side>) -> bool {
    other_side.is_none_or(|other| reading.side != Some(other))
}

/// Returns the counts at which a row reaches the limits of its joint, in ascending order, as far as they are within the full
/// scale.
fn limit_counts(map: &ChannelMap, index: usize) -> [Option<f64>; 2] {
    let row = &map.rows()[index];
    let (low, high) = JointLimits::human().range(row.dof);
    let full_scale = f64::from(map.full_scale());
    let mut counts = [low, high].map(|radians| {
        let linear = row.calibration.apply_inverse(radians);
        map.linearity(row.channel).apply_inverse(linear)
    });
    counts.sort_by(f64::total_cmp);
    counts.map(|count| (0.0..=full_scale).contains(&count).then_some(count))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::model::tests::{hand, snapshot};
    use crate::scene::tests::model_of;
    use ademan_core::estimate::{AffineMap, ChannelRow};
    use ademan_core::layout::Layout;
    use ademan_core::pipeline::PipelineState;
    use ademan_core::snapshot::Snapshot;
    use ademan_runtime::capture::Sample;
    use ademan_runtime::files::Load;

    fn row(dof: Dof, channel: usize) -> ChannelRow {
        ChannelRow {
            label: format!("S{channel}"),
            dof,
            channel,
            calibration: AffineMap {
                gain: 0.01,
                offset: 0.0,
            },
        }
    }

    fn update(table: &mut SensorTable, second: u64, counts: &[u16]) {
        let channels = Channels {
            full_scale: 255,
            counts: counts.iter().copied().collect(),
            unsent: Default::default(),
        };
        table.update(Timestamp(second * 1_000_000), &channels);
    }

    fn states(table: &SensorTable) -> Vec<ChannelState> {
        table.rows().iter().map(|row| table.state(row)).collect()
    }

    #[test]
    fn a_channel_of_two_joints_is_one_row() {
        let rows = vec![row(Dof::IndexDipFlexion, 1), row(Dof::IndexPipFlexion, 1)];
        let table = SensorTable::new(&ChannelMap::new(rows, 255));
        let [row] = table.rows() else {
            panic!("{:?}", table.rows());
        };
        let joints: Vec<_> = row
            .joints
            .iter()
            .map(|joint| (joint.row, joint.dof))
            .collect();
        assert_eq!(
            joints,
            [(0, Dof::IndexDipFlexion), (1, Dof::IndexPipFlexion)]
        );
        let [low, high] = row.joints[0].limits.map(|count| count.unwrap().round());
        assert_eq!((low, high), (0.0, 157.0), "0° to 90° at 0.01 rad per count");
    }

    #[test]
    fn an_unmoved_arm_is_good_and_an_unmoved_joint_of_a_bent_finger_is_stuck() {
        let dofs = [
            Dof::ElbowFlexion,
            Dof::IndexMcpFlexion,
            Dof::IndexPipFlexion,
            Dof::IndexMcpAbduction,
        ];
        let rows = dofs.iter().enumerate();
        let rows = rows.map(|(channel, &dof)| row(dof, channel)).collect();
        let mut table = SensorTable::new(&ChannelMap::new(rows, 255));
        for second in 0..60 {
            update(&mut table, second, &[100, 100, 100, 100]);
        }
        assert_eq!(states(&table), [ChannelState::Good; 4]);
        update(&mut table, 60, &[100, 150, 100, 100]);
        let mut expected = [ChannelState::Good; 4];
        expected[2] = ChannelState::Stuck;
        assert_eq!(states(&table), expected);
        let simulated = table.with_simulated(true);
        assert_eq!(states(&simulated), [ChannelState::Good; 4]);
    }

    #[test]
    fn channels_at_an_end_and_without_a_value_are_marked() {
        let rows = (0..4).map(|channel| row(Dof::ALL[channel], channel));
        let map = ChannelMap::new(rows.collect(), 255);
        let counts = [255, 0, Channels::UNKNOWN, 7];
        let mut table = SensorTable::new(&map);
        assert_eq!(states(&table), [ChannelState::Good; 4], "no reading yet");
        update(&mut table, 0, &counts);
        let expected = [
            ChannelState::AtHighEnd,
            ChannelState::AtLowEnd,
            ChannelState::Missing,
            ChannelState::Good,
        ];
        assert_eq!(states(&table), expected);
        let mut full = SensorTable::new(&map.with_full_range(true));
        update(&mut full, 0, &counts);
        assert_eq!(states(&full)[..2], [ChannelState::Good; 2]);
    }

    /// Returns a step with a reading of a glove and the pose of its hand.
    fn step(side: Side, second: u64, count: u16, angle: f64) -> Snapshot {
        let mut pose = hand(second);
        pose.side = side;
        let channels = Channels {
            full_scale: 255,
            counts: [count].into_iter().collect(),
            unsent: Default::default(),
        };
        let mut angles = JointAngles::default();
        angles.set(Dof::IndexPipFlexion, angle);
        Snapshot {
            reading: Some(Reading::new(
                pose.time,
                Some(side),
                Sample::Channels(channels),
            )),
            pose: Some(pose),
            angles: Some(angles),
            ..snapshot(PipelineState::Running)
        }
    }

    #[test]
    fn counts_and_angles_are_of_the_first_of_two_gloves() {
        let map = ChannelMap::new(vec![row(Dof::IndexPipFlexion, 0)], 255);
        let shown = |other_side: Option<Side>| {
            let mut model = model_of(Arc::new(Layout::load("qwerty-flat").unwrap()));
            model.sensors = SensorTable::new(&map).with_other_hand(other_side);
            model.update(&step(Side::Right, 1, 20, 0.5));
            model.update(&step(Side::Left, 2, 90, 1.5));
            let angle = model.angles.unwrap().get(Dof::IndexPipFlexion);
            let last = model.history.moments().next_back().unwrap();
            let plotted = last.degrees[Dof::IndexPipFlexion.index()];
            (
                model.sensors.rows()[0].count,
                angle,
                plotted.round(),
                model.poses.iter().flatten().count(),
            )
        };
        let degrees = |radians: f32| radians.to_degrees().round();
        assert_eq!(
            shown(Some(Side::Left)),
            (Some(20), 0.5, degrees(0.5), 2),
            "the other hand moves nothing of the first one"
        );
        assert_eq!(shown(None), (Some(90), 1.5, degrees(1.5), 2));
    }

    #[test]
    fn the_angles_of_a_first_hand_that_is_lost_have_a_gap() {
        let map = ChannelMap::new(vec![row(Dof::IndexPipFlexion, 0)], 255);
        let mut model = model_of(Arc::new(Layout::load("qwerty-flat").unwrap()));
        model.sensors = SensorTable::new(&map).with_other_hand(Some(Side::Left));
        model.update(&step(Side::Right, 1, 20, 0.5));
        let mut next = step(Side::Left, 2, 90, 1.5);
        next.lost_hands[Side::Right.index()] = true;
        model.update(&next);
        let last = model.history.moments().next_back().unwrap();
        assert_eq!(last.time, Timestamp(2_000_000));
        assert!(last.degrees.iter().all(|degrees| degrees.is_nan()));
    }
}

//! The bend of each finger, as a fraction of its range. It needs neither the arm nor the position of the hand, which a simple glove
//! does not measure.

use super::{ChannelMap, JointLimits};
use crate::hand::{Dof, Finger, JointAngles};

/// The smallest range of a joint that is measured, in radians: 20°. A sensor with less has not been calibrated with a fist.
const MIN_RANGE: f64 = 0.35;

/// The bend of each finger: 0 if it is straight, 1 if it is closed; `None` if it is not measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FingerBends([Option<f32>; Finger::COUNT]);

/// The angles at which the fingers of a hand are straight and closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendRanges([Option<BendRange>; Dof::COUNT]);

/// The angles of one joint, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BendRange {
    straight: f64,
    closed: f64,
}

impl FingerBends {
    /// Returns the bend of a finger, or `None` if it is not measured.
    pub fn get(&self, finger: Finger) -> Option<f32> {
        self.0[finger.index()]
    }

    /// Sets the bend of a finger.
    pub fn set(&mut self, finger: Finger, bend: Option<f32>) {
        self.0[finger.index()] = bend;
    }
}

impl BendRanges {
    /// Returns the ranges of motion of a healthy adult, for sensors other than gloves.
    pub fn human() -> Self {
        let mut ranges = Self([None; Dof::COUNT]);
        for &dof in Finger::FLEXIONS.as_flattened() {
            let (_, closed) = JointLimits::human().range(dof);
            ranges.0[dof.index()] = Some(BendRange {
                straight: 0.0,
                closed,
            });
        }
        ranges
    }

    /// Returns the ranges of a glove: its calibrated ranges, or else the ranges that its channels can measure, within the
    /// ranges of motion. Joints without a channel do not count.
    pub fn of_glove(map: &ChannelMap) -> Self {
        let human = Self::human();
        let mut ranges = Self([None; Dof::COUNT]);
        for row in map.rows() {
            let Some(own) = human.0[row.dof.index()] else {
                continue;
            };
            let within = |(low, high): (f64, f64)| {
                let ends = [low, high].map(|count| map.radians(row, count));
                let range = BendRange {
                    straight: ends[0].min(ends[1]).max(own.straight),
                    closed: ends[0].max(ends[1]).min(own.closed),
                };
                (range.closed - range.straight >= MIN_RANGE).then_some(range)
            };
            let calibrated = map.range(row.channel).and_then(within);
            let measured = || within((0.0, f64::from(map.full_scale())));
            ranges.0[row.dof.index()] = calibrated.or_else(measured);
        }
        ranges
    }

    /// Returns the bends of a hand: the mean over the known joints of each finger.
    pub fn bends(&self, angles: &JointAngles) -> FingerBends {
        FingerBends(Finger::FLEXIONS.map(|joints| {
            let (mut sum, mut count) = (0.0, 0_u8);
            for dof in joints {
                if let Some(range) = self.0[dof.index()].filter(|_| angles.is_known(dof)) {
                    let bend = (angles.get(dof) - range.straight) / (range.closed - range.straight);
                    sum += bend.clamp(0.0, 1.0);
                    count += 1;
                }
            }
            let mean = sum / f64::from(count);
            (count > 0 && mean.is_finite()).then_some(mean as f32)
        }))
    }

    /// Iterates over the joints of a finger that count, with their angles at a bend, in radians.
    pub fn angles_at(&self, finger: Finger, bend: f64) -> impl Iterator<Item = (Dof, f64)> + '_ {
        let joints = Finger::FLEXIONS[finger.index()].into_iter();
        joints.filter_map(move |dof| {
            let range = self.0[dof.index()]?;
            Some((dof, range.straight + bend * (range.closed - range.straight)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{AffineMap, ChannelRow};

    fn glove(closed_rad: f64) -> ChannelMap {
        let row = |dof| ChannelRow {
            label: String::new(),
            dof,
            channel: 0,
            calibration: AffineMap::from_counts(0.0, closed_rad / 1000.0, 0.0),
        };
        ChannelMap::new(
            vec![row(Dof::IndexMcpFlexion), row(Dof::IndexPipFlexion)],
            1000,
        )
    }

    fn index_bend(map: &ChannelMap, count: f64) -> Option<f32> {
        let mut angles = JointAngles::default();
        for row in map.rows() {
            angles.set(row.dof, map.radians(row, count));
        }
        // An angle without a sensor is assumed, and no sign of a bend.
        angles.set(Dof::IndexDipFlexion, 0.0);
        BendRanges::of_glove(map).bends(&angles).get(Finger::Index)
    }

    #[test]
    fn the_bend_is_the_fraction_of_the_range_of_the_glove() {
        for closed_rad in [0.8, 1.2, 1.5] {
            let map = glove(closed_rad);
            for (count, expected) in [(0.0, 0.0), (400.0, 0.4), (1000.0, 1.0)] {
                let bend = index_bend(&map, count).expect("a measured finger");
                assert!((bend - expected).abs() < 1e-6, "{closed_rad}: {bend}");
            }
        }
    }

    #[test]
    fn a_calibrated_range_is_closed_at_its_end() {
        let map = glove(1.5).with_ranges(vec![(0, (100.0, 700.0))]);
        assert_eq!(index_bend(&map, 700.0), Some(1.0));
        assert_eq!(index_bend(&map, 100.0), Some(0.0));
        let never_closed = glove(1.5).with_ranges(vec![(0, (100.0, 150.0))]);
        let bend = index_bend(&never_closed, 150.0).expect("a measured finger");
        assert!(bend < 0.2, "{bend}");
    }

    #[test]
    fn a_finger_without_a_sensor_has_no_bend() {
        let bends = BendRanges::of_glove(&glove(1.5)).bends(&JointAngles::default());
        assert_eq!(bends, FingerBends::default());
        assert_eq!(bends.get(Finger::Little), None);
    }
}

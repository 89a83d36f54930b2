//! The compensation of sensors that lag behind the movement of a joint: after a reversal they stand still until the joint has turned by
//! the width of their hysteresis.
//!
//! Such a sensor is a play operator of half-width r: its angle y stays within θ ± r of the joint θ, and only the joint pushes it. While
//! it is pushed in one direction, θ = y + r or θ = y − r, so the direction of the latest movement tells the joint from the sensor. The
//! inverse of the operator changes sides at once, by the whole width; here a side is taken up while the sensor moves by that width, so
//! that a sensor that trembles does not make a joint jump to and fro.

use super::{ChannelMap, JointAngles};
use crate::hand::Dof;

/// The movement after a reversal that may be noise, as a fraction of the width.
const NOISE: f64 = 1.0 / 16.0;

/// The compensation of all sensors of a glove with hysteresis.
#[derive(Clone, Debug, Default)]
pub(super) struct HysteresisCompensation {
    joints: Vec<SensedJoint>,
}

/// The compensation of the sensor of one joint, in radians.
#[derive(Clone, Debug)]
struct SensedJoint {
    dof: Dof,
    /// Half of the width of the hysteresis.
    reach: f64,
    /// The sensor, as far as its movement is not noise; `None` before the first angle.
    sensor: Option<f64>,
    /// The joint less the sensor, within ± `reach`.
    lead: f64,
}

impl HysteresisCompensation {
    /// Creates the compensation of the channels of a glove that have a hysteresis.
    pub(super) fn new(map: &ChannelMap) -> Self {
        let mut joints: Vec<SensedJoint> = Vec::new();
        for row in map.rows() {
            // The later of two rows takes precedence.
            joints.retain(|joint| joint.dof != row.dof);
            let counts = map.hysteresis(row.channel);
            if counts > 0.0 {
                joints.push(SensedJoint {
                    dof: row.dof,
                    reach: counts * row.calibration.gain.abs() / 2.0,
                    sensor: None,
                    lead: 0.0,
                });
            }
        }
        Self { joints }
    }

    /// Turns the angles of the sensors into the angles of the joints.
    pub(super) fn apply(&mut self, angles: &mut JointAngles) {
        for joint in &mut self.joints {
            if angles.is_known(joint.dof) {
                let sensor = angles.get(joint.dof);
                joint.observe(sensor);
                angles.set(joint.dof, sensor + joint.lead);
            }
        }
    }

    /// Forgets the angles of the sensors, but not the sides of their hysteresis: the next angles differ from the last ones by more than
    /// a movement.
    pub(super) fn reset(&mut self) {
        self.joints.iter_mut().for_each(|joint| joint.sensor = None);
    }
}

impl SensedJoint {
    fn observe(&mut self, sensor: f64) {
        let noise = 2.0 * self.reach * NOISE;
        let last = self.sensor.unwrap_or(sensor);
        let moved = last.clamp(sensor - noise, sensor + noise);
        self.sensor = Some(moved);
        self.lead = (self.lead + moved - last).clamp(-self.reach, self.reach);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{AffineMap, ChannelRow};

    const WIDTH: f64 = 0.06;

    fn compensation() -> HysteresisCompensation {
        let row = |dof, channel, gain| ChannelRow {
            label: String::new(),
            dof,
            channel,
            calibration: AffineMap { gain, offset: 0.0 },
        };
        let rows = vec![
            row(Dof::WristFlexion, 0, 0.01),
            row(Dof::ElbowFlexion, 1, -0.01),
        ];
        let map = ChannelMap::new(rows, 255).with_hystereses(vec![(1, 6.0)]);
        HysteresisCompensation::new(&map)
    }

    /// A sensor with play, and the compensation of what it shows.
    struct Sensor {
        shown: f64,
        compensation: HysteresisCompensation,
    }

    impl Sensor {
        fn new() -> Self {
            Self {
                shown: 0.0,
                compensation: compensation(),
            }
        }

        fn follow(&mut self, joint: f64) -> f64 {
            let reach = WIDTH / 2.0;
            self.shown = self.shown.clamp(joint - reach, joint + reach);
            self.compensate(self.shown)
        }

        fn compensate(&mut self, shown: f64) -> f64 {
            let mut angles = JointAngles::default();
            angles.set(Dof::ElbowFlexion, shown);
            self.compensation.apply(&mut angles);
            angles.get(Dof::ElbowFlexion)
        }
    }

    /// Returns `count` + 1 angles from `from` to `to`.
    fn line(from: f64, to: f64, count: u32) -> impl Iterator<Item = f64> {
        (0..=count).map(move |step| from + (to - from) * f64::from(step) / f64::from(count))
    }

    #[test]
    fn a_joint_is_found_from_either_side_of_the_play() {
        let mut sensor = Sensor::new();
        for (from, to) in [(0.0, 1.0), (1.0, 0.3), (0.3, 0.5)] {
            let angle = line(from, to, 100).map(|joint| sensor.follow(joint)).last();
            assert!((angle.unwrap() - to).abs() < 1e-9, "{angle:?} at {to}");
            let error = (sensor.shown - to).abs();
            assert!(
                (error - WIDTH / 2.0).abs() < 1e-9,
                "the sensor is off by {error}"
            );
        }
    }

    #[test]
    fn noise_moves_a_joint_by_no_more_than_itself() {
        let mut sensor = Sensor::new();
        line(0.0, 0.5, 100).for_each(|joint| {
            sensor.follow(joint);
        });
        let noise = WIDTH * NOISE;
        for step in 0..1000 {
            let shown = sensor.shown + if step % 2 == 0 { noise } else { -noise };
            let joint = sensor.compensate(shown);
            assert!((joint - 0.5).abs() < 3.0 * noise + 1e-9, "{joint}");
        }
    }

    #[test]
    fn a_tremor_of_the_width_stays_within_the_play() {
        let mut sensor = Sensor::new();
        for step in 0..1000 {
            let shown = if step % 2 == 0 { WIDTH } else { 0.0 };
            let joint = sensor.compensate(shown);
            assert!((joint - shown).abs() <= WIDTH / 2.0 + 1e-9, "{joint}");
        }
    }

    #[test]
    fn a_jump_of_the_calibration_is_no_movement() {
        let mut sensor = Sensor::new();
        line(0.0, 0.5, 100).for_each(|joint| {
            sensor.follow(joint);
        });
        sensor.compensation.reset();
        let after = sensor.compensate(sensor.shown - 0.2);
        assert!((after - 0.3).abs() < 1e-9, "{after}");
    }

    #[test]
    fn joints_without_hysteresis_and_unknown_joints_are_not_changed() {
        let mut compensation = compensation();
        for step in 0..10 {
            let mut angles = JointAngles::default();
            angles.set(Dof::WristFlexion, f64::from(step));
            compensation.apply(&mut angles);
            assert_eq!(angles.get(Dof::WristFlexion), f64::from(step));
            assert!(!angles.is_known(Dof::ElbowFlexion));
        }
    }
}

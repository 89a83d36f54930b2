//! Simulated people of different sizes in gloves of which the program knows only the starting file.
//!
//! The [`SimulatedWearer`] takes calibration poses as far as its own joints go, and its [`GloveSensors`] answer with gains,
//! offsets, curvature, cross-talk and noise of their own. Neither uses the angles and deviations that the calibration expects.

mod habits;
mod home_made;
mod sensor_errors;
mod sensors;

pub use home_made::HomeMadeGlove;
pub use sensor_errors::SensorErrors;
pub use sensors::{GloveFault, GloveSensors};

use self::habits::Habits;
use self::home_made::HomeMadeSensors;
use self::sensor_errors::SensorPlay;
use super::movement::minimum_jerk;
use super::typing_hand::TypingHand;
use crate::calibrate::CalibrationPose;
use crate::capture::{Channels, Reading, Sample};
use crate::estimate::ChannelMap;
use crate::hand::{Dof, JointAngles, Side};
use crate::kinematics::{ArmModel, BoneLengths};
use crate::time::Timestamp;

/// The time between two packets in microseconds: a line of 38 400 baud.
const PERIOD_US: u64 = 17_200;

/// The time of a movement from one pose to the next, in packets.
const MOVE_PACKETS: u32 = 46;

/// The time for which a stretch is held, in packets.
const STRETCH_PACKETS: u32 = 58;

/// The time for which a pose of a cycle is held, in packets: two seconds.
const CYCLE_PACKETS: u32 = 116;

/// The angle by which the elbow lifts a hand off the keys, in radians: 25°.
const LIFT: f64 = 0.44;

/// The probability of a spike in a count during a calibration: with 22 sensors, one packet in 23 has a spike.
const SPIKE: f64 = 0.002;

/// The range of hand lengths, in metres: from the 5th percentile of women to the 95th of men (Buryanov & Kotiuk 2010).
const HAND: (f64, f64) = (0.153, 0.199);

/// The ratio of forearm and hand (Drillis & Contini 1966), and its range between people.
const FOREARM: (f64, f64) = (1.29, 1.42);

/// The largest difference of a bone from its ratio to the hand.
const BONE: f64 = 0.05;

/// The largest error of a length that a person measures with a ruler, in metres.
const RULER: f64 = 0.003;

/// A person in a glove.
#[derive(Clone, Debug)]
pub struct SimulatedWearer {
    bones: BoneLengths,
    arm: ArmModel,
    habits: Habits,
    sensors: GloveSensors,
    /// The sensors during the calibration poses, if they differ from `sensors`.
    home_made: Option<HomeMadeSensors>,
    angles: JointAngles,
    movement: Option<(JointAngles, JointAngles, u32)>,
    pose: Option<CalibrationPose>,
    time: Timestamp,
    random: fastrand::Rng,
}

impl SimulatedWearer {
    /// Creates the person with this number, in a glove of the kind of `map`. Equal numbers give equal people.
    pub fn new(seed: u64, map: &ChannelMap, side: Side) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        let hand = between(&mut random, HAND);
        let forearm = hand * between(&mut random, FOREARM);
        let mut bones = BoneLengths::from_hand_and_forearm(hand, forearm)
            .expect("all people are within the range of lengths");
        for bone in bones.phalanges.iter_mut().flatten().chain(&mut bones.thumb) {
            *bone *= between(&mut random, (1.0 - BONE, 1.0 + BONE));
        }
        let habits = Habits::new(&mut random);
        Self {
            arm: ArmModel::anthropometric(side, &bones).expect("an arm of these bones"),
            bones,
            sensors: GloveSensors::new(map, &mut random),
            home_made: None,
            angles: habits.angles(CalibrationPose::Rest),
            habits,
            movement: None,
            pose: None,
            time: Timestamp(0),
            random,
        }
    }

    /// Returns the person with a fault of the glove.
    #[must_use]
    pub fn with_fault(mut self, fault: GloveFault) -> Self {
        self.sensors.add_fault(fault);
        self
    }

    /// Returns the person in a home-made glove while they take poses.
    #[must_use]
    pub fn in_home_made_glove(mut self, kind: HomeMadeGlove) -> Self {
        self.home_made = Some(HomeMadeSensors::new(kind, &mut self.random));
        self
    }

    /// Returns the readings of a person who flattens the hand, bends it half-way, makes a fist, opens it half-way and flattens it
    /// again, `count` times. Each posture is held for two seconds. The sensors have only these errors.
    pub fn cycles(&mut self, count: usize, errors: SensorErrors, map: &ChannelMap) -> Vec<Reading> {
        let mut play = SensorPlay::new(errors, map);
        let [flat, fist] = self.ends();
        let half = between_postures(&flat, &fist, 0.5);
        let poses = [half, fist, half, flat];
        let mut readings = Vec::new();
        let mut from = flat;
        for to in std::iter::once(flat).chain(poses.into_iter().cycle().take(4 * count)) {
            for packet in 1..=MOVE_PACKETS + CYCLE_PACKETS {
                let t = f64::from(minimum_jerk((packet as f32 / MOVE_PACKETS as f32).min(1.0)));
                let exact = self.sensors.exact(&between_postures(&from, &to, t));
                let time = self.advance();
                let full_scale = map.full_scale();
                let channels = play.read(&exact, full_scale, time, &mut self.random);
                readings.push(Reading::new(time, None, Sample::Channels(channels)));
            }
            from = to;
        }
        readings
    }

    /// Returns the postures at both ends of a cycle: the flat hand and the fist.
    pub fn ends(&self) -> [JointAngles; 2] {
        [CalibrationPose::Flat, CalibrationPose::Fist].map(|pose| self.habits.angles(pose))
    }

    /// Sets the drift: the fraction by which the finger sensors respond more strongly to a bend than in the cold glove.
    pub fn set_drift(&mut self, drift: f64) {
        self.sensors.set_drift(drift);
    }

    /// Returns the readings of a person who takes the hand off the keys, makes a fist, stretches the fingers and returns. Each
    /// posture is held for a second.
    pub fn stretch(&mut self) -> Vec<Reading> {
        let hand = TypingHand::without_glove(&self.arm);
        let typing = hand.angles(&hand.rest_values());
        let lifted = |fingers: &JointAngles| {
            let mut angles = typing;
            for (dof, radians) in fingers.known().filter(|(dof, _)| dof.finger().is_some()) {
                angles.set(dof, radians);
            }
            let elbow = angles.get(Dof::ElbowFlexion) + LIFT;
            angles.set(Dof::ElbowFlexion, elbow);
            angles
        };
        let [fist, flat] = [CalibrationPose::Fist, CalibrationPose::Flat]
            .map(|pose| lifted(&self.habits.angles(pose)));
        let mut readings = Vec::new();
        for (from, to) in [
            (typing, lifted(&typing)),
            (lifted(&typing), fist),
            (fist, flat),
            (flat, lifted(&typing)),
            (lifted(&typing), typing),
        ] {
            for packet in 1..=MOVE_PACKETS + STRETCH_PACKETS {
                let t = f64::from(minimum_jerk((packet as f32 / MOVE_PACKETS as f32).min(1.0)));
                readings.push(self.send(&between_postures(&from, &to, t)));
            }
        }
        readings
    }

    /// Returns the next reading of the glove at these angles.
    pub fn send(&mut self, angles: &JointAngles) -> Reading {
        let time = self.advance();
        Reading::new(time, None, Sample::Channels(self.read(angles)))
    }

    /// Returns the arm with the bones of the person.
    pub fn arm(&self) -> &ArmModel {
        &self.arm
    }

    /// Returns hand and forearm length as the person measures them, in metres.
    pub fn measured_lengths(&mut self) -> (f64, f64) {
        let mut measure = |length: f64| length + between(&mut self.random, (-RULER, RULER));
        (measure(self.bones.hand), measure(self.bones.forearm))
    }

    /// Returns the sensors of the glove.
    pub fn sensors(&self) -> &GloveSensors {
        &self.sensors
    }

    /// Starts a movement to a pose, unless the hand is in this pose or moves to it already.
    pub fn take(&mut self, pose: CalibrationPose) {
        if self.pose != Some(pose) {
            self.pose = Some(pose);
            self.movement = Some((self.angles, self.habits.angles(pose), 0));
        }
    }

    /// Returns the next packet of the glove, with noise and occasional spikes.
    pub fn next_packet(&mut self) -> (Timestamp, Channels) {
        if let Some((from, to, packet)) = &mut self.movement {
            *packet += 1;
            let t = f64::from(minimum_jerk(
                (*packet as f32 / MOVE_PACKETS as f32).min(1.0),
            ));
            self.angles = between_postures(from, to, t);
            if *packet >= MOVE_PACKETS {
                self.movement = None;
            }
        }
        let (time, random) = (self.advance(), &mut self.random);
        let channels = match &self.home_made {
            Some(sensors) => sensors.read(&self.angles, random),
            None => self.sensors.read_with_spikes(&self.angles, SPIKE, random),
        };
        (time, channels)
    }

    /// Returns a random posture: each sensor bends its joints to a fraction of their range, all fractions equally likely.
    pub fn random_posture(&mut self) -> JointAngles {
        let mut angles = JointAngles::default();
        for &dof in Dof::ALL {
            angles.set(dof, 0.0);
        }
        for dofs in self.sensors.joints() {
            let fraction = self.random.f64();
            for &dof in dofs {
                let (low, high) = self.habits.range(dof);
                angles.set(dof, low + fraction * (high - low));
            }
        }
        angles
    }

    /// Returns the counts of the glove at these angles, with noise.
    pub fn read(&mut self, angles: &JointAngles) -> Channels {
        self.sensors.read_with_spikes(angles, 0.0, &mut self.random)
    }

    /// Advances by one packet and returns its time.
    pub(super) fn advance(&mut self) -> Timestamp {
        self.time = Timestamp(self.time.0 + PERIOD_US);
        self.time
    }
}

/// Returns a uniformly distributed number.
pub(super) fn between(random: &mut fastrand::Rng, (low, high): (f64, f64)) -> f64 {
    low + (high - low) * random.f64()
}

/// Returns the posture at `t` between two postures, 0..=1.
fn between_postures(from: &JointAngles, to: &JointAngles, t: f64) -> JointAngles {
    let mut angles = JointAngles::default();
    for &dof in Dof::ALL {
        angles.set(dof, from.get(dof) + t * (to.get(dof) - from.get(dof)));
    }
    angles
}

//! The sensors of the lab: ideal, a camera, a glove.

use glam::DVec3;

use crate::capture::Sample;
use crate::estimate::{ChannelMap, JointAngles};
use crate::hand::{Dof, JointPositions};
use crate::kinematics::ArmModel;
use crate::names::named_enum;
use crate::people::{Draw, Participant};
use crate::sim::glove_sensor::GloveSensor;
use crate::sim::noise::Noise;
use crate::sim::sensor::JointSensor;

named_enum! {
    /// The sensor that measures the hands.
    pub enum SourceKind ("source") {
        /// The joint angles, exactly, 175 times a second.
        Ideal = "ideal",
        /// The positions of all joints, 60 pictures a second, with noise and lost pictures, and without latency.
        Camera = "camera",
        /// The glove of the program, 175 packets a second, with gain errors, backlash, lag and counts of 8 bits.
        Glove = "glove",
        /// The same glove, its backlash measured to within a fifth and compensated.
        MeasuredGlove = "measured-glove",
    }
}

impl SourceKind {
    /// Returns the readings of a hand a second.
    pub fn rate_hz(self) -> f64 {
        match self {
            Self::Camera => 60.0,
            _ => 175.0,
        }
    }

    /// Returns `true` for a glove.
    pub fn is_glove(self) -> bool {
        matches!(self, Self::Glove | Self::MeasuredGlove)
    }

    /// Returns the channels of the pipeline of a person who wears the glove of `map`: with the backlash that was measured, if it was.
    pub fn channel_map(self, map: ChannelMap, person: &Participant) -> ChannelMap {
        if self != Self::MeasuredGlove {
            return map;
        }
        let mut draw = Draw::new(person.seed, 0x4e57);
        let mut hystereses: Vec<(usize, f64)> = Vec::new();
        for row in map.rows() {
            if !hystereses
                .iter()
                .any(|(channel, _)| *channel == row.channel)
            {
                let measured = backlash(person, row.dof) * draw.between(1.0 - OFF, 1.0 + OFF);
                hystereses.push((row.channel, measured / row.calibration.gain.abs()));
            }
        }
        map.with_hystereses(hystereses)
    }

    /// Returns one sentence about the errors.
    pub fn description(self) -> &'static str {
        match self {
            Self::Ideal => "joint angles without noise, 175 Hz",
            Self::Camera => {
                "joint positions, 60 Hz; noise 1 mm across and 3 mm along the line of sight (?), 1 % of the pictures lost"
            }
            Self::MeasuredGlove => "as `glove`, with the backlash measured to within a fifth (?)",
            Self::Glove => {
                "the glove that comes with the program, 175 Hz, 8 bits; gains off by up to 10 %, backlash 2 to 5° in the fingers and a tenth of it in the arm, lag 20 ms (?)"
            }
        }
    }
}

/// Noise of a camera across and along the line of sight, in metres: a depth camera at half a metre ?.
const ACROSS: f64 = 0.001;
const ALONG: f64 = 0.003;
/// The part of the noise that stays from one picture to the next ?.
const KEPT: f64 = 0.5;
/// The part of the pictures without a hand ?.
const LOST: f64 = 0.01;
/// The time constant of a bend sensor, in seconds ?.
const LAG: f64 = 0.02;

/// The largest error of a measured backlash, as a fraction ?.
const OFF: f64 = 0.2;

/// Returns the backlash of the sensor of an angle, in radians.
fn backlash(person: &Participant, dof: Dof) -> f64 {
    let part = if dof.finger().is_some() { 1.0 } else { 0.1 };
    person.glove_backlash_deg.to_radians() * part
}

/// The sensors of one hand.
#[derive(Clone)]
pub struct SourceModel {
    kind: SourceKind,
    draw: Draw,
    /// The noise of each joint in the last picture.
    noise: Vec<DVec3>,
    glove: Option<GloveErrors>,
}

/// The errors of a glove that the pipeline does not know.
#[derive(Clone)]
struct GloveErrors {
    sensor: GloveSensor,
    /// Each measured angle with its gain, its backlash, and the angle that the sensor shows.
    angles: Vec<(Dof, f64, f64, f64)>,
    is_started: bool,
}

impl SourceModel {
    /// Creates the sensors of a hand of a person. A glove needs its channels.
    pub(super) fn new(
        kind: SourceKind,
        person: &Participant,
        map: Option<&ChannelMap>,
        seed: u64,
    ) -> Self {
        let draw = Draw::new(seed, 0x5e45);
        let glove = map.filter(|_| kind.is_glove());
        let glove = glove.map(|channel_map| {
            let mut angles: Vec<(Dof, f64, f64, f64)> = Vec::new();
            // The errors belong to the person's glove and are the same in every run.
            let mut own = Draw::new(person.seed, 0x610e);
            for row in channel_map.rows() {
                if angles.iter().any(|(dof, ..)| *dof == row.dof) {
                    continue;
                }
                let error = person.glove_gain_error;
                let gain = 1.0 + own.between(-error, error);
                angles.push((row.dof, gain, backlash(person, row.dof), 0.0));
            }
            // Each angle has a backlash of its own here.
            let exact = channel_map.clone().with_hystereses(Vec::new());
            GloveErrors {
                sensor: GloveSensor::new(&exact, Noise::new(0.0, 0)),
                angles,
                is_started: false,
            }
        });
        Self {
            kind,
            draw,
            noise: Vec::new(),
            glove,
        }
    }

    /// Starts another run, with the same errors of the glove.
    pub(super) fn restart(&mut self, seed: u64) {
        self.draw = Draw::new(seed, 0x5e45);
        self.noise.clear();
        if let Some(glove) = &mut self.glove {
            glove.is_started = false;
        }
    }

    /// Returns what the sensors show of these angles on average, for a person who knows them.
    pub(super) fn expected(&mut self, arm: &ArmModel, angles: &JointAngles) -> Sample {
        match (&mut self.glove, self.kind) {
            (Some(glove), _) => glove.expected(angles),
            (None, SourceKind::Camera) => JointSensor::Positions.measure(arm, angles),
            _ => JointSensor::Angles.measure(arm, angles),
        }
    }

    /// Writes what the sensors show after a time step into `sample`, which is large, so that it is not moved; returns `false` for a
    /// lost picture.
    pub(super) fn measure(
        &mut self,
        arm: &ArmModel,
        angles: &JointAngles,
        seconds: f64,
        sample: &mut Sample,
    ) -> bool {
        match (&mut self.glove, self.kind) {
            (Some(glove), _) => glove.measure(angles, seconds, sample),
            (None, SourceKind::Camera) => {
                if self.draw.happens(LOST) {
                    return false;
                }
                *sample = JointSensor::Positions.measure(arm, angles);
                if let Sample::Joints { positions } = sample {
                    self.add_noise(positions);
                }
            }
            (None, _) => match sample {
                Sample::Angles { angles: shown } => *shown = *angles,
                other => *other = Sample::Angles { angles: *angles },
            },
        }
        true
    }

    fn add_noise(&mut self, positions: &mut JointPositions) {
        let fresh = (1.0 - KEPT * KEPT).sqrt();
        for (index, (joint, position)) in positions.clone().known().enumerate() {
            if self.noise.len() <= index {
                self.noise.push(DVec3::ZERO);
            }
            let mut normal = || self.draw.normal();
            // The camera looks along the Z of the world.
            let new = DVec3::new(normal() * ACROSS, normal() * ACROSS, normal() * ALONG);
            let noise = &mut self.noise[index];
            *noise = *noise * KEPT + new * fresh;
            positions.set(joint, position + *noise);
        }
    }
}

impl GloveErrors {
    fn expected(&mut self, angles: &JointAngles) -> Sample {
        let mut shown = *angles;
        for &(dof, gain, ..) in &self.angles {
            shown.set(dof, angles.get(dof) * gain);
        }
        self.sensor.measure(&shown)
    }

    fn measure(&mut self, angles: &JointAngles, seconds: f64, sample: &mut Sample) {
        let mut shown = *angles;
        for (dof, gain, backlash, last) in &mut self.angles {
            let goal = angles.get(*dof) * *gain;
            // A play operator: the sensor follows at a distance of half its backlash.
            let half = *backlash / 2.0;
            let pulled = last.clamp(goal - half, goal + half);
            if self.is_started {
                *last += (pulled - *last) * (seconds / LAG).min(1.0)
            } else {
                *last = goal
            }
            shown.set(*dof, *last);
        }
        self.is_started = true;
        self.sensor.measure_into(&shown, sample);
    }
}

//! The sensors of a simulated glove.

use super::between;
use crate::capture::{Channels, MAX_CHANNELS};
use crate::estimate::{ChannelMap, JointLimits, divider_voltage};
use crate::hand::{Dof, JointAngles};
use crate::sim::noise::gaussian;

/// The gain of a sensor in relation to the starting glove.
const GAIN: (f64, f64) = (0.75, 1.3);
/// The largest shift of a sensor against the starting glove, as a fraction of the full scale.
const SHIFT: f64 = 0.06;
/// The fixed resistor in units of the straight sensor: 10 kΩ to 47 kΩ beside the common sensor of 10 kΩ.
const FIXED: (f64, f64) = (1.0, 4.7);
/// The resistance of the bent sensor in units of the straight one, from data sheets of bend sensors.
const BENT: (f64, f64) = (1.5, 2.5);
/// The difference of the sensors of one glove in both.
const SPREAD: (f64, f64) = (0.9, 1.1);
/// The part of a channel that another one adds, as a fraction of its range: a loose sleeve, or a common wire.
const CROSS_TALK: (f64, f64) = (0.0, 0.03);
/// The standard deviation of the noise, as a fraction of the full scale: half a count of 255.
const NOISE: f64 = 0.002;
/// The counts at both ends that a working sensor does not use, as a fraction of the full scale.
const MARGIN: f64 = 0.03;

/// A fault of a glove.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GloveFault {
    /// The counts of a channel never change.
    Dead(usize),
    /// The plugs of two channels are exchanged.
    Swapped(usize, usize),
    /// The wires of a sensor are exchanged, so that its counts fall.
    Inverted(usize),
    /// The first channel follows the second one by a fraction of its range.
    CrossTalk(usize, usize, f64),
}

/// The sensors of one glove: the counts for the angles of joints.
#[derive(Clone, Debug)]
pub struct GloveSensors {
    full_scale: u16,
    sensors: Vec<Sensor>,
    faults: Vec<GloveFault>,
    /// The part by which all sensors have become more sensitive.
    drift: f64,
}

/// A bend sensor in a voltage divider.
#[derive(Clone, Debug)]
struct Sensor {
    channel: usize,
    /// The joints that it spans.
    dofs: Vec<Dof>,
    /// The sums of their angles at which the resistance is lowest and highest, in radians.
    straight: f64,
    bent: f64,
    /// The counts of the straight and the bent sensor.
    counts: (f64, f64),
    /// Resistances in units of the straight sensor.
    fixed_resistance: f64,
    bent_resistance: f64,
    /// The index of the sensor that leaks into this one, and by how much.
    leak: (usize, f64),
}

impl GloveSensors {
    /// Draws a glove of the kind of `map`: the same channels for the same joints.
    pub(super) fn new(map: &ChannelMap, random: &mut fastrand::Rng) -> Self {
        let channels = map.angle_channels();
        let divider = (between(random, FIXED), between(random, BENT));
        let count = channels.len();
        let sensors = channels.iter().enumerate().map(|(index, &channel)| {
            // A single sensor leaks into itself, which makes it a little more sensitive.
            let neighbor = if index + 1 < count {
                index + 1
            } else {
                index.saturating_sub(1)
            };
            Sensor {
                leak: (neighbor, between(random, CROSS_TALK)),
                ..Sensor::new(map, channel, divider, random)
            }
        });
        Self {
            full_scale: map.full_scale(),
            sensors: sensors.collect(),
            faults: Vec::new(),
            drift: 0.0,
        }
    }

    /// Adds a fault.
    pub(super) fn add_fault(&mut self, fault: GloveFault) {
        self.faults.push(fault);
    }

    /// Sets the part by which the finger sensors answer a bend more strongly than in a cold glove.
    pub(super) fn set_drift(&mut self, drift: f64) {
        self.drift = drift;
    }

    /// Returns the joints of each sensor.
    pub(super) fn joints(&self) -> impl Iterator<Item = &[Dof]> {
        self.sensors.iter().map(|sensor| sensor.dofs.as_slice())
    }

    /// Returns the counts at these angles, with noise and with spikes at this probability.
    pub(super) fn read_with_spikes(
        &self,
        angles: &JointAngles,
        spikes: f64,
        random: &mut fastrand::Rng,
    ) -> Channels {
        let full_scale = f64::from(self.full_scale);
        let mut counts = self.exact(angles);
        for count in &mut counts {
            *count += NOISE * full_scale * gaussian(random);
            if random.f64() < spikes {
                *count = full_scale * random.f64();
            }
        }
        let counts = counts
            .iter()
            .map(|count| count.round().clamp(1.0, full_scale - 1.0) as u16);
        Channels {
            full_scale: self.full_scale,
            counts: counts.collect(),
            unsent: Default::default(),
        }
    }

    /// Returns the counts of all channels at these angles, without noise.
    pub fn exact(&self, angles: &JointAngles) -> [f64; MAX_CHANNELS] {
        let fractions: Vec<f64> = self
            .sensors
            .iter()
            .map(|sensor| sensor.fraction(angles))
            .collect();
        let mut counts = [f64::from(self.full_scale) / 2.0; MAX_CHANNELS];
        for sensor in &self.sensors {
            let (source, leak) = sensor.leak;
            let fraction = sensor.fraction(angles) + leak * fractions[source];
            let count = sensor.count(fraction);
            let bend = count - sensor.count(sensor.fraction_of_straight_finger());
            let is_of_finger = sensor.dofs.iter().all(|dof| dof.finger().is_some());
            let drift = if is_of_finger { self.drift * bend } else { 0.0 };
            counts[sensor.channel] = count + drift;
        }
        for fault in &self.faults {
            self.apply(*fault, &fractions, &mut counts);
        }
        counts
    }

    fn apply(&self, fault: GloveFault, fractions: &[f64], counts: &mut [f64; MAX_CHANNELS]) {
        let index_of = |channel: usize| {
            let mut sensors = self.sensors.iter();
            sensors.position(|sensor| sensor.channel == channel)
        };
        match fault {
            GloveFault::Dead(channel) => counts[channel] = f64::from(self.full_scale) / 3.0,
            GloveFault::Swapped(first, second) => counts.swap(first, second),
            GloveFault::Inverted(channel) => {
                counts[channel] = f64::from(self.full_scale) - counts[channel]
            }
            GloveFault::CrossTalk(channel, source, part) => {
                if let (Some(own), Some(source)) = (index_of(channel), index_of(source)) {
                    let (low, high) = self.sensors[own].counts;
                    counts[channel] += part * (fractions[source] - 0.5) * (high - low);
                }
            }
        }
    }
}

impl Sensor {
    fn new(
        map: &ChannelMap,
        channel: usize,
        (fixed, bent): (f64, f64),
        random: &mut fastrand::Rng,
    ) -> Self {
        let limits = JointLimits::human();
        let full_scale = f64::from(map.full_scale());
        let (mut low, mut high, mut gain) = (0.0, 0.0, 0.0);
        let mut dofs = Vec::new();
        let rows = map.rows().iter();
        // The second bone of the forearm turns with the first.
        let rows = rows.filter(|row| row.channel == channel && row.dof != Dof::ForearmSecondBone);
        for row in rows {
            let range = limits.range(row.dof);
            low += range.0;
            high += range.1;
            gain += row.calibration.gain;
            dofs.push(row.dof);
        }
        let first = map.rows().iter().find(|row| row.channel == channel);
        let zero = first.map_or(0.0, |row| row.calibration.apply_inverse(0.0));
        let margin = MARGIN * full_scale;
        let room = full_scale - 2.0 * margin;
        let span = ((high - low) / gain.abs() * between(random, GAIN)).min(room);
        let start = if gain > 0.0 { low } else { high };
        let shift = between(random, (-SHIFT, SHIFT)) * full_scale;
        // A span of all the room leaves no choice, but for rounding.
        let highest = (margin + room - span).max(margin);
        let bottom = (zero + start / gain + shift).clamp(margin, highest);
        Self {
            channel,
            dofs,
            straight: start,
            bent: low + high - start,
            counts: (bottom, bottom + span),
            fixed_resistance: fixed * between(random, SPREAD),
            bent_resistance: 1.0 + (bent - 1.0) * between(random, SPREAD),
            leak: (0, 0.0),
        }
    }

    /// Returns the bend: 0 for the straight, 1 for the bent sensor.
    fn fraction(&self, angles: &JointAngles) -> f64 {
        let angle: f64 = self.dofs.iter().map(|&dof| angles.get(dof)).sum();
        (angle - self.straight) / (self.bent - self.straight)
    }

    /// Returns the bend at which all of its joints are at 0.
    fn fraction_of_straight_finger(&self) -> f64 {
        self.fraction(&JointAngles::default())
    }

    fn count(&self, fraction: f64) -> f64 {
        let volt = |bend: f64| {
            let resistance = 1.0 + (self.bent_resistance - 1.0) * bend;
            divider_voltage(self.fixed_resistance, resistance, 1.0)
        };
        let (low, high) = (volt(0.0), volt(1.0));
        let part = (volt(fraction) - low) / (high - low);
        self.counts.0 + part * (self.counts.1 - self.counts.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;
    use crate::layout::Glove;

    #[test]
    fn a_glove_with_one_sensor_has_counts() {
        let text = "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, rows: [\n(label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 2.55, offset_rad: 0),\n])";
        let glove = Glove::parse(&Document::new("g.ron", text)).expect("a glove");
        let sensors = GloveSensors::new(&glove.map, &mut fastrand::Rng::with_seed(1));
        let count = |radians: f64| {
            let mut angles = JointAngles::default();
            angles.set(Dof::ElbowFlexion, radians);
            sensors.exact(&angles)[1]
        };
        assert!(count(0.5) < count(1.5), "{} {}", count(0.5), count(1.5));
    }
}

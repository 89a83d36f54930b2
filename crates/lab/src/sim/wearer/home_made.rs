//! Home-made gloves: a LucidGloves build with one bend sensor for each finger, as people make them.

use super::between;
use crate::capture::Channels;
use crate::capture::protocol::lucidgloves::{FULL_SCALE, Fields};
use crate::hand::{Dof, Finger, JointAngles};
use crate::names::named_enum;
use crate::sim::noise::gaussian;

named_enum! {
    /// A home-made glove. All have a sensor for the curl of each finger, without a calibration in the firmware.
    pub enum HomeMadeGlove ("home-made glove") {
        /// Every sensor works.
        Curls = "curls",
        /// The wires of the sensors of index and little finger are exchanged, so that their counts fall.
        Inverted = "inverted",
        /// The sensors use a tenth of the converter's range.
        Narrow = "narrow",
        /// The sensor of the ring finger has no contact: the glove sends the same count in every pose.
        Dead = "dead",
        /// The plugs of the sensors of middle and ring finger are exchanged.
        Swapped = "swapped",
        /// Long wires without a filter: noise of 1 % of the range, and spikes.
        Noisy = "noisy",
    }
}

/// The counts of a straight finger.
const STRAIGHT: (f64, f64) = (550.0, 900.0);
/// The counts that a closed finger adds.
const SPAN: (f64, f64) = (1_800.0, 2_400.0);
/// The counts that a closed finger adds in a divider with the wrong resistor.
const NARROW_SPAN: (f64, f64) = (350.0, 450.0);
/// The part of its span by which a half-bent sensor is above a straight line.
const BOW: (f64, f64) = (-0.02, 0.03);
/// The standard deviation of the noise, in counts.
const NOISE: f64 = 8.0;
const STRONG_NOISE: f64 = 40.0;
/// The probability of a spike, with long wires.
const SPIKE: f64 = 0.004;
/// The sums of the flexions of a closed finger and of a closed thumb, in radians.
const CLOSED_FINGER: f64 = 4.5;
const CLOSED_THUMB: f64 = 2.8;

/// The sensors of one home-made glove.
#[derive(Clone, Debug)]
pub(super) struct HomeMadeSensors {
    kind: HomeMadeGlove,
    sensors: [CurlSensor; Finger::COUNT],
}

/// The sensor of a finger.
#[derive(Clone, Copy, Debug)]
struct CurlSensor {
    straight: f64,
    span: f64,
    bow: f64,
}

impl HomeMadeSensors {
    /// Draws a glove.
    pub(super) fn new(kind: HomeMadeGlove, random: &mut fastrand::Rng) -> Self {
        let span = match kind {
            HomeMadeGlove::Narrow => NARROW_SPAN,
            _ => SPAN,
        };
        let mut draw = |finger: Finger| {
            let (straight, span) = (between(random, STRAIGHT), between(random, span));
            let is_inverted =
                kind == HomeMadeGlove::Inverted && matches!(finger, Finger::Index | Finger::Little);
            let (straight, span) = if is_inverted {
                (straight + span, -span)
            } else {
                (straight, span)
            };
            let bow = between(random, BOW);
            CurlSensor {
                straight,
                span,
                bow,
            }
        };
        Self {
            kind,
            sensors: std::array::from_fn(|index| draw(Finger::ALL[index])),
        }
    }

    /// Returns the reading at these angles: through the line of text that such a glove sends.
    pub(super) fn read(&self, angles: &JointAngles, random: &mut fastrand::Rng) -> Channels {
        let fields = Fields {
            curls: std::array::from_fn(|index| {
                Some(self.count(self.finger_at(Finger::ALL[index]), angles, random))
            }),
            ..Fields::default()
        };
        let line = fields.encode();
        let parsed = Fields::parse(line.as_bytes()).expect("a line with all fingers");
        parsed.channels(FULL_SCALE)
    }

    /// Returns the finger whose sensor is plugged in where the sensor of `finger` belongs.
    fn finger_at(&self, finger: Finger) -> Finger {
        match finger {
            Finger::Middle if self.kind == HomeMadeGlove::Swapped => Finger::Ring,
            Finger::Ring if self.kind == HomeMadeGlove::Swapped => Finger::Middle,
            other => other,
        }
    }

    fn count(&self, finger: Finger, angles: &JointAngles, random: &mut fastrand::Rng) -> i64 {
        if self.kind == HomeMadeGlove::Dead && finger == Finger::Ring {
            return i64::from(FULL_SCALE / 2);
        }
        let is_noisy = self.kind == HomeMadeGlove::Noisy;
        if is_noisy && random.f64() < SPIKE {
            return random.i64(0..=i64::from(FULL_SCALE));
        }
        let noise = if is_noisy { STRONG_NOISE } else { NOISE };
        let exact = self.sensors[finger.index()].count(curl(finger, angles));
        let count = (exact + noise * gaussian(random)).round() as i64;
        count.clamp(1, i64::from(FULL_SCALE) - 1)
    }
}

impl CurlSensor {
    fn count(&self, curl: f64) -> f64 {
        self.straight + self.span * (curl + 4.0 * self.bow * curl * (1.0 - curl))
    }
}

/// Returns the curl of a finger: 0 straight, 1 closed.
fn curl(finger: Finger, angles: &JointAngles) -> f64 {
    let flexions = Dof::ALL
        .iter()
        .filter(|dof| dof.finger() == Some(finger) && !dof.index().is_multiple_of(4));
    let closed = match finger {
        Finger::Thumb => CLOSED_THUMB,
        _ => CLOSED_FINGER,
    };
    flexions.map(|&dof| angles.get(dof)).sum::<f64>() / closed
}

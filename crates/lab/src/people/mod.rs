//! Simulated people: populations that are drawn from published ranges, and persons from files.
//!
//! A [`Participant`] knows nothing of the pipeline. The pipeline assumes [`assumed`](Participant::assumed) lengths of bones; the
//! [`own`](Participant::own) ones differ by up to 5 %. Ranges marked `?` are quoted from memory and not checked against the
//! literature.

mod draw;
mod population;
mod tier;

use parry3d::math::Vec2;
use serde::{Deserialize, Serialize};

pub use draw::Draw;
pub(crate) use draw::mix;
pub use population::{People, population};
pub use tier::Tier;

use crate::hand::{Finger, FingerSet};
use crate::kinematics::BoneLengths;

/// One simulated person. Lengths are in millimetres, except the lengths of bones, which are in metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Participant {
    /// The index in its population, from 0.
    pub number: u32,
    /// The seed of all random values of this person.
    pub seed: u64,
    /// The lengths that the pipeline assumes, in metres.
    pub assumed: BoneLengths,
    /// The lengths of this person, in metres.
    pub own: BoneLengths,
    /// The fingers of each hand that press, by name; empty if the layout decides.
    pub fingers: Vec<String>,
    /// `true` if one hand is used where a layout has boards for two.
    pub one_hand: bool,
    /// The pace that the person intends, in words per minute: an input, not a result.
    pub pace_wpm: f64,
    /// The coefficient of variation of the log-normal times between keystrokes.
    pub interval_cv: f64,
    /// The intercept a of Fitts's law for the shortest time of a movement, in milliseconds.
    pub fitts_a_ms: f64,
    /// The slope b of Fitts's law for the shortest time of a movement, in milliseconds per bit.
    pub fitts_b_ms: f64,
    /// The time from above a key to the lowest point, in milliseconds.
    pub press_ms: f64,
    /// The time at the lowest point, in milliseconds.
    pub dwell_ms: f64,
    /// The intended depth beyond the travel of a target.
    pub depth: f64,
    /// The standard deviation of the depth.
    pub depth_scatter: f64,
    /// The standard deviation of end points along the X and Y of a target, for any size of the target.
    pub scatter: [f64; 2],
    /// The fractions of the squared size of a target, along X and Y, that are added to the variance (dual Gaussian).
    pub scatter_parts: [f64; 2],
    /// The stretch of the scatter along the movement: 0 for none.
    pub elongation: f64,
    /// The constant offset of each finger, thumb first.
    pub offsets: [[f64; 2]; Finger::COUNT],
    /// The step of the random walk of the hand at each keystroke.
    pub drift: f64,
    /// The fraction of the drift that remains at each keystroke: below 1 if the person sees the hand.
    pub drift_kept: f64,
    /// The amplitude of the tremor at the fingertips.
    pub tremor: f64,
    /// The frequency of the tremor, in Hz.
    pub tremor_hz: f64,
    /// The amplitude of the slow sway of an unsupported arm, below 2 Hz.
    pub sway: f64,
    /// The longest slip sideways while a key is down.
    pub slip: f64,
    /// The factor of the published fractions by which neighbors follow a pressing finger, 0..=1.
    pub enslaving: f64,
    /// The probability that a tap is left out or too shallow.
    pub missed: f64,
    /// The probability of a further tap within 1.5 keys of an intended one.
    pub spurious: f64,
    /// The fraction of the difference between the own hand and the hand that the pipeline shows to which the person has adapted,
    /// 0..=1.
    pub adaptation: f64,
    /// The error of each gain of a glove, 1 for none: drawn again for each channel.
    pub glove_gain_error: f64,
    /// The backlash of the bend sensors of a glove, in degrees.
    pub glove_backlash_deg: f64,
    /// The probability that an error in the text is corrected: 0 for a person who does not look at it.
    #[serde(default)]
    pub corrects: f64,
    /// The time from an error in the text until the person stops for it, in milliseconds.
    #[serde(default)]
    pub notice_ms: f64,
}

impl Participant {
    /// Returns the fingers that press; empty if the layout decides.
    pub fn finger_set(&self) -> FingerSet {
        let fingers = self.fingers.iter().filter_map(|name| name.parse().ok());
        fingers.fold(FingerSet::NONE, FingerSet::with)
    }

    /// Returns the standard deviations of end points at a target of a size in metres, in metres.
    pub fn deviation_at(&self, size: Vec2) -> Vec2 {
        let at = |axis: usize, extent: f32| {
            let own = (self.scatter[axis] * 1e-3).powi(2);
            let of_size = self.scatter_parts[axis] * f64::from(extent).powi(2);
            (own + of_size).sqrt() as f32
        };
        Vec2::new(at(0, size.x), at(1, size.y))
    }

    /// Returns the median time between two keystrokes at the intended pace, in seconds: five keystrokes are a word.
    pub fn interval(&self) -> f64 {
        12.0 / self.pace_wpm
    }

    /// Returns the shortest time of a movement over `distance` to a target of a `width` (metres), in seconds: Fitts's law in the
    /// form of MacKenzie.
    pub fn movement_time(&self, distance: f64, width: f64) -> f64 {
        let bits = (distance / width.max(1e-3) + 1.0).log2();
        (self.fitts_a_ms + self.fitts_b_ms * bits) * 1e-3
    }

    /// Returns the length of the hand in millimetres.
    pub fn hand_mm(&self) -> f64 {
        self.own.hand * 1e3
    }
}

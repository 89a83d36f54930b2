//! The touch model of a person: where taps land that mean a key.
//!
//! A tap that means key `k` is normally distributed around `center + offset of the person + offset of k + drift of the hand` with the
//! covariance of `k`, and correlated with the tap before: its mean is displaced by a fraction of that tap's scatter (a first-order
//! autoregressive process). Offsets, covariances and correlations are learned from committed words. Each is a mean of what was seen, in
//! which an old tap counts less and less, and of what is believed before: a key starts from the person, the person from the prior
//! (a normal-inverse-Wishart prior with forgetting). The drift of a hand is a random walk, tracked with a Kalman filter that the decoder
//! keeps for each hypothesis; what it ends with is kept here.

mod errors;
mod hands;

use serde::{Deserialize, Serialize};

use crate::keyboard::{Keyboard, Millimetres};

pub use errors::{ErrorCounts, ErrorSums};
pub use hands::{Correlations, Hands, PairSums};

/// A symmetric 2 × 2 matrix: xx, yy, xy.
pub type Covariance = [f32; 3];

/// The smallest variance in mm², so that a person who always hits the same spot stays possible elsewhere.
const MIN_VARIANCE: f32 = 0.25;

/// The assumptions about a person before the first tap.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Prior {
    /// The offset of taps from the centers of keys.
    pub offset: Millimetres,
    /// The covariance of taps.
    pub covariance: Covariance,
    /// The weight of the prior's offset, in taps.
    pub offset_taps: f32,
    /// The weight of the prior's covariance, in taps.
    pub covariance_taps: f32,
    /// The weight of the person's own offset against the offset of a key, in taps of the key.
    pub key_taps: f32,
    /// The share of a tap that is left after one more tap of the person.
    pub memory: f32,
    /// The standard deviation of the first offset of a hand in mm.
    pub first_drift: f32,
    /// The standard deviation of the drift of a hand with each tap in mm.
    pub drift: f32,
    /// The correlation between the scatter of two successive taps of different hands, 0 to 1.
    pub other_hand: f32,
    /// The correlation between the scatter of two successive taps of one hand, 0 to 1.
    pub same_hand: f32,
    /// The weight of both correlations, in pairs of taps.
    pub pairs: f32,
}

impl Default for Prior {
    /// A person in the air before a keyboard with keys of 19 mm.
    fn default() -> Self {
        Self {
            offset: [0.0; 2],
            covariance: [25.0, 25.0, 0.0],
            offset_taps: 40.0,
            covariance_taps: 30.0,
            key_taps: 12.0,
            memory: 0.998,
            first_drift: 4.0,
            drift: 0.25,
            other_hand: 0.1,
            same_hand: 0.2,
            pairs: 50.0,
        }
    }
}

impl Prior {
    /// Returns the prior with values that can be used: finite, positive where they have to be.
    fn sane(mut self) -> Self {
        let default = Self::default();
        let or = |value: f32, low: f32, high: f32, usual: f32| {
            if value.is_finite() {
                value.clamp(low, high)
            } else {
                usual
            }
        };
        for axis in 0..2 {
            self.offset[axis] = or(self.offset[axis], -1e3, 1e3, 0.0);
            self.covariance[axis] = or(self.covariance[axis], MIN_VARIANCE, 1e6, 25.0);
        }
        self.covariance[2] = or(self.covariance[2], -1e6, 1e6, 0.0);
        self.covariance = positive(self.covariance);
        self.offset_taps = or(self.offset_taps, 0.1, 1e6, default.offset_taps);
        self.covariance_taps = or(self.covariance_taps, 1.0, 1e6, default.covariance_taps);
        self.key_taps = or(self.key_taps, 1.0, 1e6, default.key_taps);
        self.memory = or(self.memory, 0.5, 1.0, default.memory);
        self.first_drift = or(self.first_drift, 0.0, 1e3, default.first_drift);
        self.drift = or(self.drift, 0.0, 1e3, default.drift);
        self.other_hand = or(self.other_hand, 0.0, 1.0, default.other_hand);
        self.same_hand = or(self.same_hand, 0.0, 1.0, default.same_hand);
        self.pairs = or(self.pairs, 1.0, 1e6, default.pairs);
        self
    }
}

/// Makes a matrix positive definite: variances from the smallest one up, correlation within ±0.9.
fn positive(mut matrix: Covariance) -> Covariance {
    matrix[0] = matrix[0].max(MIN_VARIANCE);
    matrix[1] = matrix[1].max(MIN_VARIANCE);
    let limit = 0.9 * (matrix[0] * matrix[1]).sqrt();
    matrix[2] = matrix[2].clamp(-limit, limit);
    matrix
}

/// Weighted sums of the residuals of taps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Sums {
    /// The number of taps, older ones counted less.
    pub taps: f32,
    /// The sum of the residuals.
    pub residuals: Millimetres,
    /// The sum of the squares xx, yy, xy of the residuals.
    pub squares: Covariance,
}

impl Sums {
    fn add(&mut self, residual: Millimetres) {
        self.taps += 1.0;
        let [x, y] = residual;
        for (sum, value) in self.residuals.iter_mut().zip(residual) {
            *sum += value;
        }
        for (sum, value) in self.squares.iter_mut().zip([x * x, y * y, x * y]) {
            *sum += value;
        }
    }

    fn forget(&mut self, memory: f32) {
        self.taps *= memory;
        self.residuals = self.residuals.map(|sum| sum * memory);
        self.squares = self.squares.map(|sum| sum * memory);
    }

    fn is_finite(&self) -> bool {
        let numbers = [self.taps, self.residuals[0], self.residuals[1]];
        numbers
            .iter()
            .chain(&self.squares)
            .all(|number| number.is_finite())
            && self.taps >= 0.0
    }

    /// Returns the mean, pulled to another one with a weight in taps.
    fn mean(&self, other: Millimetres, weight: f32) -> Millimetres {
        std::array::from_fn(|axis| {
            (self.residuals[axis] + other[axis] * weight) / (self.taps + weight)
        })
    }

    /// Returns the covariance around a mean, pulled to another one with a weight in taps.
    fn covariance(&self, mean: Millimetres, other: Covariance, weight: f32) -> Covariance {
        let [sx, sy] = self.residuals;
        let [mx, my] = mean;
        let around = [
            self.squares[0] - 2.0 * mx * sx + self.taps * mx * mx,
            self.squares[1] - 2.0 * my * sy + self.taps * my * my,
            self.squares[2] - mx * sy - my * sx + self.taps * mx * my,
        ];
        positive(std::array::from_fn(|index| {
            (around[index] + other[index] * weight) / (self.taps + weight)
        }))
    }
}

/// The sums of a person's taps on a key.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeySums {
    /// The character of the key.
    pub character: char,
    /// The residuals of its taps.
    pub sums: Sums,
}

/// The touch model of a person, plain values that can be stored.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TouchModel {
    /// The belief before the first tap.
    pub prior: Prior,
    /// The residuals of all taps.
    pub person: Sums,
    /// The residuals by key.
    pub keys: Vec<KeySums>,
    /// The last known displacement of the hands.
    pub hands: Hands,
    /// Successive taps of different hands.
    pub other_hand: PairSums,
    /// Successive taps of one hand.
    pub same_hand: PairSums,
    /// The rates of taps that are missed or mean nothing.
    pub errors: ErrorSums,
}

/// The distribution of the taps of a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The mean, without the drift of the hand.
    pub mean: Millimetres,
    /// The covariance.
    pub covariance: Covariance,
}

impl TouchModel {
    /// Makes the model of an unknown person.
    pub fn new(prior: Prior) -> Self {
        Self {
            prior: prior.sane(),
            ..Self::default()
        }
    }

    /// Forgets the person, and keeps the room for keys.
    pub fn reset(&mut self) {
        let mut keys = std::mem::take(&mut self.keys);
        keys.clear();
        *self = Self {
            keys,
            ..Self::new(self.prior)
        };
    }

    /// Repairs values that were read from a file: what is not finite is forgotten.
    pub fn sanitize(&mut self) {
        self.prior = self.prior.sane();
        if !self.person.is_finite() {
            self.person = Sums::default();
        }
        self.keys.retain(|key| key.sums.is_finite());
        if !self.errors.is_sane() {
            self.errors = ErrorSums::default();
        }
        for number in self.hands.drift.as_flattened_mut() {
            if !number.is_finite() || number.abs() > 1e3 {
                *number = 0.0;
            }
        }
        self.hands.lift();
        for sums in [&mut self.other_hand, &mut self.same_hand] {
            if !sums.is_sane() {
                *sums = PairSums::default();
            }
        }
    }

    /// Makes room for the keys of a keyboard, so that learning does not allocate.
    pub fn reserve(&mut self, keyboard: &Keyboard) {
        for key in keyboard.keys() {
            if !self
                .keys
                .iter()
                .any(|known| known.character == key.character)
            {
                self.keys.push(KeySums {
                    character: key.character,
                    sums: Sums::default(),
                });
            }
        }
    }

    /// Learns that a tap meant a key. The residual is its distance from the center of the key, without the drift of the hand.
    pub fn learn(&mut self, character: char, residual: Millimetres) {
        if !residual.iter().all(|value| value.is_finite()) {
            return;
        }
        let memory = self.prior.memory;
        self.person.forget(memory);
        // The space bar is hit anywhere along it.
        if character != ' ' {
            self.person.add(residual);
        }
        for key in &mut self.keys {
            key.sums.forget(memory);
            if key.character == character {
                key.sums.add(residual);
            }
        }
    }

    /// Learns from the residuals of two successive taps, their distances from the means of their keys without the drift of the hands.
    pub fn learn_pair(&mut self, is_same_hand: bool, first: Millimetres, second: Millimetres) {
        let sums = if is_same_hand {
            &mut self.same_hand
        } else {
            &mut self.other_hand
        };
        sums.forget(self.prior.memory);
        sums.add(first, second);
    }

    /// Returns the believed correlations of successive taps.
    pub fn correlations(&self) -> Correlations {
        let Prior {
            other_hand,
            same_hand,
            pairs,
            ..
        } = self.prior;
        Correlations {
            other_hand: self.other_hand.believed(other_hand, pairs),
            same_hand: self.same_hand.believed(same_hand, pairs),
        }
    }

    /// Learns from a number of taps how many of them meant nothing, how many characters were not tapped, and how many pairs came in
    /// the wrong order.
    pub fn learn_errors(&mut self, seen: ErrorCounts) {
        let memory = self.prior.memory.powi(seen.taps.min(1_000) as i32);
        let add = |sum: f32, count: usize| sum * memory + count as f32;
        self.errors.taps = add(self.errors.taps, seen.taps);
        self.errors.spurious = add(self.errors.spurious, seen.spurious);
        self.errors.missed = add(self.errors.missed, seen.missed);
        self.errors.swapped = add(self.errors.swapped, seen.swapped);
    }

    /// Returns the distribution of the taps of each key.
    pub fn spreads<'a>(&'a self, keyboard: &'a Keyboard) -> impl Iterator<Item = Spread> + 'a {
        self.spreads_of(keyboard, 1.0)
    }

    /// Like [`spreads`](Self::spreads), with the covariance of the prior times a scale.
    pub(crate) fn spreads_of<'a>(
        &'a self,
        keyboard: &'a Keyboard,
        scale: f32,
    ) -> impl Iterator<Item = Spread> + 'a {
        let prior = &self.prior;
        let offset = self.person.mean(prior.offset, prior.offset_taps);
        let believed = prior.covariance.map(|value| value * scale);
        let covariance = self
            .person
            .covariance(offset, believed, prior.covariance_taps);
        keyboard.keys().iter().map(move |key| {
            let known = self
                .keys
                .iter()
                .find(|known| known.character == key.character);
            let sums = known.map_or(Sums::default(), |known| known.sums);
            // The tap of a wide key lands anywhere along it; more than its covariance, its width says how far.
            let wide =
                |axis: usize| ((key.size[axis] / 2.0).powi(2) / 3.0 - covariance[axis]).max(0.0);
            let wide = if key.size[0] > 2.0 * key.size[1] {
                [wide(0), 0.0]
            } else {
                [0.0; 2]
            };
            let own = sums.mean(offset, prior.key_taps);
            let of_key = [
                covariance[0] + wide[0],
                covariance[1] + wide[1],
                covariance[2],
            ];
            Spread {
                mean: [key.center[0] + own[0], key.center[1] + own[1]],
                covariance: sums.covariance(own, of_key, 2.0 * prior.key_taps),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keyboard::Key;

    fn keyboard() -> Keyboard {
        Keyboard::new([('a', 0.0), ('b', 19.0)].map(|(character, x)| Key {
            character,
            center: [x, 0.0],
            size: [19.0; 2],
            hand: 0,
        }))
    }

    fn learned(taps: usize) -> TouchModel {
        let mut model = TouchModel::new(Prior::default());
        model.reserve(&keyboard());
        let mut random = fastrand::Rng::with_seed(7);
        for _ in 0..taps {
            // Uniform noise: mean (3, −2), variances 3 and 0.75, covariance 1.5.
            let noise = (random.f32() - 0.5) * 6.0;
            model.learn('a', [3.0 + noise, -2.0 + noise / 2.0]);
        }
        model
    }

    #[test]
    fn offset_and_covariance_of_a_person_are_learned() {
        let model = learned(2_000);
        let spreads: Vec<Spread> = model.spreads(&keyboard()).collect();
        let [own, other] = [spreads[0], spreads[1]];
        assert!(
            (own.mean[0] - 3.0).abs() < 0.3 && (own.mean[1] + 2.0).abs() < 0.3,
            "{own:?}"
        );
        assert!(
            own.covariance[0] < 6.0 && own.covariance[1] < 4.0,
            "{own:?}"
        );
        assert!(own.covariance[2] > 0.5, "{own:?}");
        // A key that was never tapped has the offset of the person.
        assert!((other.mean[0] - 19.0 - 3.0).abs() < 0.5, "{other:?}");
    }

    #[test]
    fn an_unknown_person_has_the_prior() {
        let model = TouchModel::new(Prior {
            offset: [-0.42, -0.26],
            covariance: [2.6, 3.2, 0.0],
            ..Prior::default()
        });
        let spread = model.spreads(&keyboard()).next().expect("a key");
        assert_eq!(spread.mean, [-0.42, -0.26]);
        assert!((spread.covariance[0] - 2.6).abs() < 1e-5);
    }

    #[test]
    fn old_taps_are_forgotten() {
        let mut model = learned(2_000);
        for _ in 0..3_000 {
            model.learn('a', [-4.0, 0.0]);
        }
        let spread = model.spreads(&keyboard()).next().expect("a key");
        assert!((spread.mean[0] + 4.0).abs() < 0.4, "{spread:?}");
    }

    #[test]
    fn a_model_survives_storing_and_a_reset_forgets_it() {
        let mut model = learned(100);
        let text = serde_json::to_string(&model).expect("text");
        assert_eq!(
            serde_json::from_str::<TouchModel>(&text).expect("a model"),
            model
        );
        model.reset();
        assert_eq!(model, TouchModel::new(Prior::default()));
    }

    #[test]
    fn values_that_are_not_finite_are_repaired() {
        let mut model = learned(100);
        model.person.taps = f32::NAN;
        model.hands.drift = [[f32::INFINITY; 2]; 2];
        model.prior.covariance = [-1.0, 4.0, 100.0];
        model.keys[0].sums.squares[1] = f32::NAN;
        model.sanitize();
        model.learn('b', [f32::NAN, 0.0]);
        for spread in model.spreads(&keyboard()) {
            let [xx, yy, xy] = spread.covariance;
            assert!(
                xx * yy > xy * xy && spread.mean[0].is_finite(),
                "{spread:?}"
            );
        }
    }
}

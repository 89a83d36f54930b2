//! Displacement of the hands from the keys: slow drift, and scatter that lasts from one tap to the next.
//!
//! A person who taps 4 mm to the right of a key probably taps the next one too far to the right as well, as the hand starts from there.
//! In the taps of eight people on a telephone, the correlation of two successive letters is 0.16 for one thumb and 0.15 for different
//! thumbs, both ±0.05, around the mean of each thumb (`tests/real_taps.rs`); around the mean of each person it is 0.20 and 0.09.

use serde::{Deserialize, Serialize};

use crate::keyboard::Millimetres;

/// The largest correlation of two successive taps that is believed.
const MAX_CORRELATION: f32 = 0.6;

/// The displacement of the hands after a tap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Hands {
    /// The drift of each hand, in millimetres.
    pub drift: [Millimetres; 2],
    /// The scatter of the last tap: its distance from the mean of its key without the drift, in millimetres.
    pub scatter: Millimetres,
    /// The hand of the last tap, 0 or 1.
    pub last: u8,
}

/// Correlations between the scatter of two successive taps, each 0 to 0.6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correlations {
    /// The correlation if the other hand tapped before.
    pub other_hand: f32,
    /// The correlation if the same hand tapped before.
    pub same_hand: f32,
}

impl Correlations {
    /// Returns the correlation of a tap of a hand with the tap before.
    pub fn with(&self, hands: &Hands, hand: usize) -> f32 {
        if usize::from(hands.last) == hand {
            self.same_hand
        } else {
            self.other_hand
        }
    }

    /// Returns the expected distance of the next tap of a hand from the mean of its key, in millimetres.
    pub fn expected(&self, hands: &Hands, hand: usize) -> Millimetres {
        let correlation = self.with(hands, hand);
        std::array::from_fn(|axis| hands.drift[hand][axis] + correlation * hands.scatter[axis])
    }
}

impl Hands {
    /// Forgets the last tap, after the hands were lifted.
    pub fn lift(&mut self) {
        self.scatter = Millimetres::default();
    }
}

/// Sums over pairs of successive taps, older ones counted less.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PairSums {
    /// The number of pairs.
    pub pairs: f32,
    /// The sum of the products of both residuals, in mm².
    pub products: f32,
    /// The sum of the mean squares of both residuals, in mm².
    pub squares: f32,
}

impl PairSums {
    /// Adds the residuals of two successive taps.
    pub fn add(&mut self, first: Millimetres, second: Millimetres) {
        self.pairs += 1.0;
        for (before, after) in first.into_iter().zip(second) {
            self.products += before * after;
            self.squares += 0.5 * (before * before + after * after);
        }
    }

    /// Counts all pairs less.
    pub fn forget(&mut self, memory: f32) {
        for sum in [&mut self.pairs, &mut self.products, &mut self.squares] {
            *sum *= memory;
        }
    }

    /// Returns the correlation of the pairs, -1 to 1; 0 without pairs.
    pub fn correlation(&self) -> f32 {
        if self.squares > 0.0 {
            (self.products / self.squares).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    }

    /// Returns the correlation, pulled to another one with a weight in pairs.
    pub fn believed(&self, other: f32, weight: f32) -> f32 {
        let believed = (self.pairs * self.correlation() + weight * other) / (self.pairs + weight);
        believed.clamp(0.0, MAX_CORRELATION)
    }

    /// Returns `true` if the sums can be used.
    pub fn is_sane(&self) -> bool {
        [self.pairs, self.squares]
            .iter()
            .all(|sum| sum.is_finite() && *sum >= 0.0)
            && self.products.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correlation_is_learned_from_pairs() {
        let mut sums = PairSums::default();
        assert_eq!(sums.believed(0.2, 50.0), 0.2);
        let mut random = fastrand::Rng::with_seed(3);
        let mut normal = || (0..12).map(|_| random.f32()).sum::<f32>() - 6.0;
        let mut before = [0.0; 2];
        for _ in 0..4_000 {
            let tap = before.map(|scatter: f32| 0.4 * scatter + 0.84_f32.sqrt() * normal());
            sums.add(before, tap);
            before = tap;
        }
        assert!((sums.correlation() - 0.4).abs() < 0.05, "{sums:?}");
        assert!((sums.believed(0.0, 50.0) - 0.4).abs() < 0.05);
        sums.forget(0.01);
        assert!((sums.believed(0.0, 60.0) - 0.16).abs() < 0.03, "{sums:?}");
    }

    #[test]
    fn taps_that_alternate_are_no_reason_to_expect_the_other_side() {
        let mut sums = PairSums::default();
        for _ in 0..500 {
            sums.add([3.0, 0.0], [-3.0, 0.0]);
        }
        assert_eq!(sums.correlation(), -1.0);
        assert_eq!(sums.believed(0.2, 50.0), 0.0);
    }

    #[test]
    fn the_next_tap_is_expected_beside_the_last_one() {
        let hands = Hands {
            drift: [[1.0, 0.0], [0.0, 2.0]],
            scatter: [4.0, -2.0],
            last: 1,
        };
        let correlations = Correlations {
            other_hand: 0.0,
            same_hand: 0.5,
        };
        assert_eq!(correlations.expected(&hands, 0), [1.0, 0.0]);
        assert_eq!(correlations.expected(&hands, 1), [2.0, 1.0]);
    }
}

//! Distributions, errors and correlations of taps, as the file of a person states them.

use std::fmt::Write;

use ademan_core::document::schema;
use serde::{Deserialize, Serialize};

use crate::touch::{KeySums, PairSums, Sums};

schema! {
    /// Distribution of taps around the centers of keys, older taps counted less.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    pub struct LearnedTaps {
        /// The number of taps, 0 to 10000.
        pub taps: f32,
        /// The mean distance from the center of the key, to the right and down, in millimetres, each -100 to 100.
        pub offset_mm: (f32, f32),
        /// The standard deviation in both directions, in millimetres, each 0 to 100.
        pub scatter_mm: (f32, f32),
        /// The correlation of both directions, -1 to 1.
        pub correlation: f32,
    }
}

schema! {
    /// Distribution of the taps on a key.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct LearnedKey {
        /// The character of the key, exactly one.
        pub key: String,
        /// The number of taps, 0 to 10000.
        pub taps: f32,
        /// The mean distance from the center of the key, to the right and down, in millimetres, each -100 to 100.
        pub offset_mm: (f32, f32),
        /// The standard deviation in both directions, in millimetres, each 0 to 100.
        pub scatter_mm: (f32, f32),
        /// The correlation of both directions, -1 to 1.
        pub correlation: f32,
    }
}

schema! {
    /// The errors in a number of taps, older ones counted less.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    pub struct LearnedErrors {
        /// The number of taps, 0 to 10000.
        pub taps: f32,
        /// Taps that meant nothing, 0 to 10000.
        pub spurious: f32,
        /// Characters that were meant and not tapped, 0 to 10000.
        pub missed: f32,
        /// Pairs of taps in the wrong order, 0 to 10000.
        pub swapped: f32,
    }
}

schema! {
    /// Correlation between the distances of successive taps from where the person taps their keys, older taps counted less.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    pub struct LearnedPairs {
        /// The number of pairs of taps, 0 to 10000.
        pub pairs: f32,
        /// The correlation, -1 to 1.
        pub correlation: f32,
    }
}

impl LearnedTaps {
    pub(super) fn new(sums: &Sums) -> Self {
        if sums.taps <= 0.0 {
            return Self::default();
        }
        let [x, y] = sums.residuals.map(|sum| sum / sums.taps);
        let [xx, yy, xy] = sums.squares.map(|sum| sum / sums.taps);
        let deviation = |square: f32, mean: f32| (square - mean * mean).max(0.0).sqrt();
        let scatter = [deviation(xx, x), deviation(yy, y)];
        let both = scatter[0] * scatter[1];
        let correlation = if both > 0.0 { (xy - x * y) / both } else { 0.0 };
        Self {
            taps: sums.taps,
            offset_mm: (x, y),
            scatter_mm: scatter.into(),
            correlation: correlation.clamp(-1.0, 1.0),
        }
    }

    /// Returns the sums of the taps, each counted as a fraction of one.
    pub(super) fn sums(&self, fraction: f32) -> Sums {
        let taps = self.taps * fraction;
        let ((x, y), (sx, sy)) = (self.offset_mm, self.scatter_mm);
        let squares = [
            sx * sx + x * x,
            sy * sy + y * y,
            self.correlation * sx * sy + x * y,
        ];
        Sums {
            taps,
            residuals: [x * taps, y * taps],
            squares: squares.map(|square| square * taps),
        }
    }

    pub(super) fn check(&self) -> Result<(), &'static str> {
        let within = |values: &[f32], low: f32, high: f32| {
            values.iter().all(|value| (low..=high).contains(value))
        };
        if !within(&[self.taps], 0.0, 1e4) {
            return Err("`taps` is 0 to 10000");
        }
        if !within(&<[f32; 2]>::from(self.offset_mm), -100.0, 100.0) {
            return Err("`offset_mm` is -100 to 100 mm in both directions");
        }
        if !within(&<[f32; 2]>::from(self.scatter_mm), 0.0, 100.0) {
            return Err("`scatter_mm` is 0 to 100 mm in both directions");
        }
        if !within(&[self.correlation], -1.0, 1.0) {
            return Err("`correlation` is -1 to 1");
        }
        Ok(())
    }

    /// Writes the fields, with as many digits as taps are precise.
    pub(super) fn write(&self, text: &mut String) {
        let Self {
            taps,
            offset_mm: (x, y),
            scatter_mm: (sx, sy),
            correlation,
        } = self;
        // A negative zero has no meaning here.
        let [x, y, correlation] = [x, y, correlation].map(|value| {
            let rounded = (value * 1e3).round() / 1e3;
            rounded + 0.0
        });
        let _ = write!(
            text,
            "taps: {taps:.1}, offset_mm: ({x:.3}, {y:.3}), scatter_mm: ({sx:.3}, {sy:.3}), correlation: {correlation:.3}"
        );
    }
}

impl LearnedKey {
    pub(super) fn new(key: &KeySums) -> Self {
        let LearnedTaps {
            taps,
            offset_mm,
            scatter_mm,
            correlation,
        } = LearnedTaps::new(&key.sums);
        Self {
            key: key.character.into(),
            taps,
            offset_mm,
            scatter_mm,
            correlation,
        }
    }

    pub(super) fn numbers(&self) -> LearnedTaps {
        LearnedTaps {
            taps: self.taps,
            offset_mm: self.offset_mm,
            scatter_mm: self.scatter_mm,
            correlation: self.correlation,
        }
    }
}

impl LearnedErrors {
    pub(super) fn check(&self) -> Result<(), &'static str> {
        let within = |value: f32| (0.0..=1e4).contains(&value);
        let all = [self.taps, self.spurious, self.missed, self.swapped];
        if all.into_iter().all(within) {
            return Ok(());
        }
        Err("`taps`, `spurious`, `missed` and `swapped` of `errors` are 0 to 10000")
    }
}

impl LearnedPairs {
    pub(super) fn new(sums: &PairSums) -> Self {
        Self {
            pairs: sums.pairs,
            correlation: sums.correlation(),
        }
    }

    /// Returns the sums of the pairs, each counted as a fraction of one. `variance` is the sum of the variances of a tap along both axes.
    pub(super) fn sums(&self, fraction: f32, variance: f32) -> PairSums {
        let pairs = self.pairs * fraction;
        PairSums {
            pairs,
            products: self.correlation * variance * pairs,
            squares: variance * pairs,
        }
    }

    pub(super) fn check(&self) -> Result<(), &'static str> {
        if !(0.0..=1e4).contains(&self.pairs) || !(-1.0..=1.0).contains(&self.correlation) {
            return Err(
                "`pairs` of `other_hand` and `same_hand` is 0 to 10000, `correlation` -1 to 1",
            );
        }
        Ok(())
    }

    /// Writes the fields, with as many digits as taps are precise.
    pub(super) fn write(&self, name: &str, text: &mut String) {
        let Self { pairs, correlation } = self;
        // A negative zero has no meaning here.
        let correlation = (correlation * 1e3).round() / 1e3 + 0.0;
        let _ = writeln!(
            text,
            "    {name}: (pairs: {pairs:.1}, correlation: {correlation:.3}),"
        );
    }
}

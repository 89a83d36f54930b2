//! Intervals by resampling of people.

use serde::{Deserialize, Serialize};

use crate::people::Draw;

/// The number of samples of people.
const SAMPLES: usize = 2_000;

/// The fewest people who can show a difference: fewer differ all in one direction by chance in more than one case of 20 (sign test,
/// 2 / 2⁵), and no sample of them tells otherwise.
pub const FEWEST_PEOPLE: usize = 6;

/// A figure of all people, with the interval that holds 95 % of the figures of resampled people (percentile bootstrap).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The figure.
    pub value: f64,
    /// The 2.5 % quantile.
    pub low: f64,
    /// The 97.5 % quantile.
    pub high: f64,
}

impl Interval {
    /// Returns `true` if 0 is outside the interval.
    pub fn excludes_zero(&self) -> bool {
        self.low > 0.0 || self.high < 0.0
    }
}

/// Computes a figure of people and its interval; `figure` gets the people by reference. Without people, everything is 0. The same people
/// give the same interval.
pub fn bootstrap<T>(people: &[T], figure: impl Fn(&[&T]) -> f64) -> Interval {
    if people.is_empty() {
        return Interval::default();
    }
    let all: Vec<&T> = people.iter().collect();
    let value = figure(&all);
    let mut draw = Draw::new(people.len() as u64, 0xb007);
    let mut figures: Vec<f64> = (0..SAMPLES)
        .map(|_| {
            let sample = all.iter().map(|_| all[draw.index(all.len())]);
            figure(&sample.collect::<Vec<_>>())
        })
        .collect();
    figures.sort_by(f64::total_cmp);
    let quantile = |part: f64| figures[((SAMPLES - 1) as f64 * part).round() as usize];
    Interval {
        value,
        low: quantile(0.025),
        high: quantile(0.975),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(numbers: &[&f64]) -> f64 {
        numbers.iter().copied().sum::<f64>() / numbers.len() as f64
    }

    #[test]
    fn nineteen_of_twenty_intervals_hold_the_true_mean() {
        let mut draw = Draw::new(5, 5);
        let mut held = 0;
        for _ in 0..200 {
            let people: Vec<f64> = (0..40).map(|_| 10.0 + 2.0 * draw.normal()).collect();
            let interval = bootstrap(&people, mean);
            held += u32::from(interval.low <= 10.0 && 10.0 <= interval.high);
        }
        // 95 % of 200, with three deviations of a binomial number on either side.
        assert!((178..=199).contains(&held), "{held}");
    }

    #[test]
    fn nobody_and_one_person_have_no_width() {
        assert_eq!(bootstrap(&[], mean), Interval::default());
        let one = bootstrap(&[3.0], mean);
        assert_eq!((one.low, one.value, one.high), (3.0, 3.0, 3.0));
    }
}

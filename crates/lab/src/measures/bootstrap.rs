//! Intervals by resampling of people.

use serde::{Deserialize, Serialize};

use crate::people::Draw;

/// The number of samples of people.
const SAMPLES: usize = 2_000;

/// The fewest people who can show a difference: fewer differ all in one direction by chance in more than one case of 20 (sign test,
/// 2 / 2⁵), and no sample of them tells otherwise.
pub const FEWEST_PEOPLE: usize = 6;

/// The 97.5 % quantile of the normal distribution.
const NORMAL_QUANTILE: f64 = 1.959_963_984_540_054;

/// A figure of all people with its interval of 95 %: between two quantiles of the figures of resampled people (percentile bootstrap),
/// which are further out the fewer people there are, see [`bootstrap`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The figure.
    pub value: f64,
    /// The lower end.
    pub low: f64,
    /// The upper end.
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
///
/// Between the 2.5 % and the 97.5 % quantile of resampled people lies the true figure of a population less often than in 95 of 100
/// cases: resampled people deviate less from each other than people, by n − 1 of n in the variance, and how much few people deviate is
/// not known well. The quantiles are those for which an interval of the mean is as wide as with Student's distribution (Hesterberg 2015,
/// What teachers should know about the bootstrap, doi 10.1080/00031305.2015.1089789).
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
    let tail = outside(people.len());
    Interval {
        value,
        low: quantile(tail),
        high: quantile(1.0 - tail),
    }
}

/// Returns the part of the resampled figures on each side of the interval of a number of people: 0.025 for very many. It is
/// Φ(−t √(n / (n − 1))), where t is the 97.5 % quantile of Student's distribution with n − 1 degrees of freedom.
fn outside(people: usize) -> f64 {
    let degrees = people as f64 - 1.0;
    normal_tail(student_quantile(degrees) * (people as f64 / degrees).sqrt())
}

/// Returns the 97.5 % quantile of Student's distribution (Abramowitz & Stegun 1964, 26.7.5): too small by 0.0003 for five degrees of
/// freedom, and by 1.4 for one, with which no resampled figure is outside anyway.
fn student_quantile(degrees: f64) -> f64 {
    let square = NORMAL_QUANTILE * NORMAL_QUANTILE;
    let terms = [
        (square + 1.0) / 4.0,
        ((5.0 * square + 16.0) * square + 3.0) / 96.0,
        (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0,
        ((((79.0 * square + 776.0) * square + 1482.0) * square - 1920.0) * square - 945.0)
            / 92_160.0,
    ];
    let terms = terms.into_iter().rev();
    let series = terms.fold(0.0_f64, |sum, term| (sum + term) / degrees);
    NORMAL_QUANTILE * (1.0 + series)
}

/// Returns the part of the normal distribution above a number that is not below 0 (Abramowitz & Stegun 1964, 26.2.17), to 1e-7.
fn normal_tail(number: f64) -> f64 {
    let k = 1.0 / (1.0 + 0.231_641_9 * number);
    let terms: [f64; 5] = [
        0.319_381_53,
        -0.356_563_782,
        1.781_477_937,
        -1.821_255_978,
        1.330_274_429,
    ];
    let series = terms.into_iter().rev();
    let factor = series.fold(0.0_f64, |sum, term| (sum + term) * k);
    factor * (-number * number / 2.0).exp() / std::f64::consts::TAU.sqrt()
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
    fn intervals_of_six_people_hold_the_true_mean_nearly_as_often() {
        fn held(mut draw: Draw, person: impl Fn(&mut Draw) -> f64, truth: f64) -> usize {
            let mut count = 0;
            for _ in 0..400 {
                let people: Vec<f64> = (0..6).map(|_| person(&mut draw)).collect();
                let interval = bootstrap(&people, mean);
                count += usize::from(interval.low <= truth && truth <= interval.high);
            }
            count
        }
        let normal = held(Draw::new(5, 6), |draw| 10.0 + 2.0 * draw.normal(), 10.0);
        // A skewed distribution, like the errors of people. Its mean is e^(σ² / 2), and σ² is ln 1.25.
        let truth = 1.25_f64.sqrt();
        let skewed = held(Draw::new(7, 6), |draw| draw.log_normal(1.0, 0.5), truth);
        // The 2.5 % and the 97.5 % quantile hold 344 and 335 of 400.
        assert!((368..=392).contains(&normal), "{normal}");
        assert!((364..=392).contains(&skewed), "{skewed}");
    }

    #[test]
    fn quantiles_of_few_people_are_further_out() {
        for (degrees, quantile) in [(5.0, 2.571), (9.0, 2.262), (19.0, 2.093), (99.0, 1.984)] {
            let found = student_quantile(degrees);
            assert!((found - quantile).abs() < 1e-3, "{degrees}: {found}");
        }
        for (number, part) in [(0.0, 0.5), (1.0, 0.158_655), (NORMAL_QUANTILE, 0.025)] {
            let found = normal_tail(number);
            assert!((found - part).abs() < 1e-6, "{number}: {found}");
        }
        assert_eq!(outside(1), 0.0);
        assert!((outside(6) - 0.002_434).abs() < 1e-5, "{}", outside(6));
        assert!((0.0247..0.025).contains(&outside(1000)));
    }

    #[test]
    fn nobody_and_one_person_have_no_width() {
        assert_eq!(bootstrap(&[], mean), Interval::default());
        let one = bootstrap(&[3.0], mean);
        assert_eq!((one.low, one.value, one.high), (3.0, 3.0, 3.0));
    }
}

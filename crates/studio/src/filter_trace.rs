//! One angle before and after the smoothing filter, and the lag between both.

use std::collections::VecDeque;
use std::time::Duration;

use ademan_core::time::Timestamp;

/// Seconds that are kept.
pub const SECONDS: f64 = 5.0;

/// Time between two samples of the correlation, in seconds.
const GRID: f64 = 0.002;

/// The largest lag that is searched, in seconds.
const MAX_LAG: f64 = 0.3;

/// The smallest movement whose lag is measured: a standard deviation in degrees.
const MIN_MOVEMENT: f64 = 1.0;

/// The most samples that are kept: 5 s at 1000 readings per second.
const MAX_SAMPLES: usize = 5_000;

/// An angle at one time, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSample {
    /// Time of the reading.
    pub time: Timestamp,
    /// The angle before the filter.
    pub raw: f64,
    /// The angle after the filter.
    pub filtered: f64,
}

/// The last [`SECONDS`] of an angle.
#[derive(Clone, Debug, Default)]
pub struct FilterTrace {
    samples: VecDeque<FilterSample>,
}

impl FilterTrace {
    /// Adds a sample. A sample older than the last one starts the trace over.
    pub fn push(&mut self, sample: FilterSample) {
        let last = self.samples.back();
        if last.is_some_and(|last| sample.time <= last.time) {
            self.samples.clear();
        }
        self.samples.push_back(sample);
        while let Some(first) = self.samples.front()
            && (self.samples.len() > MAX_SAMPLES
                || sample.time.since(first.time).as_secs_f64() > SECONDS)
        {
            self.samples.pop_front();
        }
    }

    /// Removes all samples.
    pub fn clear(&mut self) {
        self.samples.clear();
    }

    /// Iterates over the age in seconds and the sample, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = (f64, &FilterSample)> {
        let last = self.samples.back().map(|last| last.time);
        self.samples.iter().map(move |sample| {
            let age = last.map_or(Duration::ZERO, |last| last.since(sample.time));
            (age.as_secs_f64(), sample)
        })
    }

    /// Returns the lag of the filter, or `None` if the angle has not moved enough to measure it.
    pub fn lag(&self) -> Option<Duration> {
        let samples: Vec<FilterSample> = self.samples.iter().copied().collect();
        lag(&samples)
    }
}

/// Returns the lag at which the filtered angle correlates best with the raw one, or `None` if the angle moves too little or for
/// too short a time.
///
/// Both are interpolated to a grid of 2 ms, and Pearson's correlation is computed for each lag up to 300 ms. A parabola through
/// the best lag and its neighbors gives the part between two grid points.
pub fn lag(samples: &[FilterSample]) -> Option<Duration> {
    let (raw, filtered) = (
        on_grid(samples, |it| it.raw),
        on_grid(samples, |it| it.filtered),
    );
    let lags = (MAX_LAG / GRID) as usize;
    let window = raw.len().checked_sub(lags)?;
    if window < lags {
        return None;
    }
    let late = &filtered[lags..];
    // The window of the filtered angle stays, so that all lags are judged by the same movement.
    let scores: Option<Vec<f64>> = (0..=lags)
        .map(|lag| correlation(&raw[lags - lag..lags - lag + window], late))
        .collect();
    let scores = scores?;
    let best = (0..scores.len()).max_by(|&a, &b| scores[a].total_cmp(&scores[b]))?;
    let seconds = (best as f64 + peak_offset(&scores, best)) * GRID;
    (best < lags).then(|| Duration::from_secs_f64(seconds.max(0.0)))
}

/// Returns values at equal distances in time, by linear interpolation.
fn on_grid(samples: &[FilterSample], value: impl Fn(&FilterSample) -> f64) -> Vec<f64> {
    let Some(first) = samples.first() else {
        return Vec::new();
    };
    let mut values = Vec::new();
    for pair in samples.windows(2) {
        let [from, to] = [&pair[0], &pair[1]];
        let start = from.time.since(first.time).as_secs_f64();
        let length = to.time.since(from.time).as_secs_f64();
        while values.len() as f64 * GRID < start + length {
            let t = (values.len() as f64 * GRID - start) / length;
            values.push(value(from) + t * (value(to) - value(from)));
        }
    }
    values
}

/// Returns Pearson's correlation, or `None` if one of both hardly varies.
fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let count = a.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let product = |x: f64, y: f64| (x - mean_a) * (y - mean_b);
    let covariance: f64 = a.iter().zip(b).map(|(&x, &y)| product(x, y)).sum::<f64>() / count;
    let variance = |values: &[f64], center: f64| {
        values
            .iter()
            .map(|value| (value - center).powi(2))
            .sum::<f64>()
            / count
    };
    let (own, other) = (variance(a, mean_a), variance(b, mean_b));
    let is_moving = own.min(other) >= MIN_MOVEMENT * MIN_MOVEMENT;
    is_moving.then(|| covariance / (own * other).sqrt())
}

/// Returns the distance from the best grid point to the peak of the parabola through it and its neighbors, −0.5..=0.5.
fn peak_offset(scores: &[f64], best: usize) -> f64 {
    if best == 0 || best + 1 >= scores.len() {
        return 0.0;
    }
    let (before, peak, after) = (scores[best - 1], scores[best], scores[best + 1]);
    let curvature = before - 2.0 * peak + after;
    if curvature < 0.0 {
        (0.5 * (before - after) / curvature).clamp(-0.5, 0.5)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A finger that taps about twice a second, and the same `delay` seconds later.
    fn tapping(delay: f64) -> Vec<FilterSample> {
        let period = 0.0057;
        let angle = |time: f64| 20.0 * (13.0 * time).sin() + 7.0 * (31.0 * time + 1.0).sin();
        let count = (4.0 / period) as usize;
        let sample = |index: usize| {
            let time = index as f64 * period;
            FilterSample {
                time: Timestamp((time * 1e6) as u64),
                raw: angle(time),
                filtered: angle(time - delay),
            }
        };
        (0..count).map(sample).collect()
    }

    #[test]
    fn a_delay_is_measured_within_a_millisecond() {
        for delay_ms in [0.0, 5.0, 23.0, 61.0, 140.0] {
            let lag = lag(&tapping(delay_ms / 1e3)).unwrap();
            let error = lag.as_secs_f64() * 1e3 - delay_ms;
            assert!(error.abs() < 1.0, "{delay_ms} ms: {lag:?}");
        }
    }

    #[test]
    fn a_resting_or_short_trace_has_no_lag() {
        let mut resting = tapping(0.02);
        for sample in &mut resting {
            (sample.raw, sample.filtered) = (30.0, 30.0);
        }
        assert_eq!(lag(&resting), None);
        assert_eq!(lag(&tapping(0.02)[..20]), None);
        assert_eq!(lag(&[]), None);
    }

    #[test]
    fn old_samples_are_dropped_and_an_older_time_starts_anew() {
        let mut trace = FilterTrace::default();
        let sample = |seconds: u64| FilterSample {
            time: Timestamp(seconds * 1_000_000),
            raw: 0.0,
            filtered: 0.0,
        };
        (0..20).for_each(|second| trace.push(sample(second)));
        assert_eq!(trace.iter().count(), 6);
        trace.push(sample(1));
        assert_eq!(trace.iter().count(), 1);
    }
}

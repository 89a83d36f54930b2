//! The jitter of a hand at rest and the lag of the filters, measured on a stream of raw and filtered values.
//!
//! - **Jitter**: the root mean square of the deviation from the mean of each window of [`WINDOW`], over the quietest fifth of
//!   the windows. A slow movement within a window counts as jitter.
//! - **Lag**: the shift at which the speeds of the filtered values correlate best with the speeds of the raw ones, with a
//!   parabola through the best shift and its neighbors. It needs movement and evenly spaced readings. Only the filters cause it:
//!   the delay of the sensor is not in the readings.

use std::collections::VecDeque;
use std::time::Duration;

use ademan_core::time::Timestamp;

/// Length of the windows of the jitter.
pub const WINDOW: Duration = Duration::from_millis(500);

/// Part of the windows that counts as rest.
const REST: f64 = 0.2;

/// Fewest readings of a window that counts.
const MIN_READINGS: u32 = 5;

/// Largest shift in readings.
const MAX_SHIFT: usize = 32;

/// Longest time between two readings whose difference is a speed.
const MAX_GAP: Duration = Duration::from_millis(500);

/// Most windows: five hours.
const MAX_WINDOWS: usize = 36_000;

/// Statistics of raw and filtered values with the same unit.
#[derive(Clone, Debug, Default)]
pub struct SignalStats {
    last: Option<(Timestamp, Vec<f64>, Vec<f64>)>,
    window_start: Timestamp,
    /// Sums of each value and its square in the window, raw and filtered.
    sums: Vec<[[f64; 2]; 2]>,
    window_readings: u32,
    /// Variances of the windows, raw and filtered.
    variances: Vec<[f64; 2]>,
    /// Latest speeds of the raw values, the newest first.
    raw_speeds: VecDeque<Vec<f64>>,
    /// Speeds of the filtered values one reading before.
    filtered_speed: Option<Vec<f64>>,
    /// Products of the filtered speeds one reading before with the raw ones, which begin with the present: the shifts begin
    /// with −1, so that the best one has a neighbor on both sides.
    products: [f64; MAX_SHIFT],
    squares: [f64; MAX_SHIFT],
    /// Time and number of the differences.
    elapsed: Duration,
    differences: u32,
}

/// Jitter and lag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalReport {
    /// Jitter of the raw and the filtered values at rest, in their unit. `None` if no window has enough readings.
    pub jitter: Option<[f64; 2]>,
    /// Lag of the filtered values. `None` without movement.
    pub lag: Option<Duration>,
}

impl SignalStats {
    /// Adds the values of one reading. Their number may change after a gap only.
    pub fn push(&mut self, time: Timestamp, raw: &[f64], filtered: &[f64]) {
        if self.sums.len() != raw.len() {
            self.last = None;
            self.raw_speeds.clear();
            self.filtered_speed = None;
            self.restart_window(time, raw.len());
        }
        if time.since(self.window_start) >= WINDOW {
            self.end_window();
            self.restart_window(time, raw.len());
        }
        self.window_readings += 1;
        for (sums, (&raw_value, &filtered_value)) in
            self.sums.iter_mut().zip(raw.iter().zip(filtered))
        {
            for (sum, value) in sums.iter_mut().zip([raw_value, filtered_value]) {
                sum[0] += value;
                sum[1] += value * value;
            }
        }
        self.correlate(time, raw, filtered);
        self.last = Some((time, raw.to_vec(), filtered.to_vec()));
    }

    fn restart_window(&mut self, time: Timestamp, values: usize) {
        self.window_start = time;
        self.window_readings = 0;
        self.sums = vec![[[0.0; 2]; 2]; values];
    }

    fn end_window(&mut self) {
        if self.window_readings < MIN_READINGS || self.variances.len() == MAX_WINDOWS {
            return;
        }
        let count = f64::from(self.window_readings);
        let mut variance = [0.0; 2];
        for sums in &self.sums {
            for (part, [sum, squares]) in variance.iter_mut().zip(sums) {
                *part += (squares / count - (sum / count).powi(2)).max(0.0);
            }
        }
        let values = self.sums.len().max(1) as f64;
        self.variances.push(variance.map(|sum| sum / values));
    }

    fn correlate(&mut self, time: Timestamp, raw: &[f64], filtered: &[f64]) {
        let Some((before, last_raw, last_filtered)) = &self.last else {
            return;
        };
        let gap = time.since(*before);
        if gap.is_zero() || gap > MAX_GAP {
            self.raw_speeds.clear();
            self.filtered_speed = None;
            return;
        }
        let seconds = gap.as_secs_f64();
        let speeds = |now: &[f64], earlier: &[f64]| -> Vec<f64> {
            let pairs = now.iter().zip(earlier);
            pairs.map(|(new, old)| (new - old) / seconds).collect()
        };
        self.raw_speeds.push_front(speeds(raw, last_raw));
        self.raw_speeds.truncate(MAX_SHIFT);
        if self.raw_speeds.len() < MAX_SHIFT {
            return;
        }
        let Some(filtered) = self.filtered_speed.replace(speeds(filtered, last_filtered)) else {
            return;
        };
        for (shift, earlier_raw) in self.raw_speeds.iter().enumerate() {
            self.products[shift] += dot(&filtered, earlier_raw);
            self.squares[shift] += dot(earlier_raw, earlier_raw);
        }
        self.elapsed += gap;
        self.differences += 1;
    }

    /// Returns jitter and lag of all readings so far.
    pub fn report(&self) -> SignalReport {
        SignalReport {
            jitter: self.jitter(),
            lag: self.lag(),
        }
    }

    fn jitter(&self) -> Option<[f64; 2]> {
        let mut variances = self.variances.clone();
        variances.sort_by(|one, other| one[0].total_cmp(&other[0]));
        let quiet = ((variances.len() as f64 * REST).ceil() as usize).min(variances.len());
        let quiet = &variances[..quiet];
        if quiet.is_empty() {
            return None;
        }
        let mean = |index: usize| {
            let sum: f64 = quiet.iter().map(|variance| variance[index]).sum();
            (sum / quiet.len() as f64).sqrt()
        };
        Some([mean(0), mean(1)])
    }

    fn lag(&self) -> Option<Duration> {
        let correlation = |shift: usize| {
            if self.squares[shift] > 0.0 {
                self.products[shift] / self.squares[shift].sqrt()
            } else {
                0.0
            }
        };
        let best = (0..MAX_SHIFT)
            .max_by(|&one, &other| correlation(one).total_cmp(&correlation(other)))?;
        if correlation(best) <= 0.0 || self.differences == 0 {
            return None;
        }
        let mut shift = best as f64;
        if (1..MAX_SHIFT - 1).contains(&best) {
            let [before, at, after] = [best - 1, best, best + 1].map(correlation);
            let curvature = before - 2.0 * at + after;
            if curvature < 0.0 {
                shift += 0.5 * (before - after) / curvature;
            }
        }
        let shift = (shift - 1.0).max(0.0);
        Some(self.elapsed.mul_f64(shift / f64::from(self.differences)))
    }
}

fn dot(first: &[f64], second: &[f64]) -> f64 {
    first
        .iter()
        .zip(second)
        .map(|(one, other)| one * other)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A signal that rests for 5 s with a noise of ±1 and then moves to and fro, with its value `delay` readings before.
    fn stats(delay: usize, gain: f64) -> SignalReport {
        let value = |index: usize| match index {
            0..500 => gain * f64::from((index * 7919 % 2) as u32) * 2.0,
            _ => 100.0 * (index as f64 * 0.13).sin() + 60.0 * (index as f64 * 0.037).cos(),
        };
        let mut stats = SignalStats::default();
        for index in delay..1500 {
            let time = Timestamp::from_seconds(index as f64 / 100.0);
            let raw = if index < 500 {
                value(index) / gain
            } else {
                value(index)
            };
            stats.push(time, &[raw], &[value(index - delay)]);
        }
        stats.report()
    }

    #[test]
    fn jitter_and_lag_of_a_known_signal_are_found() {
        for delay in [1, 2, 7, 20] {
            let report = stats(delay, 0.5);
            let lag = report.lag.expect("it moves").as_secs_f64();
            let expected = delay as f64 / 100.0;
            assert!((lag - expected).abs() < 0.002, "{lag} {expected}");
            let [raw, filtered] = report.jitter.expect("it rests");
            assert!((raw - 1.0).abs() < 0.05, "{raw}");
            assert!((filtered - 0.5).abs() < 0.05, "{filtered}");
        }
    }

    #[test]
    fn a_signal_without_movement_has_no_lag() {
        let mut stats = SignalStats::default();
        assert_eq!(
            stats.report(),
            SignalReport {
                jitter: None,
                lag: None
            }
        );
        for index in 0..200_u32 {
            stats.push(
                Timestamp::from_seconds(f64::from(index) / 100.0),
                &[3.0],
                &[3.0],
            );
        }
        assert_eq!(stats.report().lag, None);
        assert_eq!(stats.report().jitter, Some([0.0; 2]));
    }
}

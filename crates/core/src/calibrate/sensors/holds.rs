//! Holds: the times at which a channel is still.

use std::ops::Range;
use std::time::Duration;

use crate::capture::Channels;
use crate::time::Timestamp;

/// The time over which stillness is judged.
const WINDOW: Duration = Duration::from_millis(500);

/// The shortest hold.
const SHORTEST: Duration = Duration::from_secs(1);

/// The time at the start and at the end of a hold that does not count: the hand comes to rest, or starts to move.
const SETTLE: Duration = Duration::from_millis(300);

/// The change between the halves of a window that no tremor explains, as a fraction of the full scale: 1.5 counts of 255, as in a
/// calibration.
const STILL: f64 = 0.006;

/// Fewest readings of a window.
const MIN_READINGS: usize = 4;

/// A time at which a channel was still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hold {
    /// The middle of the time, in minutes.
    pub minute: f64,
    /// The mean count, without single spikes.
    pub mean: f64,
    /// The sum of squared deviations from the means of its windows, and its degrees of freedom.
    pub squares: f64,
    pub degrees: usize,
}

/// Returns the holds of a channel in the order of their times.
pub(super) fn holds(times: &[Timestamp], counts: &[u16], full_scale: u16) -> Vec<Hold> {
    // An unknown count ends a hold: it becomes a jump in the smoothed counts.
    let smooth = without_spikes(counts);
    let sums = Sums::new(&smooth);
    let limit = STILL * f64::from(full_scale);
    let mut holds = Vec::new();
    let mut open: Option<Range<usize>> = None;
    let mut first = 0;
    for (last, &end) in times.iter().enumerate() {
        while end.since(times[first]) > WINDOW {
            first += 1;
        }
        let is_full = end.since(times[first]) * 5 >= WINDOW * 4;
        let is_still = is_full && sums.is_still(first..last + 1, limit);
        match &mut open {
            Some(range) if is_still => range.end = last + 1,
            None if is_still => open = Some(first..last + 1),
            _ => holds.extend(open.take()),
        }
    }
    holds.extend(open);
    holds
        .into_iter()
        .filter_map(|range| hold(times, counts, &smooth, range))
        .collect()
}

/// Replaces each count by the median of it and its neighbors.
fn without_spikes(counts: &[u16]) -> Vec<f64> {
    let median = |index: usize| {
        let last = counts.len() - 1;
        let mut three = [
            counts[index.saturating_sub(1)],
            counts[index],
            counts[(index + 1).min(last)],
        ];
        three.sort_unstable();
        f64::from(three[1])
    };
    (0..counts.len()).map(median).collect()
}

fn hold(
    times: &[Timestamp],
    counts: &[u16],
    smooth: &[f64],
    mut range: Range<usize>,
) -> Option<Hold> {
    let (start, end) = (times[range.start], times[range.end - 1]);
    if end.since(start) < SHORTEST {
        return None;
    }
    while range.len() > 1 && times[range.start].since(start) < SETTLE {
        range.start += 1;
    }
    while range.len() > 1 && end.since(times[range.end - 1]) < SETTLE {
        range.end -= 1;
    }
    if counts[range.clone()].contains(&Channels::UNKNOWN) {
        return None;
    }
    let (squares, degrees) = jitter(&times[range.clone()], &counts[range.clone()]);
    let middle = times[range.start].0.midpoint(times[range.end - 1].0) as f64;
    Some(Hold {
        minute: middle / 60e6,
        mean: smooth[range.clone()].iter().sum::<f64>() / range.len() as f64,
        squares,
        degrees,
    })
}

/// Returns the sum of squared deviations from the means of the windows of a hold, and its degrees of freedom.
fn jitter(times: &[Timestamp], counts: &[u16]) -> (f64, usize) {
    let (mut squares, mut degrees, mut start) = (0.0, 0, 0);
    while start < times.len() {
        let window = times[start..].partition_point(|time| time.since(times[start]) < WINDOW);
        let values = &counts[start..start + window];
        let mean = values.iter().map(|&count| f64::from(count)).sum::<f64>() / window as f64;
        let deviations = values
            .iter()
            .map(|&count| (f64::from(count) - mean).powi(2));
        squares += deviations.sum::<f64>();
        degrees += window - 1;
        start += window;
    }
    (squares, degrees)
}

/// Cumulative sums of values and of their squared differences, from which the sums of any window follow.
struct Sums {
    values: Vec<f64>,
    differences: Vec<f64>,
}

impl Sums {
    fn new(values: &[f64]) -> Self {
        let (mut sum, mut squares) = (0.0, 0.0);
        let mut sums = Self {
            values: vec![0.0],
            differences: vec![0.0],
        };
        for (index, value) in values.iter().enumerate() {
            sum += value;
            squares += (value - values[index.saturating_sub(1)]).powi(2);
            sums.values.push(sum);
            sums.differences.push(squares);
        }
        sums
    }

    /// Returns `true` if the means of both halves of a window agree within the noise or a limit.
    fn is_still(&self, window: Range<usize>, limit: f64) -> bool {
        if window.len() < MIN_READINGS {
            return false;
        }
        let middle = window.start + window.len() / 2;
        let mean = |range: Range<usize>| {
            (self.values[range.end] - self.values[range.start]) / range.len() as f64
        };
        let change = (mean(window.start..middle) - mean(middle..window.end)).abs();
        // The variance of a difference of neighbors is twice the variance of white noise.
        let squares = self.differences[window.end] - self.differences[window.start + 1];
        let noise = (squares.max(0.0) / (2.0 * (window.len() - 1) as f64)).sqrt();
        let error = 4.0 * noise * (2.0 / (window.len() / 2) as f64).sqrt();
        change <= error.max(limit)
    }
}

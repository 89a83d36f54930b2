//! The latency of the session: time from the arrival of a reading to the call of the output.

use std::time::Duration;

use hdrhistogram::Histogram;

/// The latencies of the steps with events that Studio has received.
#[derive(Clone)]
pub struct LatencyLog {
    microseconds: Histogram<u64>,
}

/// Percentiles of the latency, in microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatencyPercentiles {
    /// The median.
    pub p50: u64,
    /// Reached by one step of 100.
    pub p99: u64,
    /// The largest.
    pub max: u64,
}

impl Default for LatencyLog {
    fn default() -> Self {
        let microseconds = Histogram::new_with_bounds(1, 60_000_000, 2);
        Self {
            microseconds: microseconds.expect("the bounds are valid"),
        }
    }
}

impl LatencyLog {
    /// Adds the latency of a step.
    pub fn push(&mut self, latency: Duration) {
        let micros = u64::try_from(latency.as_micros()).unwrap_or(u64::MAX);
        self.microseconds.saturating_record(micros);
    }

    /// Returns the percentiles, or `None` before the first event.
    pub fn percentiles(&self) -> Option<LatencyPercentiles> {
        (!self.microseconds.is_empty()).then(|| LatencyPercentiles {
            p50: self.microseconds.value_at_quantile(0.5),
            p99: self.microseconds.value_at_quantile(0.99),
            max: self.microseconds.max(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_steps() {
        let mut log = LatencyLog::default();
        assert_eq!(log.percentiles(), None);
        (1..=100).for_each(|micros| log.push(Duration::from_micros(micros)));
        let percentiles = log.percentiles().unwrap();
        assert_eq!(
            (percentiles.p50, percentiles.p99, percentiles.max),
            (50, 99, 100)
        );
    }
}

//! The 1-Euro filter: a low-pass whose cutoff rises with speed.

use std::f64::consts::TAU;

/// What the filter is tuned by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneEuroSettings {
    /// Cutoff at rest, in Hz; more than 0. Lower: less jitter, more lag at rest.
    pub min_cutoff_hz: f64,
    /// How much the cutoff rises with speed, in Hz per unit/s; 0 or more. Higher: less lag in motion.
    pub beta: f64,
    /// Cutoff of the speed itself, in Hz; more than 0.
    pub derivative_cutoff_hz: f64,
}

/// Filters values that come together, each by itself.
///
/// The reference form of August 2023 (github.com/casiez/OneEuroFilter): the derivative is taken
/// against the last *filtered* value, and is 0 for the first sample.
#[derive(Clone, Debug)]
pub struct OneEuroFilter {
    settings: OneEuroSettings,
    has_begun: bool,
    values: Vec<f64>,
    speeds: Vec<f64>,
}

impl OneEuroFilter {
    /// A filter for so many values that has seen none yet.
    pub fn new(settings: OneEuroSettings, values: usize) -> Self {
        Self {
            settings,
            has_begun: false,
            values: vec![0.0; values],
            speeds: vec![0.0; values],
        }
    }

    /// Forgets what it has seen: the next values come out as they are.
    pub fn reset(&mut self) {
        self.has_begun = false;
    }

    /// Filters `values` in place; they came `seconds` after those before.
    ///
    /// The first values come out as they are. No time gone by: the last filtered values again.
    /// Values beyond the number that the filter was made for stay as they are.
    pub fn filter(&mut self, values: &mut [f64], seconds: f64) {
        if !self.has_begun {
            self.begin(values);
        } else if seconds > 0.0 {
            self.follow(values, seconds);
        }
        for (value, filtered) in values.iter_mut().zip(&self.values) {
            *value = *filtered;
        }
    }

    fn begin(&mut self, values: &[f64]) {
        self.has_begun = true;
        self.speeds.fill(0.0);
        for (filtered, value) in self.values.iter_mut().zip(values) {
            *filtered = *value;
        }
    }

    fn follow(&mut self, values: &[f64], seconds: f64) {
        let OneEuroSettings {
            min_cutoff_hz,
            beta,
            derivative_cutoff_hz,
        } = self.settings;
        let rate = 1.0 / seconds;
        let speed_share = share(derivative_cutoff_hz, seconds);
        let state = self.values.iter_mut().zip(&mut self.speeds);
        for ((filtered, speed), value) in state.zip(values) {
            let change = value - *filtered;
            *speed += speed_share * (change * rate - *speed);
            *filtered += share(min_cutoff_hz + beta * speed.abs(), seconds) * change;
        }
    }
}

/// How far one step of a first-order low-pass goes: α = 1 / (1 + τ / Δt) with τ = 1 / (2π cutoff),
/// written with a single division.
fn share(cutoff_hz: f64, seconds: f64) -> f64 {
    1.0 - 1.0 / (1.0 + TAU * cutoff_hz * seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn next(filter: &mut OneEuroFilter, value: f64, seconds: f64) -> f64 {
        let mut values = [value];
        filter.filter(&mut values, seconds);
        values[0]
    }

    #[test]
    fn a_constant_stays_and_a_step_is_approached_without_overshoot() {
        let settings = OneEuroSettings {
            min_cutoff_hz: 1.0,
            beta: 0.5,
            derivative_cutoff_hz: 1.0,
        };
        let mut filter = OneEuroFilter::new(settings, 1);
        assert_eq!(next(&mut filter, 2.0, 0.0), 2.0);
        assert_eq!(next(&mut filter, 2.0, 0.01), 2.0);
        let mut last = 2.0;
        for _ in 0..500 {
            let value = next(&mut filter, 3.0, 0.01);
            assert!(value > last || value > 2.999 && value <= 3.0, "{value}");
            last = value;
        }
        assert!(last > 2.99);
    }

    #[test]
    fn no_time_gone_by_changes_nothing() {
        let settings = OneEuroSettings {
            min_cutoff_hz: 1.0,
            beta: 0.0,
            derivative_cutoff_hz: 1.0,
        };
        let mut filter = OneEuroFilter::new(settings, 1);
        next(&mut filter, 1.0, 0.0);
        assert_eq!(next(&mut filter, 9.0, 0.0), 1.0);
    }

    #[test]
    fn values_that_come_together_do_not_mix_and_a_reset_forgets_all() {
        let settings = OneEuroSettings {
            min_cutoff_hz: 1.0,
            beta: 0.5,
            derivative_cutoff_hz: 1.0,
        };
        let mut both = OneEuroFilter::new(settings, 2);
        let mut alone = OneEuroFilter::new(settings, 1);
        for step in 0..20 {
            let mut values = [f64::from(step), -1.0];
            both.filter(&mut values, 0.01);
            assert_eq!(values, [next(&mut alone, f64::from(step), 0.01), -1.0]);
        }
        both.reset();
        let mut values = [5.0, 6.0];
        both.filter(&mut values, 0.01);
        assert_eq!(values, [5.0, 6.0]);
    }
}

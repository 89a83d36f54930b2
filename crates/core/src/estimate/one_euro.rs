//! The 1-Euro filter: a low-pass filter whose cutoff frequency rises with speed.

use std::f64::consts::TAU;

/// Parameters of a [`OneEuroFilter`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneEuroSettings {
    /// Cutoff at rest, in Hz; more than 0. Lower: less jitter, more lag at rest.
    pub min_cutoff_hz: f64,
    /// Rise of the cutoff with speed, in Hz per unit/s; 0 or more. Higher: less lag in motion.
    pub beta: f64,
    /// Cutoff of the speed itself, in Hz; more than 0.
    pub derivative_cutoff_hz: f64,
}

/// A bank of 1-Euro filters, one for each of a fixed number of values that are sampled together.
///
/// Follows the reference implementation of August 2023 (github.com/casiez/OneEuroFilter): the derivative is taken
/// against the last *filtered* value, and is 0 for the first sample.
// Aligned to vector registers, as joint angles are.
#[derive(Clone, Debug)]
#[repr(C, align(16))]
pub struct OneEuroFilter<const COUNT: usize> {
    values: [f64; COUNT],
    speeds: [f64; COUNT],
    settings: OneEuroSettings,
    has_samples: bool,
}

impl<const COUNT: usize> OneEuroFilter<COUNT> {
    /// Creates a filter for `COUNT` values.
    pub fn new(settings: OneEuroSettings) -> Self {
        Self {
            values: [0.0; COUNT],
            speeds: [0.0; COUNT],
            settings,
            has_samples: false,
        }
    }

    /// Clears the state: the next values pass unchanged.
    pub fn reset(&mut self) {
        self.has_samples = false;
    }

    /// Filters `values` in place, sampled `seconds` after the previous ones.
    ///
    /// The first values pass unchanged. If `seconds` is 0, returns the last filtered values.
    pub fn filter(&mut self, values: &mut [f64; COUNT], seconds: f64) {
        if !self.has_samples {
            self.has_samples = true;
            self.speeds = [0.0; COUNT];
            self.values = *values;
        } else if seconds > 0.0 {
            self.advance(values, seconds);
        } else {
            *values = self.values;
        }
    }

    fn advance(&mut self, values: &mut [f64; COUNT], seconds: f64) {
        let OneEuroSettings {
            min_cutoff_hz,
            beta,
            derivative_cutoff_hz,
        } = self.settings;
        let rate = 1.0 / seconds;
        let speed_alpha = smoothing_factor(derivative_cutoff_hz, seconds);
        let state = self.values.iter_mut().zip(&mut self.speeds);
        for ((filtered, speed), value) in state.zip(values) {
            let change = *value - *filtered;
            *speed += speed_alpha * (change * rate - *speed);
            *filtered += smoothing_factor(min_cutoff_hz + beta * speed.abs(), seconds) * change;
            *value = *filtered;
        }
    }
}

/// Returns α of a first-order low-pass filter: α = 1 / (1 + τ / Δt) with τ = 1 / (2π cutoff), written with a single
/// division.
fn smoothing_factor(cutoff_hz: f64, seconds: f64) -> f64 {
    1.0 - 1.0 / (1.0 + TAU * cutoff_hz * seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: OneEuroSettings = OneEuroSettings {
        min_cutoff_hz: 1.0,
        beta: 0.5,
        derivative_cutoff_hz: 1.0,
    };

    fn next(filter: &mut OneEuroFilter<1>, value: f64, seconds: f64) -> f64 {
        let mut values = [value];
        filter.filter(&mut values, seconds);
        values[0]
    }

    #[test]
    fn a_constant_is_unchanged_and_a_step_is_approached_without_overshoot() {
        let mut filter = OneEuroFilter::new(SETTINGS);
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
    fn a_sample_without_elapsed_time_changes_nothing() {
        let settings = OneEuroSettings {
            beta: 0.0,
            ..SETTINGS
        };
        let mut filter = OneEuroFilter::new(settings);
        next(&mut filter, 1.0, 0.0);
        assert_eq!(next(&mut filter, 9.0, 0.0), 1.0);
    }

    #[test]
    fn values_are_filtered_independently_and_a_reset_clears_them() {
        let mut pair = OneEuroFilter::new(SETTINGS);
        let mut single = OneEuroFilter::new(SETTINGS);
        for step in 0..20 {
            let mut values = [f64::from(step), -1.0];
            pair.filter(&mut values, 0.01);
            assert_eq!(values, [next(&mut single, f64::from(step), 0.01), -1.0]);
        }
        pair.reset();
        let mut values = [5.0, 6.0];
        pair.filter(&mut values, 0.01);
        assert_eq!(values, [5.0, 6.0]);
    }
}

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

/// One filtered value.
///
/// The reference form of August 2023 (github.com/casiez/OneEuroFilter): the derivative is taken
/// against the last *filtered* value, and is 0 for the first sample.
#[derive(Clone, Copy, Debug)]
pub struct OneEuro {
    settings: OneEuroSettings,
    state: Option<State>,
}

#[derive(Clone, Copy, Debug)]
struct State {
    value: f64,
    speed: f64,
}

impl OneEuro {
    /// A filter that has seen nothing yet.
    pub fn new(settings: OneEuroSettings) -> Self {
        Self {
            settings,
            state: None,
        }
    }

    /// Forgets what it has seen: the next value comes out as it is.
    pub fn reset(&mut self) {
        self.state = None;
    }

    /// The filtered value of `value`, which came `seconds` after the one before.
    ///
    /// The first value comes out as it is. No time gone by: the last filtered value again.
    pub fn filter(&mut self, value: f64, seconds: f64) -> f64 {
        let Some(last) = self.state else {
            self.state = Some(State { value, speed: 0.0 });
            return value;
        };
        if seconds <= 0.0 {
            return last.value;
        }
        let slope = (value - last.value) / seconds;
        let speed = blend(
            last.speed,
            slope,
            self.settings.derivative_cutoff_hz,
            seconds,
        );
        let cutoff_hz = self.settings.min_cutoff_hz + self.settings.beta * speed.abs();
        let value = blend(last.value, value, cutoff_hz, seconds);
        self.state = Some(State { value, speed });
        value
    }
}

/// One step of a first-order low-pass: α = 1 / (1 + τ / Δt) with τ = 1 / (2π cutoff).
fn blend(last: f64, new: f64, cutoff_hz: f64, seconds: f64) -> f64 {
    let alpha = 1.0 / (1.0 + 1.0 / (TAU * cutoff_hz * seconds));
    last + alpha * (new - last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_stays_and_a_step_is_approached_without_overshoot() {
        let mut filter = OneEuro::new(OneEuroSettings {
            min_cutoff_hz: 1.0,
            beta: 0.5,
            derivative_cutoff_hz: 1.0,
        });
        assert_eq!(filter.filter(2.0, 0.0), 2.0);
        assert_eq!(filter.filter(2.0, 0.01), 2.0);
        let mut last = 2.0;
        for _ in 0..500 {
            let value = filter.filter(3.0, 0.01);
            assert!(value > last || value > 2.999 && value <= 3.0, "{value}");
            last = value;
        }
        assert!(last > 2.99);
    }

    #[test]
    fn no_time_gone_by_changes_nothing() {
        let mut filter = OneEuro::new(OneEuroSettings {
            min_cutoff_hz: 1.0,
            beta: 0.0,
            derivative_cutoff_hz: 1.0,
        });
        filter.filter(1.0, 0.0);
        assert_eq!(filter.filter(9.0, 0.0), 1.0);
    }
}

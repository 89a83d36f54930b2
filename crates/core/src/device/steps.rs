//! Quantised control values.

/// Distance past the midpoint between two steps at which a value changes step, as a fraction of a step.
/// Hand tremor at the midpoint then does not make the value alternate.
const HYSTERESIS: f32 = 0.1;

/// Values closer together than this differ by rounding only.
const ROUNDING: f32 = 1e-6;

/// Returns the new value of a control that stands at `current` and is moved to `value`, 0..=1 unless the
/// control is endless.
///
/// With `steps` intervals the value snaps to one of `steps` + 1 positions, with hysteresis. Without, it is
/// continuous, and differences by rounding are ignored except at the ends.
pub(super) fn snap(value: f32, steps: Option<u16>, current: f32) -> f32 {
    let Some(steps) = steps.map(f32::from) else {
        let is_end = value == 0.0 || value == 1.0;
        return if (value - current).abs() < ROUNDING && !is_end {
            current
        } else {
            value
        };
    };
    if (value - current).abs() * steps <= 0.5 + HYSTERESIS {
        return current;
    }
    (value * steps).round() / steps
}

/// Returns the step nearest to a value, or the value itself if there are no steps.
pub(super) fn nearest_step(value: f32, steps: Option<u16>) -> f32 {
    match steps.map(f32::from) {
        Some(steps) => (value * steps).round() / steps,
        None => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_near_the_midpoint_keeps_its_step() {
        for (value, current, expected) in [
            (0.50, 0.25, 0.5),
            (0.39, 0.25, 0.25),
            (0.41, 0.25, 0.5),
            (0.36, 0.50, 0.5),
            (0.34, 0.50, 0.25),
            (1.0, 0.0, 1.0),
        ] {
            assert_eq!(
                snap(value, Some(4), current),
                expected,
                "{current} to {value}"
            );
        }
        assert_eq!(nearest_step(0.3, Some(4)), 0.25);
    }

    #[test]
    fn a_continuous_value_ignores_rounding_and_reaches_its_ends_exactly() {
        assert_eq!(snap(0.5 + 1e-7, None, 0.5), 0.5);
        assert_eq!(snap(0.501, None, 0.5), 0.501);
        assert_eq!(snap(0.0, None, 1e-7), 0.0);
    }
}

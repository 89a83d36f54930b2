//! Values that stand on steps.

/// How far past the middle between two steps a value has to be, as a share of a step, before it goes over:
/// so that a tremble there does not go back and forth.
const HYSTERESIS: f32 = 0.1;

/// Two values nearer together than this are the same but for rounding.
const ROUNDING: f32 = 1e-6;

/// Where a control stands that is moved to `value` (0..=1 where it has ends) and stood at `now`, on one of
/// `steps` + 1 places of that range, or anywhere when it has no steps.
pub(super) fn step_to(value: f32, steps: Option<u16>, now: f32) -> f32 {
    let Some(steps) = steps.map(f32::from) else {
        let is_end = value == 0.0 || value == 1.0;
        return if (value - now).abs() < ROUNDING && !is_end {
            now
        } else {
            value
        };
    };
    if (value - now).abs() * steps <= 0.5 + HYSTERESIS {
        return now;
    }
    (value * steps).round() / steps
}

/// The step that is nearest to a value.
pub(super) fn nearest(value: f32, steps: Option<u16>) -> f32 {
    match steps.map(f32::from) {
        Some(steps) => (value * steps).round() / steps,
        None => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_between_two_steps_stays_on_the_one_where_it_is() {
        for (value, now, expected) in [
            (0.50, 0.25, 0.5),
            (0.39, 0.25, 0.25),
            (0.41, 0.25, 0.5),
            (0.36, 0.50, 0.5),
            (0.34, 0.50, 0.25),
            (1.0, 0.0, 1.0),
        ] {
            assert_eq!(step_to(value, Some(4), now), expected, "{now} to {value}");
        }
        assert_eq!(nearest(0.3, Some(4)), 0.25);
    }

    #[test]
    fn without_steps_only_rounding_is_no_move_and_the_ends_are_exact() {
        assert_eq!(step_to(0.5 + 1e-7, None, 0.5), 0.5);
        assert_eq!(step_to(0.501, None, 0.5), 0.501);
        assert_eq!(step_to(0.0, None, 1e-7), 0.0);
    }
}

//! The bend of an arc or cylinder, drawn over its unrolled rows, with a handle that sets the radius.

use parry3d::math::Vec2;

/// Range of the radius, in millimetres: the range of the file format.
pub const RADII: (f32, f32) = (20.0, 2000.0);

/// The largest angle to each side that is drawn, in radians: three quarters of a turn in all.
const MAX_ANGLE: f32 = 2.35;

/// Returns the position on the bent row through (0, 0) at a distance along it, in millimetres.
pub fn bent(radius: f32, along: f32) -> Vec2 {
    let (sin, cos) = (along / radius).sin_cos();
    Vec2::new(radius * sin, radius * (cos - 1.0))
}

/// Returns the bent row through (0, 0) to both sides up to a distance along it, as a line of points.
pub fn curve(radius: f32, half_width: f32) -> Vec<Vec2> {
    const STEPS: i16 = 24;
    let reach = half_width.min(radius * MAX_ANGLE);
    let steps = -STEPS..=STEPS;
    steps
        .map(|step| bent(radius, reach * f32::from(step) / f32::from(STEPS)))
        .collect()
}

/// Returns the radius with which the end of the bent row is `drop` millimetres nearer to the wearer than its middle.
pub fn radius_for_drop(half_width: f32, drop: f32) -> f32 {
    let drop_of = |radius: f32| {
        let reach = half_width.min(radius * MAX_ANGLE);
        -bent(radius, reach).y
    };
    // Bisection: the drop shrinks as the radius grows, from the radius with the largest angle on.
    let (mut small, mut large) = ((half_width / MAX_ANGLE).clamp(RADII.0, RADII.1), RADII.1);
    for _ in 0..40 {
        let middle = (small + large) / 2.0;
        if drop_of(middle) > drop {
            small = middle
        } else {
            large = middle
        }
    }
    (small + large) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_handle_sets_the_radius_that_draws_it_there() {
        for radius in [60.0, 320.0, 900.0] {
            let drop = -bent(radius, 110.0).y;
            let found = radius_for_drop(110.0, drop);
            assert!((found / radius - 1.0).abs() < 0.01, "{radius}: {found}");
        }
    }

    #[test]
    fn the_radius_stays_in_its_range() {
        assert!(radius_for_drop(100.0, -50.0) >= RADII.1 - 1.0);
        assert!(radius_for_drop(10.0, 1e6) <= RADII.0 + 1.0);
    }

    #[test]
    fn the_curve_is_as_long_as_the_row() {
        let curve = curve(320.0, 100.0);
        let length: f32 = curve.windows(2).map(|it| (it[1] - it[0]).length()).sum();
        assert!((length - 200.0).abs() < 0.1);
    }
}

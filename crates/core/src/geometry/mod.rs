//! Directions and rotations in three dimensions, in `f64`: column vectors, right-handed frames.

mod euler;
mod rotation_between;

pub use euler::EulerOrder;
pub use rotation_between::rotation_between;

use glam::DVec3;

/// Returns the direction of `vector`; `None` if it is zero or not finite. Its length may have any magnitude.
pub fn unit(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    if !vector.is_finite() || largest == 0.0 {
        return None;
    }
    // Squares of very small and very large components would vanish or overflow.
    Some((vector / largest).normalize())
}

/// Returns the angle between two directions in radians, 0..=π; 0 if one is zero. The lengths do not matter.
pub fn angle_between(first: DVec3, second: DVec3) -> f64 {
    let (first, second) = (of_moderate_length(first), of_moderate_length(second));
    // Without the sum, the product of a zero and a direction may be −0, which stands for half a turn.
    let product = first.dot(second) + 0.0;
    first.cross(second).length().atan2(product)
}

/// Returns a vector of the same direction whose products with others neither vanish nor overflow; the vector itself if its length
/// permits, so that its angles do not change by rounding.
fn of_moderate_length(vector: DVec3) -> DVec3 {
    let largest = vector.abs().max_element();
    if largest == 0.0 || (1e-60..=1e60).contains(&largest) {
        vector
    } else {
        vector / largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_of_any_magnitude_has_a_direction_unless_it_is_zero_or_not_finite() {
        for length in [5e-324, 1e-200, 1.0, 1e200, f64::MAX] {
            assert_eq!(unit(DVec3::NEG_Y * length), Some(DVec3::NEG_Y), "{length}");
        }
        for invalid in [0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(unit(DVec3::X * invalid), None);
        }
    }

    #[test]
    fn an_angle_does_not_depend_on_the_lengths() {
        let (first, second) = (DVec3::new(1.0, 0.25, 0.0), DVec3::new(-2.0, 1.0, 0.5));
        let angle = 2.405_292_966_501_765;
        for length in [1e-300, 1e-120, 1.0, 1e120, 1e300] {
            for other in [1e-300, 1.0, 1e300] {
                let found = angle_between(first * length, second * other);
                assert!((found - angle).abs() < 1e-12, "{length} {other}: {found}");
            }
        }
        for direction in [DVec3::X, DVec3::NEG_ONE] {
            assert_eq!(angle_between(DVec3::ZERO, direction), 0.0);
        }
        assert!(angle_between(DVec3::X, DVec3::NAN).is_nan());
    }

    #[test]
    fn angles_close_to_zero_and_to_half_a_turn_are_exact() {
        let turned = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0);
        for angle in [1e-12, 0.5, 3.0] {
            let difference = angle_between(DVec3::X, turned(angle)) - angle;
            assert!(difference.abs() < 1e-15, "{angle}: {difference:e}");
        }
    }
}

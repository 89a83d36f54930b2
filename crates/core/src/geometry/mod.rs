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

/// Returns the angle between two directions in radians, 0..=π. The lengths do not matter.
pub fn angle_between(first: DVec3, second: DVec3) -> f64 {
    first.cross(second).length().atan2(first.dot(second))
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
    fn angles_close_to_zero_and_to_half_a_turn_are_exact() {
        let turned = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0);
        for angle in [1e-12, 0.5, 3.0] {
            let difference = angle_between(DVec3::X, turned(angle)) - angle;
            assert!(difference.abs() < 1e-15, "{angle}: {difference:e}");
        }
    }
}

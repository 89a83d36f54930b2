//! The rotation that takes one direction onto another.

use glam::{DMat3, DVec3};

use super::unit;

/// The largest sine of an angle that counts as 0 or half a turn: its axis is lost in rounding.
const MIN_SINE: f64 = 1e-9;

/// Returns the rotation without twist that takes the direction of `from` onto the direction of `to`; `None` if a vector is zero
/// or not finite. The lengths do not matter.
///
/// Rodrigues' formula R = I + s K + (1 − c) K², with s and c the sine and cosine of the angle and K the cross-product
/// matrix of the axis. Parallel directions give the identity. For opposite directions the axis is perpendicular to
/// `from` and to the coordinate axis that is furthest from it, the first one on a tie.
pub fn rotation_between(from: DVec3, to: DVec3) -> Option<DMat3> {
    let (from, to) = (unit(from)?, unit(to)?);
    let (cross, cosine) = (from.cross(to), from.dot(to));
    let sine = cross.length();
    if sine >= MIN_SINE {
        // Next to half a turn, rounding tilts the axis towards `from`.
        let axis = cross - from * cross.dot(from);
        return Some(rotation(axis.normalize(), sine, cosine));
    }
    Some(if cosine > 0.0 {
        DMat3::IDENTITY
    } else {
        half_turn(from.cross(furthest_axis(from)).normalize())
    })
}

/// Returns the rotation about a unit axis by an angle with this sine and cosine.
fn rotation(axis: DVec3, sine: f64, cosine: f64) -> DMat3 {
    let cross_product = DMat3::from_cols(
        DVec3::new(0.0, axis.z, -axis.y),
        DVec3::new(-axis.z, 0.0, axis.x),
        DVec3::new(axis.y, -axis.x, 0.0),
    );
    DMat3::IDENTITY + cross_product * sine + cross_product * cross_product * (1.0 - cosine)
}

/// Returns the rotation by half a turn about a unit axis: 2 k kᵀ − I.
fn half_turn(axis: DVec3) -> DMat3 {
    let outer = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
    outer * 2.0 - DMat3::IDENTITY
}

/// Returns the coordinate axis on which `direction` has its smallest component, the first one on a tie.
fn furthest_axis(direction: DVec3) -> DVec3 {
    let sizes = direction.abs();
    if sizes.x <= sizes.y && sizes.x <= sizes.z {
        DVec3::X
    } else if sizes.y <= sizes.z {
        DVec3::Y
    } else {
        DVec3::Z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_of_directions_gives_a_rotation_onto_the_second() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut direction = || DVec3::from_array(std::array::from_fn(|_| random.f64() - 0.5));
        for round in 0..2_000 {
            let from = direction();
            let to = match round % 4 {
                0 => -from,
                1 => from * 3.0,
                2 => -from + direction() * 1e-7,
                _ => direction(),
            };
            let rotation = rotation_between(from, to).expect("two directions");
            let error = (rotation * from.normalize() - to.normalize()).length();
            assert!(error < 1e-8, "{from} to {to}: {error:e}");
            assert!((rotation.determinant() - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn zero_vectors_and_values_that_are_not_finite_are_refused() {
        for invalid in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
            assert_eq!(rotation_between(invalid, DVec3::X), None);
            assert_eq!(rotation_between(DVec3::X, invalid), None);
        }
    }
}

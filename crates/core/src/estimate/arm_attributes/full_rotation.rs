//! The greatest rotation of an upper arm about its own axis, from which the rotation of a shoulder is measured.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec3;

use super::bases::{sided_cross, sign};
use crate::geometry::unit;
use crate::hand::Side;

/// An upper arm that is turned as far as it goes, with its elbow at a right angle, in the basis of its shoulder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullRotation {
    /// The angle of the forearm from the auxiliary vector about the upper arm, in radians.
    pub psi: f64,
    /// The unit direction of the forearm.
    pub forearm: DVec3,
    /// The unit normal of the plane of the arm: upper arm × forearm.
    pub normal: DVec3,
}

impl FullRotation {
    /// Returns the full rotation of an upper arm with this direction in the basis of its shoulder; `None` if the
    /// direction is zero or not finite.
    ///
    /// Hanging down, the forearm points forwards and 45° outwards; held horizontally and not backwards, it points up;
    /// held up, it points backwards. The angle jumps where an upper arm that points inwards crosses the plane of the
    /// trunk.
    pub fn new(side: Side, upper_arm: DVec3) -> Option<Self> {
        let upper_arm = unit(upper_arm)?;
        let auxiliary = auxiliary(side, upper_arm);
        // The third axis points backwards for the left arm and forwards for the right.
        let psi = psi(DVec3::new(
            upper_arm.x,
            upper_arm.y,
            upper_arm.z * sign(side),
        ));
        let across = sided_cross(side, auxiliary, upper_arm);
        let forearm = auxiliary * psi.cos() + across * psi.sin();
        Some(Self {
            psi,
            forearm,
            // Close to the poles the forearm is not quite at a right angle.
            normal: unit(upper_arm.cross(forearm))?,
        })
    }
}

/// Returns the direction of a forearm at a right angle to the upper arm, with the same horizontal heading.
fn auxiliary(side: Side, upper_arm: DVec3) -> DVec3 {
    let DVec3 { x, y, z } = upper_arm;
    if is_close(y, 0.0) {
        DVec3::NEG_Y
    } else if is_close(y, 1.0) {
        DVec3::NEG_Z * sign(side)
    } else if is_close(y, -1.0) {
        DVec3::Z * sign(side)
    } else {
        DVec3::new(x, y - 1.0 / y, z).normalize() * y.signum()
    }
}

/// Returns the angle of the forearm for an upper arm with a third axis that points backwards.
fn psi(upper_arm: DVec3) -> f64 {
    let DVec3 { x, y, z } = upper_arm;
    if is_close(y, 1.0) {
        return FRAC_PI_4;
    }
    if is_close(y, -1.0) {
        return 0.0;
    }
    let colatitude = colatitude(y);
    let azimuth = azimuth(x, z);
    // From −1 hanging down through 0 at the horizontal to 1.
    let elevation = 2.0 * colatitude / PI - 1.0;
    match (z <= 0.0, y >= 0.0) {
        (true, true) => (azimuth + FRAC_PI_4) * elevation,
        (true, false) => (azimuth + FRAC_PI_2) * elevation,
        (false, true) => -azimuth - FRAC_PI_4 + colatitude / 2.0,
        (false, false) => -azimuth + (2.0 * azimuth + FRAC_PI_2) * elevation,
    }
}

/// Returns the angle of (x, y) from the x axis in radians, −π..π; 0 at the origin and −π on the negative x axis.
pub(super) fn azimuth(x: f64, y: f64) -> f64 {
    if x == 0.0 && y == 0.0 {
        return 0.0;
    }
    let angle = y.atan2(x);
    if angle == PI { -PI } else { angle }
}

/// Returns the angle of a unit vector from an axis on which it has the component `along`, 0..=π.
fn colatitude(along: f64) -> f64 {
    along.clamp(-1.0, 1.0).acos()
}

/// Returns `true` if `value` counts as equal to `reference`: within 1e-8 + 1e-5 · |reference|.
pub(super) fn is_close(value: f64, reference: f64) -> bool {
    (value - reference).abs() <= 1e-8 + 1e-5 * reference.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_right_arm_is_the_mirror_image_of_the_left() {
        let mut random = fastrand::Rng::with_seed(11);
        for _ in 0..1_000 {
            let left = DVec3::from_array(std::array::from_fn(|_| random.f64() - 0.5));
            let mirrored = |v: DVec3| DVec3::new(v.x, v.y, -v.z);
            let on_left = FullRotation::new(Side::Left, left).expect("a direction");
            let on_right = FullRotation::new(Side::Right, mirrored(left)).expect("a direction");
            assert_eq!(on_left.psi, on_right.psi);
            assert!(on_right.forearm.distance(mirrored(on_left.forearm)) < 1e-12);
            // A mirror reverses the sense of rotation, so the normal has the other two components reversed.
            assert!(on_right.normal.distance(-mirrored(on_left.normal)) < 1e-12);
        }
    }

    #[test]
    fn the_normal_has_unit_length_next_to_the_poles_too() {
        for pole in [DVec3::Y, DVec3::NEG_Y] {
            for offset in [0.0, 1e-9, 1e-5, 1e-3, 4e-3, 5e-3] {
                for &side in Side::ALL {
                    let upper_arm = (pole + DVec3::new(offset, 0.0, offset)).normalize();
                    let full = FullRotation::new(side, upper_arm).expect("a direction");
                    assert!((full.normal.length() - 1.0).abs() < 1e-12);
                    assert!(full.normal.dot(upper_arm).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_direction_that_is_zero_or_not_finite_is_refused() {
        for invalid in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
            assert_eq!(FullRotation::new(Side::Left, invalid), None);
        }
    }

    #[test]
    fn the_azimuth_is_negative_on_the_negative_axis_and_zero_at_the_origin() {
        assert_eq!(azimuth(-1.0, 0.0), -PI);
        assert_eq!(azimuth(-1.0, -0.0), -PI);
        assert_eq!(azimuth(-0.0, 0.0), 0.0);
        assert_eq!(azimuth(0.0, 1.0), FRAC_PI_2);
    }
}

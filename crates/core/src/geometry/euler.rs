//! Euler angles of a rotation about three different axes.

use glam::{DMat3, DVec3};

use crate::names::named_enum;

/// The cosine of the middle angle below which the first and the last angle cannot be told apart.
const GIMBAL_COSINE: f64 = 1e-6;

named_enum! {
    /// The order of the axes of three Euler angles. `ZXY` stands for R = Rz · Rx · Ry: the last rotation acts first.
    pub enum EulerOrder ("order of Euler angles") {
        /// R = Rx · Ry · Rz.
        Xyz = "XYZ",
        /// R = Rx · Rz · Ry.
        Xzy = "XZY",
        /// R = Ry · Rx · Rz.
        Yxz = "YXZ",
        /// R = Ry · Rz · Rx.
        Yzx = "YZX",
        /// R = Rz · Rx · Ry.
        Zxy = "ZXY",
        /// R = Rz · Ry · Rx.
        Zyx = "ZYX",
    }
}

impl EulerOrder {
    /// Returns the angles of a rotation in radians, in this order; `None` if the matrix is not finite.
    ///
    /// The middle angle is in [−π/2, π/2], the others are in (−π, π]. If the middle angle is ±π/2, only the sum or the
    /// difference of the others is determined (gimbal lock): the last one is 0.
    pub fn angles(self, rotation: &DMat3) -> Option<[f64; 3]> {
        if !rotation.is_finite() {
            return None;
        }
        let [i, j, k] = self.axes();
        let sign = self.sign();
        let at = |row: usize, column: usize| rotation.col(column)[row];
        let cosine = at(i, i).hypot(at(i, j));
        let middle = (sign * at(i, k)).atan2(cosine);
        if cosine < GIMBAL_COSINE {
            return Some([angle(sign * at(k, j), at(j, j)), middle, 0.0]);
        }
        let first = angle(-sign * at(j, k), at(k, k));
        let last = angle(-sign * at(i, j), at(i, i));
        Some([first, middle, last])
    }

    /// Returns the rotation with these angles (radians), in this order.
    pub fn rotation(self, angles: [f64; 3]) -> DMat3 {
        let [first, middle, last] = self.axes();
        about(first, angles[0]) * about(middle, angles[1]) * about(last, angles[2])
    }

    /// Returns the indices of the axes: 0 for X, 1 for Y, 2 for Z.
    const fn axes(self) -> [usize; 3] {
        match self {
            Self::Xyz => [0, 1, 2],
            Self::Xzy => [0, 2, 1],
            Self::Yxz => [1, 0, 2],
            Self::Yzx => [1, 2, 0],
            Self::Zxy => [2, 0, 1],
            Self::Zyx => [2, 1, 0],
        }
    }

    /// Returns 1 for a cyclic order of the axes, −1 for the others.
    const fn sign(self) -> f64 {
        match self {
            Self::Xyz | Self::Yzx | Self::Zxy => 1.0,
            Self::Xzy | Self::Yxz | Self::Zyx => -1.0,
        }
    }
}

/// Returns the angle with this sine and cosine, up to a common factor, in (−π, π].
fn angle(sine: f64, cosine: f64) -> f64 {
    // A sine of −0 would give −π.
    (sine + 0.0).atan2(cosine)
}

fn about(axis: usize, radians: f64) -> DMat3 {
    match axis {
        0 => DMat3::from_axis_angle(DVec3::X, radians),
        1 => DMat3::from_axis_angle(DVec3::Y, radians),
        _ => DMat3::from_axis_angle(DVec3::Z, radians),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    fn difference(first: &DMat3, second: &DMat3) -> f64 {
        let difference = (*first - *second).to_cols_array();
        difference.into_iter().map(f64::abs).fold(0.0, f64::max)
    }

    #[test]
    fn the_angles_of_every_order_give_the_rotation_again() {
        let mut random = fastrand::Rng::with_seed(3);
        for &order in EulerOrder::ALL {
            for round in 0..500 {
                let mut angles: [f64; 3] = std::array::from_fn(|_| (random.f64() * 2.0 - 1.0) * PI);
                if round % 5 == 0 {
                    angles[1] = FRAC_PI_2.copysign(angles[1]);
                }
                let rotation = order.rotation(angles);
                let [first, middle, last] = order.angles(&rotation).expect("finite");
                let again = order.rotation([first, middle, last]);
                assert!(difference(&rotation, &again) < 1e-9, "{order} {angles:?}");
                assert!(middle.abs() <= FRAC_PI_2, "{order} {angles:?}");
                assert!(round % 5 != 0 || last == 0.0, "{order} {angles:?}");
            }
        }
    }

    #[test]
    fn half_a_turn_has_a_positive_angle() {
        for &order in EulerOrder::ALL {
            for half_turn in [[PI, 0.0, 0.0], [0.0, 0.0, PI]] {
                let rotation = order.rotation(half_turn.map(|angle| -angle));
                let exact = DMat3::from_cols_array(&rotation.to_cols_array().map(f64::round));
                assert_eq!(order.angles(&exact), Some(half_turn), "{order}");
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_finite_has_no_angles() {
        let rotation = DMat3::from_cols(DVec3::X, DVec3::new(0.0, f64::NAN, 0.0), DVec3::Z);
        for &order in EulerOrder::ALL {
            assert_eq!(order.angles(&rotation), None);
        }
    }
}

//! Euler angles of a rotation: about three different axes, or about the first axis again.

use glam::{DMat3, DVec3};

use crate::names::named_enum;

/// The cosine of the middle angle, or the sine in a proper order, below which the first and the last angle cannot be told apart.
const GIMBAL_COSINE: f64 = 1e-6;

named_enum! {
    /// The order of the axes of three Euler angles. `ZXY` stands for R = Rz · Rx · Ry: the last rotation acts first. In the proper
    /// orders the last axis is the first one again.
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
        /// R = Rx · Ry · Rx.
        Xyx = "XYX",
        /// R = Rx · Rz · Rx.
        Xzx = "XZX",
        /// R = Ry · Rx · Ry.
        Yxy = "YXY",
        /// R = Ry · Rz · Ry.
        Yzy = "YZY",
        /// R = Rz · Rx · Rz.
        Zxz = "ZXZ",
        /// R = Rz · Ry · Rz.
        Zyz = "ZYZ",
    }
}

impl EulerOrder {
    /// Returns the angles of a rotation in radians, in this order; `None` if the matrix is not finite.
    ///
    /// The middle angle is in [−π/2, π/2], in [0, π] for a proper order, the others are in (−π, π]. If the middle angle is at an
    /// end of its range, only the sum or the difference of the others is determined (gimbal lock): the last one is 0.
    pub fn angles(self, rotation: &DMat3) -> Option<[f64; 3]> {
        if !rotation.is_finite() {
            return None;
        }
        let [i, j, k] = self.axes();
        let sign = self.sign();
        let at = |row: usize, column: usize| rotation.col(column)[row];
        if self.is_proper() {
            let sine = at(i, j).hypot(at(i, k));
            let middle = sine.atan2(at(i, i));
            if sine < GIMBAL_COSINE {
                return Some([angle(sign * at(k, j), at(j, j)), middle, 0.0]);
            }
            let first = angle(at(j, i), -sign * at(k, i));
            let last = angle(at(i, j), sign * at(i, k));
            return Some([first, middle, last]);
        }
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
        let [first, middle, last] = match self.axes() {
            [first, middle, _] if self.is_proper() => [first, middle, first],
            axes => axes,
        };
        about(first, angles[0]) * about(middle, angles[1]) * about(last, angles[2])
    }

    /// Returns `true` if the last axis is the first one again.
    pub const fn is_proper(self) -> bool {
        matches!(
            self,
            Self::Xyx | Self::Xzx | Self::Yxy | Self::Yzy | Self::Zxz | Self::Zyz
        )
    }

    /// Returns the indices of the axes: 0 for X, 1 for Y, 2 for Z. The last one of a proper order is the axis that it lacks.
    const fn axes(self) -> [usize; 3] {
        match self {
            Self::Xyz | Self::Xyx => [0, 1, 2],
            Self::Xzy | Self::Xzx => [0, 2, 1],
            Self::Yxz | Self::Yxy => [1, 0, 2],
            Self::Yzx | Self::Yzy => [1, 2, 0],
            Self::Zxy | Self::Zxz => [2, 0, 1],
            Self::Zyx | Self::Zyz => [2, 1, 0],
        }
    }

    /// Returns 1 for a cyclic order of the axes, −1 for the others.
    const fn sign(self) -> f64 {
        match self {
            Self::Xyz | Self::Yzx | Self::Zxy | Self::Xyx | Self::Yzy | Self::Zxz => 1.0,
            Self::Xzy | Self::Yxz | Self::Zyx | Self::Xzx | Self::Yxy | Self::Zyz => -1.0,
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
                let proper = order.is_proper();
                if round % 5 == 0 {
                    angles[1] = if proper {
                        [0.0, PI][round % 2]
                    } else {
                        FRAC_PI_2.copysign(angles[1])
                    };
                }
                let rotation = order.rotation(angles);
                let [first, middle, last] = order.angles(&rotation).expect("finite");
                let again = order.rotation([first, middle, last]);
                assert!(difference(&rotation, &again) < 1e-9, "{order} {angles:?}");
                let range = if proper {
                    0.0..=PI
                } else {
                    -FRAC_PI_2..=FRAC_PI_2
                };
                assert!(range.contains(&middle), "{order} {angles:?}");
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
                let expected = if order.is_proper() {
                    [PI, 0.0, 0.0]
                } else {
                    half_turn
                };
                assert_eq!(order.angles(&exact), Some(expected), "{order}");
            }
        }
    }

    #[test]
    fn proper_orders_give_the_angles_of_the_textbook() {
        // Z-X-Z as of an orbit: ascending node, inclination, argument of the periapsis.
        let (node, inclination, argument) = (0.5_f64, 1.1_f64, -2.0_f64);
        let (sin_i, cos_i) = inclination.sin_cos();
        let orbit = DMat3::from_cols(
            DVec3::new(
                node.cos() * argument.cos() - node.sin() * argument.sin() * cos_i,
                node.sin() * argument.cos() + node.cos() * argument.sin() * cos_i,
                argument.sin() * sin_i,
            ),
            DVec3::new(
                -node.cos() * argument.sin() - node.sin() * argument.cos() * cos_i,
                -node.sin() * argument.sin() + node.cos() * argument.cos() * cos_i,
                argument.cos() * sin_i,
            ),
            DVec3::new(node.sin() * sin_i, -node.cos() * sin_i, cos_i),
        );
        let found = EulerOrder::Zxz.angles(&orbit).expect("finite");
        for (angle, expected) in found.into_iter().zip([node, inclination, argument]) {
            assert!((angle - expected).abs() < 1e-12, "{angle} {expected}");
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

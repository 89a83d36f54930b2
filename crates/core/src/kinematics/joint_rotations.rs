//! The half-angle sines and cosines of all joint angles at once.
//!
//! `f32::sin` takes one angle at a time, and its last bit differs between systems. This implementation is
//! branch-free arithmetic in a loop, which compilers vectorise: it takes half the time for the angles of an arm and
//! returns the same bits on every system.

use std::f32::consts::FRAC_2_PI;

use glam::Quat;
use parry3d::math::Vec3;

use crate::estimate::JointAngles;
use crate::hand::Dof;

/// 1.5 · 2²³. Adding and subtracting it rounds an `f32` below 2²² to an integer, which is also in the lowest bits of
/// the sum.
const ROUND: f32 = 12_582_912.0;
/// π/2 in three parts, the first two short enough that their multiples are exact (Cody & Waite 1980).
const HALF_PI_PARTS: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];

/// Room for the angles and for one that is 0, in whole vector registers.
const COUNT: usize = Dof::COUNT + 4;

/// The index of an angle that is always 0; see [`JointRotations::half_angles`].
pub(super) const NO_ROTATION: usize = Dof::COUNT;

/// The sine and cosine of half the angle of each degree of freedom.
pub(super) struct JointRotations {
    sines: [f32; COUNT],
    cosines: [f32; COUNT],
}

impl JointRotations {
    /// Computes the sines and cosines, accurate to 1e-7 for angles up to ±1000 rad.
    pub(super) fn from_angles(angles: &JointAngles) -> Self {
        // A separate loop: a vector register holds twice as many `f32` as `f64`.
        let half_angles = angles.radians().map(|angle| angle as f32 * 0.5);
        let mut rotations = Self {
            sines: [0.0; COUNT],
            cosines: [1.0; COUNT],
        };
        let pairs = rotations.sines.iter_mut().zip(&mut rotations.cosines);
        for ((sine, cosine), half_angle) in pairs.zip(half_angles) {
            (*sine, *cosine) = sin_cos(half_angle);
        }
        rotations
    }

    /// Returns the rotation by the angle of `dof` about a unit axis.
    pub(super) fn about(&self, axis: Vec3, dof: Dof) -> Quat {
        let ([sine], [cosine]) = self.half_angles([dof.index()]);
        Quat::from_vec4((axis * sine).extend(cosine))
    }

    /// Returns the sines and cosines of half the angles with these indices in [`Dof::ALL`].
    #[inline]
    pub(super) fn half_angles<const LANES: usize>(
        &self,
        angles: [usize; LANES],
    ) -> ([f32; LANES], [f32; LANES]) {
        (
            angles.map(|index| self.sines[index]),
            angles.map(|index| self.cosines[index]),
        )
    }
}

/// Returns the sine and cosine of half an angle in radians, the same as in [`JointRotations`].
pub(super) fn half_angle(radians: f64) -> (f32, f32) {
    sin_cos(radians as f32 * 0.5)
}

/// Returns the sine and cosine of an angle in radians: the polynomials of the Cephes library (`sinf`, `cosf`) after reduction to
/// the nearest quarter turn.
pub fn sin_cos(angle: f32) -> (f32, f32) {
    let shifted = angle * FRAC_2_PI + ROUND;
    let quarters = shifted - ROUND;
    let reduced = ((angle - quarters * HALF_PI_PARTS[0]) - quarters * HALF_PI_PARTS[1])
        - quarters * HALF_PI_PARTS[2];
    let square = reduced * reduced;
    let sine = reduced
        + reduced * square * (-1.666_665_5e-1 + square * (8.332_161e-3 - square * 1.951_529_6e-4));
    let cosine = 1.0 - 0.5 * square
        + square * square * (4.166_664_6e-2 + square * (-1.388_731_6e-3 + square * 2.443_315_7e-5));
    let quadrant = shifted.to_bits();
    let (sine, cosine) = if quadrant & 1 == 0 {
        (sine, cosine)
    } else {
        (cosine, sine)
    };
    let sine_sign = (quadrant & 2) << 30;
    let cosine_sign = (quadrant.wrapping_add(1) & 2) << 30;
    (
        f32::from_bits(sine.to_bits() ^ sine_sign),
        f32::from_bits(cosine.to_bits() ^ cosine_sign),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_and_cosines_are_accurate_to_1_2e_7() {
        for step in -200_000..=200_000 {
            let angle = step as f32 * 1e-3;
            let (sine, cosine) = sin_cos(angle);
            let (exact_sine, exact_cosine) = f64::from(angle).sin_cos();
            assert!((f64::from(sine) - exact_sine).abs() < 1.2e-7, "{angle}");
            assert!((f64::from(cosine) - exact_cosine).abs() < 1.2e-7, "{angle}");
        }
        assert!(sin_cos(f32::NAN).0.is_nan());
    }
}

//! The sines and cosines of all angles of an arm at once.
//!
//! A library's sine takes one angle at a time and differs in the last bit from system to system.
//! This one is plain arithmetic in a loop without branches, which compilers turn into vector
//! instructions: half as much time for an arm's angles, and the same bits everywhere.

use std::f32::consts::FRAC_2_PI;

use glam::Quat;
use parry3d::math::Vec3;

use crate::estimate::JointAngles;
use crate::hand::Dof;

/// Added and taken away again it rounds an `f32` below 2²² to a whole number, which also stands in
/// the lowest bits of the sum.
const ROUND: f32 = 12_582_912.0;
/// π/2 in three parts, the first two short enough that their multiples are exact (Cody & Waite 1980).
const QUARTER: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];

/// For each degree of freedom the sine and cosine of half its angle.
pub(super) struct Turns {
    sines: [f32; Dof::COUNT],
    cosines: [f32; Dof::COUNT],
}

impl Turns {
    /// Right to 1e-7 for angles up to ±1000 rad; joints turn a few.
    pub(super) fn of(angles: &JointAngles) -> Self {
        // Two loops: a vector holds twice as many of the narrow numbers.
        let halves = angles.radians().map(|angle| angle as f32 * 0.5);
        let mut turns = Self {
            sines: [0.0; Dof::COUNT],
            cosines: [0.0; Dof::COUNT],
        };
        let places = turns.sines.iter_mut().zip(&mut turns.cosines);
        for ((sine, cosine), half) in places.zip(halves) {
            (*sine, *cosine) = sine_cosine(half);
        }
        turns
    }

    /// The rotation by the angle of `dof` about a unit axis.
    pub(super) fn about(&self, axis: Vec3, dof: Dof) -> Quat {
        let place = dof.index();
        Quat::from_vec4((axis * self.sines[place]).extend(self.cosines[place]))
    }
}

/// Polynomials of the Cephes library (`sinf`, `cosf`) on the nearest quarter turn.
fn sine_cosine(angle: f32) -> (f32, f32) {
    let shifted = angle * FRAC_2_PI + ROUND;
    let quarters = shifted - ROUND;
    let rest = ((angle - quarters * QUARTER[0]) - quarters * QUARTER[1]) - quarters * QUARTER[2];
    let square = rest * rest;
    let sine = rest
        + rest * square * (-1.666_665_5e-1 + square * (8.332_161e-3 - square * 1.951_529_6e-4));
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
    fn sines_and_cosines_are_right_to_the_last_digits() {
        for step in -200_000..=200_000 {
            let angle = step as f32 * 1e-3;
            let (sine, cosine) = sine_cosine(angle);
            let (true_sine, true_cosine) = f64::from(angle).sin_cos();
            assert!((f64::from(sine) - true_sine).abs() < 1.2e-7, "{angle}");
            assert!((f64::from(cosine) - true_cosine).abs() < 1.2e-7, "{angle}");
        }
        assert!(sine_cosine(f32::NAN).0.is_nan());
    }
}

//! Vectors and rotations of eight hands, with the operations of glam's `Quat` and `Vec3A` in their order: the results have the
//! same bits.

use wide::f32x8;

use super::LANES;
use crate::kinematics::PrincipalAxis;

/// A vector of each hand: x, y and z.
pub(super) type LaneVector = [f32x8; 3];

/// A rotation of each hand: x, y, z and w.
pub(super) type LaneRotation = [f32x8; 4];

/// A pose of each hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct LanePose {
    pub rotation: LaneRotation,
    pub translation: LaneVector,
}

/// Returns a vector that is the same for all hands.
#[inline]
pub(super) fn splat<const N: usize>(values: [f32; N]) -> [f32x8; N] {
    values.map(f32x8::splat)
}

/// Returns the sum of two vectors.
#[inline]
pub(super) fn add(a: LaneVector, b: LaneVector) -> LaneVector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Returns the arrays of a vector.
#[inline]
pub(super) fn to_arrays(vector: LaneVector) -> [[f32; LANES]; 3] {
    vector.map(f32x8::to_array)
}

/// Rotates a vector.
#[inline]
pub(super) fn rotated(rotation: &LaneRotation, vector: LaneVector) -> LaneVector {
    let [x, y, z, w] = *rotation;
    let [along, up, across] = vector;
    let two = f32x8::splat(2.0);
    let scale = w * w - (x * x + y * y + z * z);
    let twice_dot = (along * x + up * y + across * z) * two;
    let twice_w = w * two;
    [
        along * scale + x * twice_dot + (y * across - up * z) * twice_w,
        up * scale + y * twice_dot + (z * along - across * x) * twice_w,
        across * scale + z * twice_dot + (x * up - along * y) * twice_w,
    ]
}

/// Rotates a vector along X.
#[inline]
pub(super) fn rotated_x(rotation: &LaneRotation, along: f32x8) -> LaneVector {
    let [x, y, z, w] = *rotation;
    let two = f32x8::splat(2.0);
    let scale = w * w - (x * x + y * y + z * z);
    let twice_dot = along * x * two;
    let twice_w = w * two;
    [
        along * scale + x * twice_dot,
        y * twice_dot + z * along * twice_w,
        z * twice_dot - y * along * twice_w,
    ]
}

/// Returns the product of a rotation and one about an axis by the sines and cosines of half the angles.
#[inline]
pub(super) fn turned(
    rotation: &LaneRotation,
    axis: PrincipalAxis,
    sines: f32x8,
    cosines: f32x8,
) -> LaneRotation {
    let [x, y, z, w] = *rotation;
    let (s, c) = (sines, cosines);
    match axis {
        PrincipalAxis::X => [x * c + w * s, y * c + z * s, z * c - y * s, w * c - x * s],
        PrincipalAxis::Y => [x * c - z * s, y * c + w * s, z * c + x * s, w * c - y * s],
        PrincipalAxis::Z => [x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s],
    }
}

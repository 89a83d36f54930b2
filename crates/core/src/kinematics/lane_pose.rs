//! Poses in the lanes of vectors.
//!
//! The operations have the order of glam's product of two `Quat`s and of a `Quat` and a vector, without the terms that are 0: the
//! results are equal.

use std::ops::{Add, Mul, Sub};

use parry3d::math::Pose;

use super::link_pose::{Axis, LinkPose, Offset};

/// A vector with a number for each lane.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Mul<f32, Output = Self>
{
}

impl<L> Lanes for L where
    L: Copy + Add<Output = L> + Sub<Output = L> + Mul<Output = L> + Mul<f32, Output = L>
{
}

/// The pose of a link in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LanePose<L> {
    /// The quaternions: x, y, z and w of all lanes.
    pub rotation: [L; 4],
    /// The positions: x, y and z of all lanes, in metres.
    pub translation: [L; 3],
}

impl<L: Lanes> LanePose<L> {
    /// Returns the same pose in all lanes; `splat` makes a vector of a number.
    pub fn splat(pose: &Pose, splat: impl Fn(f32) -> L) -> Self {
        Self {
            rotation: pose.rotation.to_array().map(&splat),
            translation: pose.translation.to_array().map(&splat),
        }
    }

    #[inline]
    fn shift(&mut self, [right, up, back]: [L; 3]) {
        let [x, y, z] = self.translation;
        self.translation = [x + right, y + up, z + back];
    }
}

impl<N: Copy, L: Lanes + Mul<N, Output = L>> LinkPose<N> for LanePose<L> {
    type Number = L;

    #[inline]
    fn translate(&mut self, offset: &Offset<N>) {
        match *offset {
            Offset::None => {}
            Offset::AlongX(along) => self.advance(along),
            Offset::Any(offset) => self.shift(rotated(&self.rotation, offset)),
        }
    }

    #[inline]
    fn advance(&mut self, along: N) {
        let [x, y, z, w] = self.rotation;
        let scale = w * w - (x * x + y * y + z * z);
        let twice_dot = x * along * 2.0_f32;
        let twice_w = w * 2.0_f32;
        self.shift([
            scale * along + x * twice_dot,
            y * twice_dot + z * along * twice_w,
            z * twice_dot - y * along * twice_w,
        ]);
    }

    #[inline]
    fn turn(&mut self, axis: &Axis<N>, sines: L, cosines: L) {
        let [x, y, z, w] = self.rotation;
        let c = cosines;
        self.rotation = match *axis {
            Axis::None => return,
            Axis::X(senses) => {
                let s = sines * senses;
                [x * c + w * s, y * c + z * s, z * c - y * s, w * c - x * s]
            }
            Axis::Y(senses) => {
                let s = sines * senses;
                [x * c - z * s, y * c + w * s, z * c + x * s, w * c - y * s]
            }
            Axis::Z(senses) => {
                let s = sines * senses;
                [x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s]
            }
            Axis::Any(axes) => {
                let [i, j, k] = axes.map(|component| sines * component);
                [
                    (w * i + x * c) + (y * k - z * j),
                    (w * j - x * k) + (y * c + z * i),
                    (w * k + x * j) + (z * c - y * i),
                    (w * c - x * i) - (y * j + z * k),
                ]
            }
        };
    }
}

/// Returns a vector in each lane, turned by a quaternion. `N` is a number for all lanes or for each.
#[inline]
pub fn rotated<L, N>(rotation: &[L; 4], vector: [N; 3]) -> [L; 3]
where
    L: Lanes + Mul<N, Output = L>,
    N: Copy,
{
    let [x, y, z, w] = *rotation;
    let [along, up, across] = vector;
    let scale = w * w - (x * x + y * y + z * z);
    let twice_dot = (x * along + y * up + z * across) * 2.0_f32;
    let twice_w = w * 2.0_f32;
    [
        scale * along + x * twice_dot + (y * across - z * up) * twice_w,
        scale * up + y * twice_dot + (z * along - x * across) * twice_w,
        scale * across + z * twice_dot + (x * up - y * along) * twice_w,
    ]
}

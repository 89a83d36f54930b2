//! Rotations about the axes of a link's own frame, which most joints have.

use glam::{Quat, Vec3, Vec4, Vec4Swizzles};

/// An axis of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrincipalAxis {
    /// The X axis.
    X,
    /// The Y axis.
    Y,
    /// The Z axis.
    Z,
}

impl PrincipalAxis {
    /// Returns the axis that a unit vector lies on and its sense, ±1; `None` if it lies on none.
    pub fn from_vector(axis: Vec3) -> Option<(Self, f32)> {
        match axis.to_array() {
            [sense, 0.0, 0.0] => Some((Self::X, sense)),
            [0.0, sense, 0.0] => Some((Self::Y, sense)),
            [0.0, 0.0, sense] => Some((Self::Z, sense)),
            _ => None,
        }
    }

    /// Returns the product of `rotation` and a rotation about the axis by the sine and cosine of half an angle: the
    /// product of the two quaternions without the terms that are 0, in the same order.
    pub fn rotate(self, rotation: Quat, sine: f32, cosine: f32) -> Quat {
        let q = Vec4::from(rotation);
        let turned = match self {
            Self::X => q.wzyx() * Vec4::new(sine, sine, -sine, -sine),
            Self::Y => q.zwxy() * Vec4::new(-sine, sine, sine, -sine),
            Self::Z => q.yxwz() * Vec4::new(sine, -sine, sine, -sine),
        };
        Quat::from_vec4(q * cosine + turned)
    }
}

//! A displacement of an arm or a hand.

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use super::Joint;

/// The displacement of a joint, and of all joints beyond it, from the pose that the angles of the arm give them.
///
/// As JSON: `{"joint":"wrist","translation_m":[0.1,0.0,-0.05],"rotation":[0.0,0.0,0.0,1.0]}`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Displacement {
    /// The joint.
    pub joint: Joint,
    /// Translation in the world, in metres.
    #[serde(rename = "translation_m")]
    translation: [f32; 3],
    /// Rotation in the world about the joint: a quaternion x, y, z, w.
    rotation: [f32; 4],
}

impl Displacement {
    /// Creates a displacement from a translation in metres and a rotation about the joint, both in the world.
    pub fn new(joint: Joint, translation: Vec3, rotation: Quat) -> Self {
        Self {
            joint,
            translation: translation.to_array(),
            rotation: rotation.to_array(),
        }
    }

    /// Returns the translation in the world, in metres.
    pub fn translation(&self) -> Vec3 {
        Vec3::from_array(self.translation)
    }

    /// Returns the translation, in metres, and the quaternion x, y, z, w as they were measured.
    pub fn to_arrays(self) -> ([f32; 3], [f32; 4]) {
        (self.translation, self.rotation)
    }

    /// Returns the rotation in the world about the joint. `None` if a number is not finite or the quaternion has no length.
    pub fn rotation(&self) -> Option<Quat> {
        let [x, y, z, w] = self.rotation;
        let length = (x * x + y * y + z * z + w * w).sqrt();
        let quaternion = Quat::from_xyzw(x, y, z, w);
        (length.is_finite() && length > 1e-3).then(|| quaternion * (1.0 / length))
    }
}

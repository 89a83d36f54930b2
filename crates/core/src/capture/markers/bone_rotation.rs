//! The rotation from one bone to the next, which drives a skeleton whose bones have fixed lengths.

use glam::{DMat3, DVec3};

use crate::geometry::{angle_between, rotation_between};

/// Largest angle in radians that counts as straight: its axis is lost in rounding.
const STRAIGHT: f64 = 1e-9;

/// The rotation that takes the direction of a bone onto the direction of the next bone, without twist.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoneRotation {
    /// The angle in radians, 0..=π: 0 if the bones are in line.
    pub angle: f64,
    /// The unit axis; `None` if the bones are in line. For a bone folded back onto the other one, it is one of those
    /// perpendicular to it.
    pub axis: Option<DVec3>,
    /// The rotation matrix.
    pub matrix: DMat3,
}

/// Returns the rotation from the bone `a`–`b` to the bone `b`–`c`; `None` if a bone has no length or a number is not
/// finite.
pub fn bone_rotation(a: DVec3, b: DVec3, c: DVec3) -> Option<BoneRotation> {
    let (first, second) = (b - a, c - b);
    let matrix = rotation_between(first, second)?;
    let angle = angle_between(first, second);
    let axis = match angle {
        0.0..=STRAIGHT => None,
        _ => first
            .cross(second)
            .try_normalize()
            .or(half_turn_axis(&matrix)),
    };
    Some(BoneRotation {
        angle,
        axis,
        matrix,
    })
}

/// Returns the axis k of a half turn 2 k kᵀ − I.
fn half_turn_axis(matrix: &DMat3) -> Option<DVec3> {
    let outer = *matrix + DMat3::IDENTITY;
    let columns = [outer.x_axis, outer.y_axis, outer.z_axis];
    let longest = columns
        .into_iter()
        .max_by(|one, other| one.length_squared().total_cmp(&other.length_squared()));
    longest?.try_normalize()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn bones_in_line_have_no_axis_and_folded_ones_have_a_perpendicular_axis() {
        let straight = bone_rotation(DVec3::ZERO, DVec3::Y, DVec3::Y * 3.0).unwrap();
        assert_eq!((straight.angle, straight.axis), (0.0, None));
        let folded = bone_rotation(DVec3::ZERO, DVec3::Y, DVec3::ZERO).unwrap();
        assert_eq!(folded.angle, PI);
        assert!(folded.axis.unwrap().dot(DVec3::Y).abs() < 1e-12);
        assert!((folded.matrix * DVec3::Y).distance(DVec3::NEG_Y) < 1e-12);
        assert_eq!(bone_rotation(DVec3::ZERO, DVec3::ZERO, DVec3::Y), None);
    }
}

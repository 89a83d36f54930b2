//! The object of a pose.
//!
//! It has 182 numbers. Without the generic serialization of maps and names it takes half the time, and the numbers of a joint
//! that turns with its parent, as a fingertip does, are copied.

use std::ops::Range;

use serde::Serialize;

use crate::kinematics::HandPose;

/// Replaces `out` by the object of a pose.
pub fn write_pose(pose: &HandPose, out: &mut Vec<u8>) {
    out.clear();
    out.extend_from_slice(b"{\"time_us\":");
    write_number(&pose.time, out);
    out.extend_from_slice(b",\"side\":\"");
    out.extend_from_slice(pose.side.name().as_bytes());
    out.extend_from_slice(b"\",\"positions\":{");
    write_joints(pose, out, |pose| pose.translation.to_array());
    out.extend_from_slice(b"},\"orientations\":{");
    write_joints(pose, out, |pose| pose.rotation.to_array());
    out.extend_from_slice(b"}}");
}

/// Appends the numbers of each joint as a list after its name. No name has a character that JSON escapes.
fn write_joints<const N: usize>(
    pose: &HandPose,
    out: &mut Vec<u8>,
    numbers: impl Fn(&parry3d::math::Pose) -> [f32; N],
) {
    // The numbers of the joint before, and their list in `out`.
    let mut before: Option<([u32; N], Range<usize>)> = None;
    for (joint, joint_pose) in pose.known() {
        let separator: &[u8] = if before.is_none() { b"\"" } else { b",\"" };
        out.extend_from_slice(separator);
        out.extend_from_slice(joint.name().as_bytes());
        out.extend_from_slice(b"\":");
        let numbers = numbers(joint_pose);
        // Bits, because 0 and −0 are written differently.
        let bits = numbers.map(f32::to_bits);
        let start = out.len();
        match before {
            Some((same, list)) if same == bits => out.extend_from_within(list),
            _ => write_list(&numbers, out),
        }
        before = Some((bits, start..out.len()));
    }
}

fn write_list(numbers: &[f32], out: &mut Vec<u8>) {
    let mut separator = b'[';
    for number in numbers {
        out.push(separator);
        write_number(number, out);
        separator = b',';
    }
    out.push(b']');
}

fn write_number(number: &impl Serialize, out: &mut Vec<u8>) {
    serde_json::to_writer(out, number).expect("a vector accepts all bytes");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::{Joint, Side};
    use crate::time::Timestamp;
    use parry3d::math::{Pose, Rotation, Vec3};

    #[test]
    fn joints_with_the_same_numbers_are_written_like_any_other() {
        let mut pose = HandPose::new(Timestamp(7), Side::Left, 0.008);
        let turned = Rotation::from_xyzw(0.0, 0.6, 0.0, 0.8);
        let minus_zero = Rotation::from_xyzw(-0.0, 0.6, 0.0, 0.8);
        pose.set(Joint::Wrist, Pose::from_parts(Vec3::X, turned));
        pose.set(Joint::ThumbTip, Pose::from_parts(Vec3::X, turned));
        pose.set(Joint::IndexTip, Pose::from_parts(Vec3::Y, minus_zero));
        let mut out = b"before".to_vec();
        write_pose(&pose, &mut out);
        assert_eq!(
            String::from_utf8(out).unwrap(),
            "{\"time_us\":7,\"side\":\"left\",\"positions\":{\"wrist\":[1.0,0.0,0.0],\"thumb-tip\":[1.0,0.0,0.0],\
             \"index-finger-tip\":[0.0,1.0,0.0]},\"orientations\":{\"wrist\":[0.0,0.6,0.0,0.8],\
             \"thumb-tip\":[0.0,0.6,0.0,0.8],\"index-finger-tip\":[-0.0,0.6,0.0,0.8]}}"
        );
    }
}

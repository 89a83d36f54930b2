//! The object of a pose.
//!
//! It has 182 numbers. Without the generic serialization of maps and names it takes half the time.

use serde::Serialize;

use crate::hand::Joint;
use crate::kinematics::HandPose;

/// Replaces `out` by the object of a pose.
pub(super) fn write(pose: &HandPose, out: &mut Vec<u8>) {
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
    let mut is_first = true;
    for &joint in Joint::ALL {
        let Some(pose) = pose.get(joint) else {
            continue;
        };
        let separator: &[u8] = if is_first { b"\"" } else { b",\"" };
        is_first = false;
        out.extend_from_slice(separator);
        out.extend_from_slice(joint.name().as_bytes());
        let mut separator: &[u8] = b"\":[";
        for number in numbers(pose) {
            out.extend_from_slice(separator);
            write_number(&number, out);
            separator = b",";
        }
        out.push(b']');
    }
}

fn write_number(number: &impl Serialize, out: &mut Vec<u8>) {
    serde_json::to_writer(out, number).expect("a vector accepts all bytes");
}

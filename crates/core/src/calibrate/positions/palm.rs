//! The frame of a palm, measured and of a hand that types.

use glam::{Mat3, Quat, Vec3};
use parry3d::math::Pose;

use super::median_position;
use crate::hand::{Joint, JointPositions, Side};
use crate::kinematics::ArmModel;

/// The joints of a palm: wrist, then the knuckles of index, middle and little finger.
const PALM: [Joint; 4] = [
    Joint::Wrist,
    Joint::IndexPhalanxProximal,
    Joint::MiddlePhalanxProximal,
    Joint::LittlePhalanxProximal,
];

/// Returns the frame of a palm: X across the knuckles to the right of a hand whose palm is down, Y from the wrist to the fingers, Z out
/// of the back of the hand. `None` if the joints are on a line, or one is not known.
fn palm_frame([wrist, index, middle, little]: [Option<Vec3>; 4], side: Side) -> Option<Pose> {
    let middle = middle?;
    let away = (middle - wrist?).try_normalize()?;
    let across = match side {
        Side::Right => little? - index?,
        Side::Left => index? - little?,
    };
    let up = across.cross(away).try_normalize()?;
    let axes = Mat3::from_cols(away.cross(up), away, up);
    Some(Pose::from_parts(middle, Quat::from_mat3(&axes)))
}

/// Returns `world_from_palm` of a hand that was still during the readings: its origin at the knuckle of the middle finger, X to the
/// right of a hand whose palm is down, Y from the wrist to the fingers, Z out of the back of the hand. `None` if fewer than ten
/// readings show the palm.
pub fn measure_palm(readings: &[JointPositions], side: Side) -> Option<Pose> {
    let point = |joint| Some(median_position(readings, joint)?.as_vec3());
    palm_frame(PALM.map(point), side)
}

/// Returns the frame of the palm relative to the elbow (`elbow_from_palm`, see [`measure_palm`]) in the typing posture with the forearm
/// straight forward, for which layouts are drawn. `None` if the model lacks these joints.
pub fn typing_palm(arm: &ArmModel) -> Option<Pose> {
    let typing = arm.typing_pose();
    let elbow = typing.position(Joint::Elbow)?;
    let point = |joint| Some(typing.position(joint)? - elbow);
    palm_frame(PALM.map(point), arm.side())
}

//! Joint angles from the rotations of bones, and back.
//!
//! In the T pose the arms point to the sides with the palms down; the thumbs point forward and outward.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DQuat, DVec3};

use super::hand_angles::{as_supination, hand_angles, sign};
use crate::hand::{ArmBone, ArmRotations, Dof, Finger, Joint, JointAngles, JointPositions, Side};

/// The angle by which the thumb points off the other fingers in the T pose, in radians.
const THUMB_ANGLE: f64 = -FRAC_PI_4;

/// The length of every bone, in metres. Only directions matter.
const LENGTH: f64 = 0.03;

/// The distance of each knuckle from the knuckle of the middle finger, positive towards the little finger, in metres.
const KNUCKLES: [f64; Finger::COUNT] = [-0.03, -0.02, 0.0, 0.02, 0.04];

/// Smallest sine of the angle between a forearm and the vertical at which the palm can face down.
const MIN_SINE: f64 = 0.2;

/// Returns the joint angles that the rotations of an arm show, in radians. An angle whose bones are not all known is
/// unknown.
///
/// Supination is 0 with the palm down if the rotation of the upper arm in the world is known and the forearm is not vertical.
/// Else it is 0 if the palm faces away from the direction in which the elbow bends, as in [`hand_angles`]. Both are the same for
/// an upper arm that hangs down.
pub fn angles_from_bones(bones: &ArmRotations, side: Side) -> JointAngles {
    let arm = Arm::new(bones, side);
    let shown = hand_angles(&arm.positions(), side);
    let mut angles = JointAngles::default();
    for &dof in Dof::ALL {
        if is_shown(bones, dof) && shown.is_known(dof) {
            angles.set(dof, shown.get(dof));
        }
    }
    if is_shown(bones, Dof::ForearmSupination) {
        let flexion = shown.get(Dof::WristFlexion);
        angles.set(Dof::ForearmSupination, arm.supination(flexion));
    }
    angles
}

/// Returns `true` if the bones that show an angle are known.
fn is_shown(bones: &ArmRotations, dof: Dof) -> bool {
    let known = |bone| bones.is_known(bone);
    match dof {
        Dof::ElbowFlexion => known(ArmBone::LowerArm),
        Dof::ForearmSupination => known(ArmBone::LowerArm) && known(ArmBone::Hand),
        Dof::WristDeviation | Dof::WristFlexion => known(ArmBone::Hand),
        _ => dof.finger().is_some_and(|finger| {
            let mut finger_bones =
                (0..ArmBone::PER_FINGER).map(|index| ArmBone::of_finger(finger, index));
            finger_bones.all(|bone| bone.is_some_and(known))
        }),
    }
}

/// The bones of one arm; unknown rotations are taken from the T pose.
struct Arm<'a> {
    bones: &'a ArmRotations,
    side: Side,
    /// The rotation from the frame of the lower arm to the frame of the upper arm.
    lower_arm: DQuat,
    /// The rotation from the frame of the hand to the frame of the upper arm.
    hand: DQuat,
}

impl<'a> Arm<'a> {
    fn new(bones: &'a ArmRotations, side: Side) -> Self {
        let lower_arm = rotation(bones, ArmBone::LowerArm);
        Self {
            bones,
            side,
            lower_arm,
            hand: lower_arm * rotation(bones, ArmBone::Hand),
        }
    }

    /// Returns the positions of the joints, from the shoulder at the origin, in the frame of the upper arm.
    fn positions(&self) -> JointPositions {
        let along = outward(self.side);
        let mut positions = JointPositions::default();
        let elbow = along * LENGTH;
        let wrist = elbow + self.lower_arm * along * LENGTH;
        positions.set(Joint::Shoulder, DVec3::ZERO);
        positions.set(Joint::Elbow, elbow);
        positions.set(Joint::Wrist, wrist);
        for &finger in Finger::ALL {
            let knuckle = along * LENGTH + DVec3::Z * KNUCKLES[finger.index()];
            let knuckle = wrist + self.hand * knuckle;
            self.add_finger(finger, knuckle, &mut positions);
        }
        positions
    }

    fn add_finger(&self, finger: Finger, knuckle: DVec3, positions: &mut JointPositions) {
        let tip = Joint::tip(finger).index();
        let joints = &Joint::ALL[tip - ArmBone::PER_FINGER..=tip];
        let along = finger_direction(finger, self.side);
        let (mut position, mut rotation_so_far) = (knuckle, self.hand);
        positions.set(joints[0], position);
        for (index, &joint) in joints[1..].iter().enumerate() {
            if let Some(bone) = ArmBone::of_finger(finger, index) {
                rotation_so_far *= rotation(self.bones, bone);
            }
            position += rotation_so_far * along * LENGTH;
            positions.set(joint, position);
        }
    }

    /// Returns the supination of the forearm.
    fn supination(&self, wrist_flexion: f64) -> f64 {
        let along = outward(self.side);
        let forearm = (self.lower_arm * along).normalize();
        let palm_side =
            self.hand * (along * wrist_flexion.sin() + DVec3::NEG_Y * wrist_flexion.cos());
        // The side that the palm faces away from at 0.
        let back = self
            .upward(forearm)
            .unwrap_or_else(|| self.bend_side(forearm));
        let supination = sign(self.side) * palm_side.dot(back.cross(forearm));
        as_supination(supination.atan2(-palm_side.dot(back)))
    }

    /// Returns the upper side of the forearm in the frame of the upper arm, if the rotation of that in the world is known and
    /// the forearm is not vertical.
    fn upward(&self, forearm: DVec3) -> Option<DVec3> {
        self.bones.get(ArmBone::UpperArm)?;
        let up = rotation(self.bones, ArmBone::UpperArm).inverse() * DVec3::Y;
        let across = up.reject_from_normalized(forearm);
        (across.length() >= MIN_SINE).then(|| across.normalize())
    }

    /// Returns the side of the forearm to which the elbow bends, also of a straight arm: the elbow is a hinge that bends forward
    /// in the T pose.
    fn bend_side(&self, forearm: DVec3) -> DVec3 {
        let hinge = DQuat::from_rotation_arc(outward(self.side), forearm);
        hinge * DVec3::NEG_Z
    }
}

/// Returns the direction of an arm in the T pose.
fn outward(side: Side) -> DVec3 {
    DVec3::X * sign(side)
}

/// Returns the direction of a finger in the T pose.
fn finger_direction(finger: Finger, side: Side) -> DVec3 {
    match finger {
        Finger::Thumb => abduction(side, THUMB_ANGLE) * outward(side),
        _ => outward(side),
    }
}

/// Returns the rotation of a finger in the plane of the palm, away from the thumb.
fn abduction(side: Side, radians: f64) -> DQuat {
    DQuat::from_rotation_y(-sign(side) * radians)
}

/// Returns the rotation of a hand or finger towards the palm.
fn flexion(side: Side, radians: f64) -> DQuat {
    DQuat::from_rotation_z(-sign(side) * radians)
}

fn rotation(bones: &ArmRotations, bone: ArmBone) -> DQuat {
    let rotation = bones.get(bone).map(|rotation| rotation.as_dquat());
    rotation.map_or(DQuat::IDENTITY, DQuat::normalize)
}

/// Returns the rotations of the bones that have these angles. Bones without a known angle are unknown.
pub fn bones_from_angles(angles: &JointAngles, side: Side) -> ArmRotations {
    let mut bones = ArmRotations::default();
    let mut set = |bone, dofs: &[Dof], rotation: DQuat| {
        if dofs.iter().any(|&dof| angles.is_known(dof)) {
            bones.set(bone, rotation.as_quat());
        }
    };
    let angle = |dof| angles.get(dof);
    let elbow = DQuat::from_rotation_y(sign(side) * angle(Dof::ElbowFlexion));
    let roll = DQuat::from_rotation_x(angle(Dof::ForearmSupination) - FRAC_PI_2);
    let forearm = [Dof::ElbowFlexion, Dof::ForearmSupination];
    set(ArmBone::LowerArm, &forearm, elbow * roll);
    let hand =
        abduction(side, angle(Dof::WristDeviation)) * flexion(side, angle(Dof::WristFlexion));
    set(
        ArmBone::Hand,
        &[
            Dof::WristDeviation,
            Dof::WristFlexion,
            Dof::ForearmSupination,
        ],
        hand,
    );
    for &finger in Finger::ALL {
        let dofs: [Dof; 4] = std::array::from_fn(|index| Dof::ALL[8 + 4 * finger.index() + index]);
        let rest = match finger {
            Finger::Thumb => abduction(side, THUMB_ANGLE),
            _ => DQuat::IDENTITY,
        };
        let first = abduction(side, angle(dofs[0])) * flexion(side, angle(dofs[1]));
        // The bones beyond turn about the axis that the finger has in the T pose.
        let bend = |dof| rest * flexion(side, angle(dof)) * rest.inverse();
        let rotations = [first * rest.inverse(), bend(dofs[2]), bend(dofs[3])];
        for (index, rotation) in rotations.into_iter().enumerate() {
            if let Some(bone) = ArmBone::of_finger(finger, index) {
                set(bone, &dofs, rotation);
            }
        }
    }
    bones
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::JointLimits;

    #[test]
    fn angles_come_back_from_the_rotations_of_bones() {
        let limits = JointLimits::human();
        for &side in Side::ALL {
            for round in 0..200 {
                let mut angles = JointAngles::default();
                for (index, &dof) in Dof::ALL.iter().enumerate().skip(4) {
                    let (low, high) = limits.range(dof);
                    let t = (f64::from(round) * 0.618_034 * (index + 1) as f64).fract();
                    angles.set(dof, low + (0.02 + 0.88 * t) * (high - low));
                }
                let found = angles_from_bones(&bones_from_angles(&angles, side), side);
                for (dof, radians) in found.known() {
                    let expected = angles.get(dof);
                    let error = (radians - expected).abs();
                    assert!(
                        error < 1e-5,
                        "{side} {round} {dof}: {radians}, not {expected}"
                    );
                }
                for &dof in Dof::ALL {
                    let is_measured = dof.finger().is_some()
                        || [
                            Dof::ElbowFlexion,
                            Dof::ForearmSupination,
                            Dof::WristDeviation,
                            Dof::WristFlexion,
                        ]
                        .contains(&dof);
                    assert_eq!(found.is_known(dof), is_measured, "{dof}");
                }
            }
        }
    }

    #[test]
    fn the_t_pose_has_a_straight_hand_and_a_thumb_that_is_up_for_a_bent_elbow() {
        let mut bones = ArmRotations::default();
        for &bone in ArmBone::ALL {
            if bone != ArmBone::UpperArm {
                bones.set(bone, glam::Quat::IDENTITY);
            }
        }
        for &side in Side::ALL {
            let angles = angles_from_bones(&bones, side);
            let degrees = |dof| angles.get(dof).to_degrees();
            for (dof, expected) in [
                (Dof::ElbowFlexion, 0.0),
                (Dof::ForearmSupination, 90.0),
                (Dof::WristFlexion, 0.0),
                (Dof::WristDeviation, 0.0),
                (Dof::IndexMcpFlexion, 0.0),
                (Dof::LittleMcpAbduction, 0.0),
                (Dof::ThumbCmcAbduction, -45.0),
            ] {
                let found = degrees(dof);
                assert!((found - expected).abs() < 1e-3, "{side} {dof}: {found}");
            }
        }
    }

    #[test]
    fn the_palm_is_down_at_supination_0_whatever_the_direction_of_the_upper_arm() {
        let quarter = std::f32::consts::FRAC_PI_2;
        for &side in Side::ALL {
            let sign = sign(side) as f32;
            // In the T pose, the palm is down; an elbow that bends forward keeps it there.
            // Beyond 180, the palm that is up turns on.
            for (turn, expected) in [
                (0.0, 0.0),
                (quarter, 90.0),
                (-0.5 * quarter, -45.0),
                (2.1 * quarter, 189.0),
            ] {
                let mut bones = ArmRotations::default();
                let roll = glam::Quat::from_rotation_x(turn);
                let bend = glam::Quat::from_rotation_y(sign * quarter);
                bones.set(ArmBone::UpperArm, glam::Quat::IDENTITY);
                bones.set(ArmBone::LowerArm, bend * roll);
                bones.set(ArmBone::Hand, glam::Quat::IDENTITY);
                let found = angles_from_bones(&bones, side).get(Dof::ForearmSupination);
                assert!(
                    (found.to_degrees() - expected).abs() < 1e-3,
                    "{side} {found}"
                );
                // An arm that hangs down, its hand forward with the palm on a table.
                let hanging = glam::Quat::from_rotation_z(-sign * quarter);
                bones.set(ArmBone::UpperArm, hanging);
                bones.set(
                    ArmBone::LowerArm,
                    bend * glam::Quat::from_rotation_x(turn - quarter),
                );
                let bent = angles_from_bones(&bones, side).get(Dof::ForearmSupination);
                assert!((bent.to_degrees() - expected).abs() < 1e-3, "{side} {bent}");
            }
        }
    }

    #[test]
    fn a_vertical_forearm_shows_its_roll_against_the_elbow() {
        let mut bones = ArmRotations::default();
        let down = glam::Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2);
        bones.set(ArmBone::LowerArm, glam::Quat::IDENTITY);
        bones.set(ArmBone::Hand, glam::Quat::IDENTITY);
        let without = angles_from_bones(&bones, Side::Right);
        bones.set(ArmBone::UpperArm, down);
        assert_eq!(angles_from_bones(&bones, Side::Right), without);
    }

    #[test]
    fn a_finger_without_one_of_its_bones_is_unknown() {
        let mut bones = ArmRotations::default();
        for bone in [
            ArmBone::Hand,
            ArmBone::IndexFirst,
            ArmBone::IndexSecond,
            ArmBone::MiddleFirst,
            ArmBone::MiddleSecond,
            ArmBone::MiddleThird,
        ] {
            bones.set(bone, glam::Quat::IDENTITY);
        }
        let angles = angles_from_bones(&bones, Side::Left);
        let known: Vec<Dof> = angles.known().map(|(dof, _)| dof).collect();
        assert_eq!(
            known,
            [
                Dof::WristDeviation,
                Dof::WristFlexion,
                Dof::MiddleMcpAbduction,
                Dof::MiddleMcpFlexion,
                Dof::MiddlePipFlexion,
                Dof::MiddleDipFlexion,
            ]
        );
    }
}

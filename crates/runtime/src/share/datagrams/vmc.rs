//! Datagrams of VMC: the bones of both arms.

use std::time::Duration;

use glam::{Mat3, Quat, Vec3};

use crate::capture::protocol::vmc;
use ademan_core::estimate::{JointAngles, bones_from_angles, forearm_sides};
use ademan_core::hand::{ArmBone, ArmRotations, BoneRotations, Joint, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::time::Timestamp;

/// Shortest time between two datagrams of a hand: twice the rate at which avatars are drawn.
const MIN_PERIOD: Duration = Duration::from_micros(8_333);

/// Longest time for which the bones of a hand are sent after its last pose.
const MAX_AGE: Duration = Duration::from_millis(200);

/// The smallest part of a vector across another one that shows a direction, as a fraction of its length.
const MIN_ACROSS: f32 = 0.05;

/// The encoder of the poses of both hands. Each datagram has the latest bones of both, without the hand that is lost: a receiver takes
/// each bone for one that is seen now.
#[derive(Default)]
pub(super) struct VmcEncoder {
    bones: BoneRotations,
    /// The time of the last datagram after a pose of each hand.
    sent_at: [Option<Timestamp>; Side::COUNT],
}

impl VmcEncoder {
    /// Returns a datagram with the bones of a hand; `None` if the last one was sent less than 8 ms before.
    pub fn encode(&mut self, angles: &JointAngles, pose: &HandPose) -> Option<Vec<u8>> {
        let sent_at = &mut self.sent_at[pose.side.index()];
        // The time of a source may start again.
        let is_early = |sent: Timestamp| pose.time >= sent && pose.time.since(sent) < MIN_PERIOD;
        if sent_at.is_some_and(is_early) {
            return None;
        }
        *sent_at = Some(pose.time);
        *self.bones.arm_mut(pose.side) = arm_bones(angles, pose);
        let other = pose.side.opposite();
        let is_old = |sent: Timestamp| pose.time.since(sent).max(sent.since(pose.time)) > MAX_AGE;
        if self.sent_at[other.index()].is_some_and(is_old) {
            *self.bones.arm_mut(other) = ArmRotations::default();
        }
        Some(vmc::encode_at(&self.bones, pose.time))
    }
}

/// Returns the rotations of the bones of an arm, without the fingers that are not trusted; none of an arm that is nowhere. Upper arm and
/// forearm come from the pose: avatars have the elbow of a person, and an arm of a setup may bend otherwise.
fn arm_bones(angles: &JointAngles, pose: &HandPose) -> ArmRotations {
    if pose.known().next().is_none() {
        return ArmRotations::default();
    }
    let mut trusted = JointAngles::default();
    for (dof, radians) in angles.known() {
        let is_trusted = |finger| !pose.untrusted.contains(finger);
        if dof.finger().is_none_or(is_trusted) {
            trusted.set(dof, radians);
        }
    }
    let mut bones = bones_from_angles(&trusted, pose.side);
    let Some(upper_arm) = upper_arm(pose) else {
        return bones;
    };
    bones.set(ArmBone::UpperArm, upper_arm);
    if bones.is_known(ArmBone::LowerArm)
        && let Some(forearm) = forearm(pose)
    {
        bones.set(ArmBone::LowerArm, upper_arm.inverse() * forearm);
    }
    bones
}

/// Returns the rotation of the forearm from the T pose in the world: along the forearm, its palm side down.
fn forearm(pose: &HandPose) -> Option<Quat> {
    let [along, palm_side] = forearm_sides(&pose.positions(), pose.side)?;
    let x = outward(along.as_vec3(), pose.side);
    let y = -palm_side.as_vec3();
    Some(Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y))))
}

/// Returns the direction that is +X in the T pose of an arm with this direction.
fn outward(along: Vec3, side: Side) -> Vec3 {
    match side {
        Side::Right => along,
        Side::Left => -along,
    }
}

/// Returns the rotation of the upper arm from the T pose in the world. The forearm shows the twist: in the T pose, the elbow
/// bends forward. The elbow of a straight arm is taken to bend up.
fn upper_arm(pose: &HandPose) -> Option<Quat> {
    let elbow = pose.position(Joint::Elbow)?;
    let along = (elbow - pose.position(Joint::Shoulder)?).try_normalize()?;
    let forearm = pose.position(Joint::Wrist).unwrap_or(elbow) - elbow;
    let across = |direction: Vec3| {
        let part = direction.reject_from_normalized(along);
        let is_clear = part.length() > MIN_ACROSS * direction.length();
        is_clear.then(|| part.try_normalize()).flatten()
    };
    let bend_side = [forearm, Vec3::Y, Vec3::NEG_Z]
        .into_iter()
        .find_map(across)?;
    let x = outward(along, pose.side);
    let z = -bend_side;
    Some(Quat::from_mat3(&Mat3::from_cols(x, z.cross(x), z)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::hand::{Dof, Finger, FingerSet};
    use parry3d::math::Pose;

    fn arm(side: Side, joints: [Vec3; 3]) -> HandPose {
        let mut pose = HandPose::new(Timestamp(0), side, 0.008);
        for (joint, position) in [Joint::Shoulder, Joint::Elbow, Joint::Wrist]
            .into_iter()
            .zip(joints)
        {
            pose.set(joint, Pose::from_translation(position));
        }
        pose
    }

    #[test]
    fn the_upper_arm_turns_from_the_t_pose_to_the_elbow_and_the_forearm_shows_its_twist() {
        // The T pose with the forearm bent forward.
        let bent = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::NEG_Z];
        let rotation = upper_arm(&arm(Side::Right, bent)).unwrap();
        assert!(rotation.angle_between(Quat::IDENTITY) < 1e-3, "{rotation}");
        // Hanging arms, the forearms forward: each turns about the axis towards the viewer.
        for (side, quarter) in [(Side::Right, -1.0), (Side::Left, 1.0)] {
            let hanging = [Vec3::ZERO, Vec3::NEG_Y, Vec3::NEG_Y + Vec3::NEG_Z];
            let hanging_rotation = upper_arm(&arm(side, hanging)).unwrap();
            let expected = Quat::from_rotation_z(quarter * std::f32::consts::FRAC_PI_2);
            assert!(
                hanging_rotation.angle_between(expected) < 1e-3,
                "{side} {hanging_rotation}"
            );
        }
        let straight = [Vec3::ZERO, Vec3::NEG_Z, 2.0 * Vec3::NEG_Z];
        let straight_rotation = upper_arm(&arm(Side::Right, straight)).unwrap();
        assert!((straight_rotation * Vec3::X).distance(Vec3::NEG_Z) < 1e-6);
        assert!((straight_rotation * Vec3::NEG_Z).distance(Vec3::Y) < 1e-6);
    }

    #[test]
    fn datagrams_follow_each_other_at_the_rate_of_displays_and_survive_a_source_that_starts_again()
    {
        let mut encoder = VmcEncoder::default();
        let mut sent = |milliseconds: u64, side| {
            let mut pose = arm(side, [Vec3::ZERO, Vec3::X, Vec3::X]);
            pose.time = Timestamp(1000 * milliseconds);
            encoder.encode(&JointAngles::default(), &pose).is_some()
        };
        let times = [0, 1, 8, 9, 10, 18, 2];
        let right = times.map(|time| sent(time, Side::Right));
        assert_eq!(right, [true, false, false, true, false, true, true]);
        assert!(sent(2, Side::Left));
    }

    #[test]
    fn a_finger_that_is_not_trusted_and_a_hand_that_is_lost_have_no_bones() {
        let mut encoder = VmcEncoder::default();
        let mut angles = JointAngles::default();
        for &dof in Dof::ALL {
            angles.set(dof, 0.1);
        }
        let mut sent = |pose: &HandPose| {
            assert!(encoder.encode(&angles, pose).is_some());
            encoder.bones
        };
        let seen = |milliseconds: u64, side| {
            let mut pose = arm(side, [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::NEG_Z]);
            pose.time = Timestamp(1000 * milliseconds);
            pose
        };
        let index = ArmBone::IndexFirst;
        assert!(sent(&seen(0, Side::Left)).left.is_known(index));
        let mut cut = seen(10, Side::Right);
        cut.untrusted = FingerSet::NONE.with(Finger::Index);
        let both = sent(&cut);
        assert!(both.left.is_known(index) && !both.right.is_known(index));
        assert!(both.right.is_known(ArmBone::MiddleFirst));
        assert!(both.right.is_known(ArmBone::LowerArm));
        let alone = sent(&seen(300, Side::Right));
        assert!(alone.left.is_empty() && alone.right.is_known(index));
        let nowhere = HandPose::new(Timestamp(400_000), Side::Right, 0.008);
        assert!(sent(&nowhere).right.is_empty());
    }
}

//! Tests of written poses.

use std::io::Cursor;

use glam::DVec3;
use parry3d::math::{Pose, Vec3};

use super::*;
use crate::capture::bvh::{Bvh, HandJoints, PositionChannels};
use ademan_core::estimate::{Estimate, JointAngles, JointLimits};
use ademan_core::hand::{Dof, Joint};
use ademan_core::kinematics::{ArmModel, BoneLengths};

/// Returns poses of a whole arm that moves all joints, 100 per second.
fn poses(side: Side, count: u64) -> Vec<HandPose> {
    let bones = BoneLengths::from_hand_and_forearm(0.190, 0.255).unwrap();
    let model = ArmModel::anthropometric(side, &bones).unwrap();
    let limits = JointLimits::human();
    let pose = |number: u64| {
        let mut angles = JointAngles::default();
        for (index, &dof) in Dof::ALL.iter().enumerate() {
            let (low, high) = limits.range(dof);
            let t = (0.1 * number as f64 + index as f64).sin() * 0.5 + 0.5;
            angles.set(dof, low + t * (high - low));
        }
        let mut estimate = Estimate::new(Timestamp(1_000_000 + 10_000 * number), angles);
        let drift = Vec3::new(0.01 * number as f32, 1.2, -0.3);
        estimate.root = Some(Pose::from_parts(drift, ArmModel::palm_down_pose().rotation));
        model.forward(&estimate)
    };
    (0..count).map(pose).collect()
}

fn written(poses: &[HandPose], rate_hz: f64) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = PoseWriter::new(&mut file, PoseOptions::new(rate_hz));
    for pose in poses {
        writer.push(pose).unwrap();
    }
    writer.finish().unwrap();
    file.into_inner()
}

#[test]
fn every_joint_of_a_rigid_arm_is_written_within_a_hundredth_of_a_millimetre() {
    for side in [Side::Left, Side::Right] {
        let poses = poses(side, 200);
        let bvh = Bvh::parse(&written(&poses, 100.0)).unwrap();
        assert_eq!(bvh.motion().frame_count, 200);
        let joints = HandJoints::find(&bvh.motion().skeleton, side).unwrap();
        assert_eq!(joints.iter().count(), Joint::COUNT);
        for (frame, pose) in poses.iter().enumerate() {
            let positions = bvh.positions(frame as u64, PositionChannels::Add);
            for (joint, node) in joints.iter() {
                let expected = pose.position(joint).unwrap().as_dvec3() * 100.0;
                let expected = DVec3::new(-expected.x, expected.y, -expected.z);
                let error = positions[node].distance(expected);
                assert!(error < 0.001, "{side} {joint} {frame}: {error} cm");
            }
        }
    }
}

/// Returns where the right shoulder is to the left of the origin in each frame, in centimetres.
fn frames(poses: &[HandPose], rate_hz: f64) -> Vec<i64> {
    let bvh = Bvh::parse(&written(poses, rate_hz)).unwrap();
    let joints = HandJoints::find(&bvh.motion().skeleton, Side::Right).unwrap();
    let shoulder = joints.node(Joint::Shoulder).unwrap();
    let x = |frame| {
        bvh.positions(frame, PositionChannels::Add)[shoulder]
            .x
            .round() as i64
    };
    (0..bvh.motion().frame_count).map(x).collect()
}

#[test]
fn frames_are_the_latest_poses_at_a_constant_rate() {
    let mut poses = poses(Side::Right, 5);
    assert_eq!(frames(&poses, 100.0), [0, -1, -2, -3, -4]);
    assert_eq!(frames(&poses, 200.0), [0, 0, -1, -1, -2, -2, -3, -3, -4]);
    assert_eq!(frames(&poses, 50.0), [0, -2, -4]);
    // A gap of an hour becomes one of 2 s.
    poses[4].time = Timestamp(3_600_000_000);
    assert_eq!(frames(&poses, 10.0).len(), 22);
    assert!(written(&[], 100.0).is_empty());
}

#[test]
fn a_hand_that_is_nowhere_keeps_its_last_pose() {
    let mut poses = poses(Side::Right, 200);
    for pose in &mut poses[120..150] {
        *pose = HandPose::new(pose.time, pose.side, pose.tip_radius);
    }
    let bvh = Bvh::parse(&written(&poses, 100.0)).unwrap();
    assert_eq!(bvh.motion().frame_count, 200);
    let positions = |frame| bvh.positions(frame, PositionChannels::Add);
    let last = positions(119);
    assert!((120..150).all(|frame| positions(frame) == last));
    assert_ne!(positions(150), last);
}

#[test]
fn a_hand_that_is_not_known_in_most_poses_stays_where_it_was() {
    let mut poses = poses(Side::Right, 12);
    for index in [0, 1, 4, 5, 6, 7, 8, 9, 10] {
        let pose = &mut poses[index];
        *pose = HandPose::new(pose.time, pose.side, pose.tip_radius);
    }
    let expected = [-2, -3, -3, -3, -3, -3, -3, -3, -3, -11];
    assert_eq!(frames(&poses, 100.0), expected);
    assert!(written(&poses[4..11], 100.0).is_empty());
}

#[test]
fn both_hands_are_in_one_file_below_the_hips_and_the_first_pose_does_not_decide() {
    let sides = [Side::Left, Side::Right].map(|side| poses(side, 150));
    let mut both = Vec::new();
    for (left, right) in sides[0].iter().zip(&sides[1]) {
        for pose in [left, right] {
            let shift = if pose.side == Side::Left { -0.19 } else { 0.19 };
            let mut moved = *pose;
            for (joint, at) in pose.known() {
                let mut at = *at;
                at.translation += Vec3::X * shift;
                moved.set(joint, at);
            }
            both.push(moved);
        }
    }
    let exact = both.clone();
    // A bad first pose of each hand: a forearm of a fifth of its length.
    for pose in &mut both[..2] {
        let elbow = pose.position(Joint::Elbow).unwrap();
        let mut wrist = *pose.get(Joint::Wrist).unwrap();
        wrist.translation = elbow.lerp(wrist.translation, 0.2);
        pose.set(Joint::Wrist, wrist);
    }
    for order in [EulerOrder::Zxy, EulerOrder::Xyz, EulerOrder::Yzx] {
        let mut file = Cursor::new(Vec::new());
        let mut options = PoseOptions::new(100.0);
        options.order = order;
        let mut writer = PoseWriter::new(&mut file, options);
        for pose in &both {
            writer.push(pose).unwrap();
        }
        writer.finish().unwrap();
        let bvh = Bvh::parse(&file.into_inner()).unwrap();
        let skeleton = &bvh.motion().skeleton;
        let nodes = skeleton.nodes();
        assert_eq!(nodes[0].name.as_deref(), Some("Hips"));
        let mut rest = Vec::new();
        skeleton.world_poses(
            &vec![0.0; skeleton.channel_count()],
            PositionChannels::Add,
            &mut rest,
        );
        for (side, outwards) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
            let joints = HandJoints::find(skeleton, side).unwrap();
            assert_eq!(joints.iter().count(), Joint::COUNT);
            let at = |joint| rest[joints.node(joint).unwrap()].position;
            // The T pose: the arm to its side, the palm down, the thumb to the front.
            let arm = at(Joint::MiddleTip) - at(Joint::Shoulder);
            assert!(
                arm.x * outwards > 60.0 && arm.y.abs() < 4.0 && arm.z.abs() < 4.0,
                "{arm}"
            );
            assert!(at(Joint::ThumbTip).z > at(Joint::LittleTip).z + 5.0);
            let forearm = at(Joint::Elbow).distance(at(Joint::Wrist));
            assert!((forearm - 25.5).abs() < 0.01, "{forearm}");
            let own = exact.iter().filter(|pose| pose.side == side);
            // The frames after the first one have both hands.
            for (frame, pose) in own.enumerate().skip(1) {
                let positions = bvh.positions(frame as u64, PositionChannels::Add);
                for (joint, node) in joints.iter() {
                    let expected = pose.position(joint).unwrap().as_dvec3() * 100.0;
                    let expected = DVec3::new(-expected.x, expected.y, -expected.z);
                    let error = positions[node].distance(expected);
                    assert!(error < 0.002, "{order} {side} {joint} {frame}: {error} cm");
                }
            }
        }
    }
    let mut file = Cursor::new(Vec::new());
    let mut options = PoseOptions::new(100.0);
    options.side = Some(Side::Left);
    let mut writer = PoseWriter::new(&mut file, options);
    for pose in &both {
        writer.push(pose).unwrap();
    }
    writer.finish().unwrap();
    let bvh = Bvh::parse(&file.into_inner()).unwrap();
    assert!(HandJoints::find(&bvh.motion().skeleton, Side::Left).is_ok());
    assert!(HandJoints::find(&bvh.motion().skeleton, Side::Right).is_err());
}

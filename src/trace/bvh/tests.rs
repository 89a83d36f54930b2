//! Tests of written poses.

use std::io::Cursor;

use glam::DVec3;
use parry3d::math::{Pose, Vec3};

use super::*;
use crate::capture::bvh::{Bvh, HandJoints, PositionChannels};
use crate::estimate::{Estimate, JointAngles, JointLimits};
use crate::hand::{Dof, Joint};
use crate::kinematics::{ArmModel, BoneLengths};

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
    let mut writer = PoseWriter::new(&mut file, rate_hz);
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

#[test]
fn frames_are_the_latest_poses_at_a_constant_rate() {
    let mut poses = poses(Side::Right, 5);
    let frames = |poses: &[HandPose], rate| {
        let bvh = Bvh::parse(&written(poses, rate)).unwrap();
        let frames = (0..bvh.motion().frame_count).map(|frame| bvh.frame(frame)[0].round() as i64);
        frames.collect::<Vec<_>>()
    };
    assert_eq!(frames(&poses, 100.0), [0, -1, -2, -3, -4]);
    assert_eq!(frames(&poses, 200.0), [0, 0, -1, -1, -2, -2, -3, -3, -4]);
    assert_eq!(frames(&poses, 50.0), [0, -2, -4]);
    // A gap of an hour becomes one of 2 s.
    poses[4].time = Timestamp(3_600_000_000);
    assert_eq!(frames(&poses, 10.0).len(), 22);
    assert!(written(&[], 100.0).is_empty());
}

//! Joint angles from the positions of joints.

use std::time::Duration;

use ademan::capture::{Reading, Sample};
use ademan::device::{EventKind, Events};
use ademan::estimate::{
    Estimate, Estimator, EstimatorSettings, JointAngles, JointLimits, Rejection, Smoothing,
    hand_angles,
};
use ademan::hand::{Dof, Finger, Joint, JointPositions, Side};
use ademan::kinematics::{ArmModel, BoneLengths};
use ademan::setup::Setup;
use ademan::time::Timestamp;

use crate::support::source::typing_poses;

fn model(side: Side) -> ArmModel {
    let bones = BoneLengths::from_hand_and_forearm(0.190, 0.255).expect("a human arm");
    ArmModel::anthropometric(side, &bones).expect("a valid model")
}

#[test]
fn the_angles_of_an_arm_model_come_back_from_its_joint_positions() {
    let limits = JointLimits::human();
    for side in [Side::Left, Side::Right] {
        for round in 0..300 {
            let mut angles = JointAngles::default();
            for (index, &dof) in Dof::ALL.iter().enumerate() {
                let (low, high) = limits.range(dof);
                let t = (round as f64 * 0.618_034 * (index + 1) as f64).fract();
                angles.set(dof, low + (0.05 + 0.9 * t) * (high - low));
            }
            angles.set(Dof::ShoulderY, angles.get(Dof::ShoulderY) / 2.1);
            let pose = model(side).forward(&Estimate::new(Timestamp(0), angles));
            let found = hand_angles(&pose.positions(), side);
            for (dof, radians) in found.known() {
                // The elbow of the model bends towards the little finger, not away from the palm.
                if dof == Dof::ForearmSupination {
                    continue;
                }
                let error = (radians - angles.get(dof)).abs();
                assert!(
                    error < 2e-3,
                    "{side} {round} {dof}: {radians} {}",
                    angles.get(dof)
                );
            }
            let fingers = Dof::ALL.iter().filter(|dof| dof.finger().is_some());
            assert!(fingers.clone().all(|&dof| found.is_known(dof)));
        }
    }
}

#[test]
fn supination_is_zero_with_the_palm_on_a_table_and_positive_with_the_palm_turned_up() {
    // Upper arm down, forearm forward; the index knuckle is towards the other hand, then up, then outside.
    for (side, sign) in [(Side::Right, 1.0), (Side::Left, -1.0)] {
        for (across, degrees) in [([-1.0, 0.0], 0.0), ([0.0, 1.0], 90.0), ([1.0, 0.0], 180.0)] {
            let mut positions = JointPositions::default();
            let mut set = |joint, x: f64, y: f64, z: f64| {
                positions.set(joint, glam::DVec3::new(x * sign, y, z));
            };
            set(Joint::Shoulder, 0.0, 0.3, 0.0);
            set(Joint::Elbow, 0.0, 0.0, 0.0);
            set(Joint::Wrist, 0.0, 0.0, -0.25);
            let [x, y] = across;
            set(Joint::IndexPhalanxProximal, 0.03 * x, 0.03 * y, -0.34);
            set(Joint::LittlePhalanxProximal, -0.03 * x, -0.03 * y, -0.34);
            let angles = hand_angles(&positions, side);
            let found = angles.get(Dof::ForearmSupination).to_degrees();
            let difference = (found - degrees).rem_euclid(360.0);
            assert!(difference.min(360.0 - difference) < 1e-6, "{side}: {found}");
            let flexion = angles.get(Dof::ElbowFlexion).to_degrees();
            assert!((flexion - 90.0).abs() < 1e-9, "{flexion}");
        }
    }
}

/// Returns a reading of a hand that is displaced to the right.
fn reading(milliseconds: u64, right: f64) -> Reading {
    let estimate = Estimate::new(Timestamp(0), JointAngles::default());
    let mut moved = JointPositions::default();
    for (joint, position) in model(Side::Right).forward(&estimate).positions().known() {
        moved.set(joint, position + glam::DVec3::X * right);
    }
    reading_at(Timestamp(milliseconds * 1000), moved)
}

fn reading_at(time: Timestamp, positions: JointPositions) -> Reading {
    Reading::new(time, Some(Side::Right), Sample::Joints { positions })
}

#[test]
fn a_hand_that_appears_elsewhere_is_rejected_until_three_readings_agree() {
    let settings = EstimatorSettings {
        smoothing: Smoothing::Off,
        ..EstimatorSettings::default()
    };
    let mut estimator = Estimator::new(settings);
    let mut update = |milliseconds, right| {
        let estimate = estimator.update(&reading(milliseconds, right));
        estimate.map(|estimate| (estimate.jumped, estimate.measured.get(Joint::IndexTip)))
    };
    let Ok((false, Some(start))) = update(10, 0.0) else {
        panic!("the first reading is accepted");
    };
    let Ok((false, Some(moved))) = update(20, 0.05) else {
        panic!("5 mm per millisecond is plausible");
    };
    assert!((moved.x - start.x - 0.05).abs() < 1e-6);
    assert_eq!(update(30, 1.0), Err(Rejection::TooFast));
    assert_eq!(update(40, 1.0), Err(Rejection::TooFast));
    assert!(matches!(update(50, 1.0), Ok((true, Some(_)))));
}

#[test]
fn a_finger_that_leaves_the_view_releases_its_key_with_the_same_reading() {
    let setup = Setup::default().load_files().expect("the default setup");
    let mut pipeline = setup.pipeline();
    let mut events = Events::new();
    let (mut time, mut pressed) = (Timestamp(0), None);
    for pose in typing_poses("h") {
        events.clear();
        let reading = reading_at(pose.time, pose.positions());
        pipeline
            .step(&reading, &mut events)
            .expect("a valid reading");
        time = pose.time;
        pressed = events.iter().find_map(|event| match event.kind {
            EventKind::KeyDown(key) => Some((key, pose)),
            _ => None,
        });
        if pressed.is_some() {
            break;
        }
    }
    let (key, pose) = pressed.expect("a key is pressed");
    let mut hidden = JointPositions::default();
    for (joint, position) in pose.positions().known() {
        if joint <= Joint::Wrist {
            hidden.set(joint, position);
        }
    }
    events.clear();
    let reading = reading_at(time + Duration::from_millis(1), hidden);
    pipeline
        .step(&reading, &mut events)
        .expect("a valid reading");
    let released = events
        .iter()
        .any(|event| event.kind == EventKind::KeyUp(key));
    assert!(released, "{events:?}");
}

#[test]
fn measured_fingertips_are_the_fingertips_of_the_pose() {
    let mut estimator = Estimator::new(EstimatorSettings::default());
    let reading = reading(10, 0.5);
    let estimate = estimator.update(&reading).expect("a valid reading");
    let pose = model(Side::Right).forward(estimate);
    let Sample::Joints { positions } = reading.sample else {
        unreachable!("the reading has joint positions");
    };
    for &finger in Finger::ALL {
        let measured = positions.get(Joint::tip(finger)).expect("a tip");
        let tip = pose.fingertip(finger).expect("a tip");
        assert!(tip.as_dvec3().distance(measured) < 1e-6, "{finger}");
    }
}

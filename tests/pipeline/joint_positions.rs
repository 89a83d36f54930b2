//! Joint angles from the positions of joints.

use std::time::Duration;

use ademan::capture::protocol::{ProtocolOptions, markers};
use ademan::capture::{Reading, Sample};
use ademan::device::{EventKind, Events, KeyCode};
use ademan::estimate::{
    Estimate, Estimator, EstimatorSettings, JointAngles, JointLimits, Rejection, Smoothing,
    hand_angles,
};
use ademan::hand::{Dof, Finger, Joint, JointPositions, Side};
use ademan::kinematics::{ArmModel, BoneLengths};
use ademan::pipeline::Pipeline;
use ademan::setup::Setup;
use ademan::time::Timestamp;
use glam::{DQuat, DVec3};

use crate::camera::{Camera, hand};
use crate::support::source::typing_poses;
use crate::support::wearer::load_layout;

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

/// Returns a hand in the plane y = 0 with the palm down whose joints of a finger beyond the first bend by `bends` about an axis
/// that is turned from the axis of the palm by `tilt` about the bone, to bend across the palm, in degrees.
fn hand_with_bends(side: Side, finger: Finger, tilt: f64, bends: [f64; 2]) -> JointPositions {
    let mirrored = |point: DVec3| match side {
        Side::Right => point,
        Side::Left => point * DVec3::new(-1.0, 1.0, 1.0),
    };
    let mut positions = JointPositions::default();
    positions.set(Joint::Wrist, DVec3::ZERO);
    // The thumb of a right hand with the palm down is on its left.
    for (joint, x) in [
        (Joint::IndexPhalanxProximal, -0.02),
        (Joint::MiddlePhalanxProximal, 0.0),
        (Joint::LittlePhalanxProximal, 0.03),
    ] {
        positions.set(joint, mirrored(DVec3::new(x, 0.0, -0.09)));
    }
    let tip = Joint::tip(finger).index();
    let joints = &Joint::ALL[tip - 3..=tip];
    let mut at = match positions.get(joints[0]) {
        Some(knuckle) => mirrored(knuckle),
        None => DVec3::new(-0.02, 0.0, -0.03),
    };
    let mut bone = match finger {
        Finger::Thumb => DVec3::new(-0.6, 0.0, -0.8),
        _ => DVec3::NEG_Z,
    };
    // About it a bone turns down.
    let towards_palm = bone.cross(DVec3::NEG_Y);
    let axis = DQuat::from_axis_angle(bone, -tilt.to_radians()) * towards_palm;
    positions.set(joints[0], mirrored(at));
    for (index, &joint) in joints[1..].iter().enumerate() {
        if let Some(bend) = index.checked_sub(1).map(|index| bends[index]) {
            bone = DQuat::from_axis_angle(axis, bend.to_radians()) * bone;
        }
        at += bone * 0.03;
        positions.set(joint, mirrored(at));
    }
    positions
}

#[test]
fn the_angle_of_a_hinge_joint_is_that_of_its_bones_whatever_the_axis_of_the_palm() {
    let thumb = [Dof::ThumbMcpFlexion, Dof::ThumbIpFlexion];
    let little = [Dof::LittlePipFlexion, Dof::LittleDipFlexion];
    for side in [Side::Left, Side::Right] {
        for (finger, dofs, tilts) in [
            (Finger::Thumb, thumb, [0.0, 45.0, 90.0, 135.0]),
            (Finger::Little, little, [-70.0, -40.0, 0.0, 60.0]),
        ] {
            for tilt in tilts {
                for bends in [[5.0, 72.0], [74.0, 100.0], [13.0, -10.0]] {
                    let positions = hand_with_bends(side, finger, tilt, bends);
                    let angles = hand_angles(&positions, side);
                    for (dof, bend) in dofs.into_iter().zip(bends) {
                        let found = angles.get(dof).to_degrees();
                        assert!(
                            (found - bend).abs() < 1e-6,
                            "{side} {tilt} {dof}: {found}, not {bend}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_finger_that_is_pushed_sideways_does_not_jump_between_flexion_and_extension() {
    let angle = |tilt| {
        let positions = hand_with_bends(Side::Right, Finger::Little, tilt, [10.0, 0.0]);
        hand_angles(&positions, Side::Right)
            .get(Dof::LittlePipFlexion)
            .to_degrees()
    };
    assert!((angle(60.0) - 10.0).abs() < 1e-6);
    assert!((angle(120.0) + 10.0).abs() < 1e-6);
    for tilt in 60..120 {
        let [before, after] = [tilt, tilt + 1].map(|tilt| angle(f64::from(tilt)));
        assert!((before - after).abs() < 1.0, "{tilt}: {before} {after}");
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

/// Returns a pipeline in which the index finger presses a key, the time of the press, the key, and the positions of the joints
/// that are seen.
fn pressed(is_seen: fn(Joint) -> bool) -> (Pipeline, Timestamp, KeyCode, JointPositions) {
    let setup = Setup::default().load_files().expect("the default setup");
    let mut pipeline = setup.pipeline();
    let mut events = Events::new();
    let (mut time, mut press) = (Timestamp(0), None);
    for pose in typing_poses("h") {
        events.clear();
        let reading = reading_at(pose.time, pose.positions());
        pipeline
            .step(&reading, &mut events)
            .expect("a valid reading");
        time = pose.time;
        press = events.iter().find_map(|event| match event.kind {
            EventKind::KeyDown(key) => Some((key, pose)),
            _ => None,
        });
        if press.is_some() {
            break;
        }
    }
    let (key, pose) = press.expect("a key is pressed");
    let mut hidden = JointPositions::default();
    for (joint, position) in pose.positions().known() {
        if is_seen(joint) {
            hidden.set(joint, position);
        }
    }
    (pipeline, time, key, hidden)
}

/// Returns the number of releases of a key by the positions that are seen some milliseconds after `time`.
fn releases_after(
    pipeline: &mut Pipeline,
    time: Timestamp,
    milliseconds: u64,
    key: KeyCode,
    seen: JointPositions,
) -> usize {
    let mut events = Events::new();
    let reading = reading_at(time + Duration::from_millis(milliseconds), seen);
    pipeline
        .step(&reading, &mut events)
        .expect("a valid reading");
    let releases = events
        .iter()
        .filter(|event| event.kind == EventKind::KeyUp(key));
    releases.count()
}

#[test]
fn a_finger_that_leaves_the_view_for_two_readings_releases_its_key() {
    let (mut pipeline, time, key, hidden) = pressed(|joint| joint != Joint::IndexTip);
    // A tracker often loses a fingertip for one picture.
    assert_eq!(releases_after(&mut pipeline, time, 10, key, hidden), 0);
    assert_eq!(releases_after(&mut pipeline, time, 20, key, hidden), 1);
}

#[test]
fn fingers_that_all_leave_the_view_release_their_keys_with_the_same_reading() {
    let (mut pipeline, time, key, hidden) = pressed(|joint| joint <= Joint::Wrist);
    assert_eq!(releases_after(&mut pipeline, time, 10, key, hidden), 1);
}

#[test]
fn a_finger_that_leaves_the_view_longer_than_a_picture_releases_its_key_at_once() {
    let (mut pipeline, time, key, hidden) = pressed(|joint| joint != Joint::IndexTip);
    assert_eq!(releases_after(&mut pipeline, time, 80, key, hidden), 1);
}

#[test]
fn a_jumping_fingertip_is_untrusted_until_three_readings_agree() {
    let mut estimator = Estimator::new(EstimatorSettings::default());
    let mut untrusted = |milliseconds, up| {
        let Sample::Joints { positions } = reading(milliseconds, 0.0).sample else {
            unreachable!("the reading has joint positions");
        };
        let mut moved = positions;
        let tip = positions.get(Joint::IndexTip).expect("a tip");
        moved.set(Joint::IndexTip, tip + glam::DVec3::Z * up);
        let estimate = estimator.update(&reading_at(Timestamp(milliseconds * 1000), moved));
        let estimate = estimate.expect("one finger is no reason to reject a hand");
        assert!(!estimate.jumped);
        let untrusted = |finger: &Finger| estimate.untrusted.contains(*finger);
        Finger::ALL
            .iter()
            .copied()
            .filter(untrusted)
            .collect::<Vec<Finger>>()
    };
    assert_eq!(untrusted(10, 0.0), []);
    assert_eq!(untrusted(15, 0.02), [], "4 m/s is fast and plausible");
    // One wrong picture.
    assert_eq!(untrusted(20, 0.07), [Finger::Index]);
    assert_eq!(untrusted(25, 0.02), []);
    // Another place, for good.
    let stays = [30, 35, 40].map(|time| untrusted(time, 0.07));
    assert_eq!(stays, [[Finger::Index]; 3]);
    assert_eq!(untrusted(45, 0.07), []);
}

#[test]
fn a_hand_that_turns_fast_at_the_wrist_is_trusted() {
    let Sample::Joints { positions } = reading(1, 0.0).sample else {
        unreachable!("the reading has joint positions");
    };
    let wrist = positions.get(Joint::Wrist).expect("a wrist");
    let mut estimator = Estimator::new(EstimatorSettings::default());
    // 20 rad/s at 120 readings a second, half a turn forth and back.
    for index in 1..=60_u32 {
        let angle = (f64::from(index) / 120.0 * 20.0).sin();
        let turn = DQuat::from_rotation_y(angle);
        let mut turned = JointPositions::default();
        for (joint, position) in positions.known() {
            let is_hand = joint > Joint::Wrist;
            let moved = wrist + turn * (position - wrist);
            turned.set(joint, if is_hand { moved } else { position });
        }
        let reading = reading_at(Timestamp(u64::from(index) * 8_333), turned);
        let estimate = estimator.update(&reading);
        assert!(
            estimate.is_ok_and(|estimate| estimate.untrusted.is_empty()),
            "reading {index}"
        );
    }
}

#[test]
fn noise_of_measured_joints_and_a_shorter_straight_finger_reject_nothing() {
    let mut random = fastrand::Rng::with_seed(5);
    let mut estimator = Estimator::new(EstimatorSettings::default());
    let rate = 175;
    for index in 1..=2_000_u64 {
        let Sample::Joints { positions } = reading(1, 0.0).sample else {
            unreachable!("the reading has joint positions");
        };
        let mut noisy = JointPositions::default();
        for (joint, position) in positions.known() {
            // The sum of three uniform numbers has a standard deviation of a half: 1 mm.
            let mut normal = || (0..3).map(|_| random.f64()).sum::<f64>() - 1.5;
            let noise = glam::DVec3::new(normal(), normal(), normal()) * 2e-3;
            noisy.set(joint, position + noise);
        }
        let reading = reading_at(Timestamp(index * 1_000_000 / rate), noisy);
        let estimate = estimator.update(&reading);
        assert!(
            estimate.is_ok_and(|estimate| estimate.untrusted.is_empty()),
            "reading {index}"
        );
    }
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

/// Returns the supination that two cameras show, in degrees, of an arm whose forearm points forward and whose elbow bends up.
fn supination_of_markers(side: Side, degrees: f64) -> f64 {
    let elbow = DVec3::new(0.1, -0.3, -0.2);
    let wrist = elbow + DVec3::new(0.0, 0.0, -0.25);
    let inwards = match side {
        Side::Right => DVec3::NEG_X,
        Side::Left => DVec3::X,
    };
    // The palm faces down at 0; the thumb goes up, then outwards.
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let thumb = 0.03 * (cosine * inwards + sine * DVec3::Y);
    let places = [
        ("SHO", DVec3::new(0.1, 0.0, -0.2)),
        ("ELB", elbow),
        ("WRA", wrist + thumb),
        ("WRB", wrist - thumb),
    ];
    let letter = &side.name()[..1].to_uppercase();
    let cameras = [DVec3::new(1.5, 1.0, 0.5), DVec3::new(-1.5, 0.8, 0.7)].map(|camera| {
        let seen = places.map(|(name, place)| {
            serde_json::json!({"label": format!("{letter}{name}"), "direction": (place - camera).to_array()})
        });
        serde_json::json!({"position": camera.to_array(), "markers": seen})
    });
    let mut options = ProtocolOptions::default();
    let hand = markers::PROTOCOL
        .options
        .iter()
        .find(|option| option.name == "hand");
    options.set(hand.expect("an option"), side.name()).unwrap();
    let mut decoder = (markers::PROTOCOL.decoder)(&options);
    let mut found = None;
    let line = format!("{}\n", serde_json::json!({ "cameras": cameras }));
    decoder.push(line.as_bytes(), &mut |packet| match packet.sample {
        Sample::Joints { positions } => found = Some(hand_angles(&positions, side)),
        other => panic!("{other:?}"),
    });
    let angles = found.expect("an arm");
    assert!(angles.is_known(Dof::ForearmSupination));
    angles.get(Dof::ForearmSupination).to_degrees()
}

#[test]
fn the_markers_at_the_sides_of_the_wrist_show_the_turn_of_the_forearm() {
    for side in [Side::Right, Side::Left] {
        for degrees in [0.0, 30.0, 88.0, 150.0, 185.0] {
            let found = supination_of_markers(side, degrees);
            assert!((found - degrees).abs() < 1e-6, "{side} {degrees}: {found}");
        }
    }
}

/// A key 40 mm below the index fingertip of an arm that is held straight.
const AT_ELBOW: &str = r#"Layout(name: "arm", boards: [(
    pose: (anchor: elbow, right_mm: -20, forward_mm: 430, height_mm: -40),
    keys: [(code: "A", at_mm: (0, 0), size_mm: Box(30, 30), travel_mm: 10)],
)])"#;

/// An arm in front of a camera.
struct SeenArm {
    camera: Camera,
    tip: DVec3,
    elbow: DVec3,
}

impl SeenArm {
    fn new() -> Self {
        let source = "stdin:?protocol=openxr".parse().expect("a source");
        let setup = Setup {
            source: Some(source),
            ..Setup::default()
        };
        let tip = DVec3::new(0.1, 0.0, -0.4);
        let mut arm = Self {
            camera: Camera::new(&load_layout(AT_ELBOW, setup)),
            tip,
            elbow: tip + DVec3::new(0.02, 0.0, 0.43),
        };
        arm.show(true, 30);
        arm
    }

    /// Sends pictures, with or without the elbow.
    fn show(&mut self, is_elbow_seen: bool, pictures: usize) {
        for _ in 0..pictures {
            self.camera.advance();
            let mut positions = hand(self.tip, 0.0);
            if is_elbow_seen {
                positions.set(Joint::Elbow, self.elbow);
            }
            let is_accepted = self.camera.send(Side::Right, Sample::Joints { positions });
            assert!(is_accepted, "the hand is seen");
        }
    }

    /// Moves the fingertip in six pictures, of which one may not show the elbow.
    fn move_tip(&mut self, motion: DVec3, hidden: usize) {
        for picture in 0..6 {
            self.tip += motion / 6.0;
            self.show(picture != hidden, 1);
        }
        self.show(true, 10);
    }
}

#[test]
fn an_arm_that_moves_while_its_elbow_is_hidden_does_not_push_a_finger_into_a_key() {
    let mut arm = SeenArm::new();
    for _ in 0..5 {
        arm.tip += DVec3::NEG_Y * 0.014;
        arm.elbow += DVec3::NEG_Y * 0.014;
        arm.show(false, 1);
    }
    arm.show(true, 15);
    assert_eq!(arm.camera.keys(), "");
    for hidden in 0..6 {
        arm.move_tip(DVec3::NEG_Y * 0.05, hidden);
        arm.move_tip(DVec3::Y * 0.05, hidden);
        assert_eq!(arm.camera.keys(), "A -A", "one picture: {hidden}");
    }
}

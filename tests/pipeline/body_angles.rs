//! Head, feet and knees of recorded people as inputs of a layout.

use ademan::capture::body::{BODY_LANDMARKS, BodyLandmarks, Landmark};
use ademan::capture::{Reading, Sample};
use ademan::device::{EventKind, Events};
use ademan::estimate::{Estimator, EstimatorSettings, Smoothing};
use ademan::hand::{BodyAngle, InputValues, Side};
use ademan::layout::Layout;
use ademan::pipeline::PipelineState;
use ademan::setup::{OtherHand, Setup};
use ademan::time::Timestamp;
use glam::{DMat3, DVec3};
use serde_json::Value;

use crate::recorded_landmarks::recording;
use crate::support::checked::CheckedPipeline;
use crate::support::wearer::load_layout;

/// Landmarks of the left side that have one on the right side.
const PAIRS: [(usize, usize); 16] = [
    (1, 4),
    (2, 5),
    (3, 6),
    (7, 8),
    (9, 10),
    (11, 12),
    (13, 14),
    (15, 16),
    (17, 18),
    (19, 20),
    (21, 22),
    (23, 24),
    (25, 26),
    (27, 28),
    (29, 30),
    (31, 32),
];

type Frame = [DVec3; BODY_LANDMARKS];

/// The frames of a person who does three squats, at 5 Hz.
fn squats() -> Option<Vec<Frame>> {
    let (_, squats) = recording("tfjs_pose_squats_5fps.json")?;
    let frames = squats["frames"].as_array().expect("frames");
    let point = |point: &Value| {
        DVec3::from_array([0, 1, 2].map(|axis| point[axis].as_f64().expect("a coordinate")))
    };
    let frame = |frame: &Value| std::array::from_fn(|index| point(&frame["world"][index]));
    Some(frames.iter().map(frame).collect())
}

fn body(frame: &Frame, hidden: &[usize]) -> BodyLandmarks {
    let landmark = |(index, position): (usize, &DVec3)| Landmark {
        position: position.as_vec3().to_array(),
        confidence: if hidden.contains(&index) { 0.2 } else { 0.9 },
    };
    BodyLandmarks {
        points: frame.iter().enumerate().map(landmark).collect(),
    }
}

/// Returns the angles of one frame, not smoothed.
fn angles(frame: &Frame, hidden: &[usize]) -> InputValues {
    let settings = EstimatorSettings {
        smoothing: Smoothing::Off,
        ..Default::default()
    };
    let mut estimator = Estimator::new(settings);
    let reading = Reading::new(Timestamp(1), None, Sample::Body(body(frame, hidden)));
    estimator.update(&reading).expect("a person").inputs
}

fn degrees(values: &InputValues, angle: BodyAngle) -> f64 {
    f64::from(values.angle(angle).expect("it is seen")).to_degrees()
}

/// The angle at `b` by the law of cosines, in degrees.
fn interior_deg(frame: &Frame, [a, b, c]: [usize; 3]) -> f64 {
    let (ab, bc, ca) = (
        frame[a].distance(frame[b]),
        frame[b].distance(frame[c]),
        frame[c].distance(frame[a]),
    );
    ((ab * ab + bc * bc - ca * ca) / (2.0 * ab * bc))
        .acos()
        .to_degrees()
}

fn mirrored(frame: &Frame) -> Frame {
    let mut mirrored = frame.map(|point| DVec3::new(-point.x, point.y, point.z));
    for (left, right) in PAIRS {
        mirrored.swap(left, right);
    }
    mirrored
}

#[test]
fn knees_of_a_recorded_person_have_the_angle_of_their_three_points() {
    let Some(frames) = squats() else { return };
    for frame in &frames {
        let values = angles(frame, &[]);
        for (angle, points) in [
            (BodyAngle::LeftKneeFlexion, [23, 25, 27]),
            (BodyAngle::RightKneeFlexion, [24, 26, 28]),
        ] {
            let expected = 180.0 - interior_deg(frame, points);
            let found = degrees(&values, angle);
            assert!(
                (found - expected).abs() < 1e-3,
                "{angle} {found} {expected}"
            );
        }
        // A foot that stands is about at a right angle, and the shank leans forward in a squat.
        for angle in [BodyAngle::LeftFootPitch, BodyAngle::RightFootPitch] {
            assert!(degrees(&values, angle).abs() < 20.0);
        }
    }
}

#[test]
fn a_head_that_is_turned_about_the_trunk_has_this_yaw_and_no_other_change() {
    let Some(frames) = squats() else { return };
    let frame = &frames[0];
    let middle = |pair: [usize; 2]| (frame[pair[0]] + frame[pair[1]]) / 2.0;
    let up = (middle([11, 12]) - middle([23, 24])).normalize();
    let before = angles(frame, &[]);
    for (angle, limit) in [
        (BodyAngle::HeadYaw, 15.0),
        (BodyAngle::HeadPitch, 10.0),
        (BodyAngle::HeadRoll, 10.0),
    ] {
        assert!(
            degrees(&before, angle).abs() < limit,
            "she looks at the camera: {angle}"
        );
    }
    for turn_deg in [-60.0_f64, -20.0, 35.0] {
        // Seen from above, a turn to the right is clockwise.
        let turn = DMat3::from_axis_angle(up, -turn_deg.to_radians());
        let mut turned = *frame;
        for point in &mut turned[..=10] {
            *point = middle([7, 8]) + turn * (*point - middle([7, 8]));
        }
        let after = angles(&turned, &[]);
        let change = |angle| degrees(&after, angle) - degrees(&before, angle);
        assert!(
            (change(BodyAngle::HeadYaw) - turn_deg).abs() < 0.01,
            "{turn_deg}"
        );
        assert!(change(BodyAngle::HeadPitch).abs() < 0.01);
        assert!(change(BodyAngle::HeadRoll).abs() < 0.01);
    }
}

#[test]
fn in_a_mirror_yaw_and_roll_change_their_sign_and_the_feet_their_side() {
    let Some(frames) = squats() else { return };
    for frame in frames.iter().step_by(7) {
        let (own, other) = (angles(frame, &[]), angles(&mirrored(frame), &[]));
        for (angle, of_mirror, sign) in [
            (BodyAngle::HeadYaw, BodyAngle::HeadYaw, -1.0),
            (BodyAngle::HeadPitch, BodyAngle::HeadPitch, 1.0),
            (BodyAngle::HeadRoll, BodyAngle::HeadRoll, -1.0),
            (BodyAngle::LeftFootPitch, BodyAngle::RightFootPitch, 1.0),
            (BodyAngle::RightKneeFlexion, BodyAngle::LeftKneeFlexion, 1.0),
        ] {
            let difference = degrees(&own, angle) - sign * degrees(&other, of_mirror);
            assert!(difference.abs() < 0.01, "{angle}");
        }
    }
}

#[test]
fn an_angle_is_not_there_without_one_of_its_landmarks() {
    let Some(frames) = squats() else { return };
    for (hidden, gone) in [
        (0, BodyAngle::HeadYaw),
        (7, BodyAngle::HeadPitch),
        (12, BodyAngle::HeadRoll),
        (29, BodyAngle::LeftFootPitch),
        (32, BodyAngle::RightFootPitch),
        (25, BodyAngle::LeftKneeFlexion),
        (28, BodyAngle::RightKneeFlexion),
    ] {
        let values = angles(&frames[0], &[hidden]);
        assert_eq!(values.angle(gone), None, "{gone}");
        assert!(
            BodyAngle::ALL
                .iter()
                .any(|&angle| values.angle(angle).is_some())
        );
    }
    // The head needs no arm.
    let arms: Vec<usize> = (13..=22).collect();
    assert!(
        angles(&frames[0], &arms)
            .angle(BodyAngle::HeadYaw)
            .is_some()
    );
}

const SQUAT: &str = r#"Layout(name: "Squat", triggers: [
    (name: "Space", action: Key("Space"), when: Input(name: "right-knee-flexion", on: 70, off: 40)),
])"#;

/// Plays frames at 5 Hz and returns presses and releases with the number of the frame.
fn play(frames: &[BodyLandmarks], hands: &[Side]) -> Vec<String> {
    let setup = Setup {
        source: Some(
            "file:body?protocol=body-landmarks"
                .parse()
                .expect("a source"),
        ),
        other_hand: (hands.len() == 2).then(OtherHand::default),
        stall_timeout_ms: 1_000,
        arm_immediately: true,
        ..Setup::default()
    };
    let mut pipeline = CheckedPipeline::new(&load_layout(SQUAT, setup));
    let mut keys = Vec::new();
    for (number, body) in frames.iter().enumerate() {
        let time = Timestamp::from_seconds(1.0 + number as f64 / 5.0);
        for &side in hands {
            let side = (hands.len() == 2).then_some(side);
            let reading = Reading::new(time, side, Sample::Body(body.clone()));
            let mut events = Events::new();
            pipeline.step(&reading, &mut events).expect("a person");
            keys.extend(events.iter().filter_map(|event| match event.kind {
                EventKind::KeyDown(key) => Some(format!("{number} down {key}")),
                EventKind::KeyUp(key) => Some(format!("{number} up {key}")),
                _ => None,
            }));
        }
    }
    assert_eq!(pipeline.state(), PipelineState::Running);
    keys
}

/// The frames in which a knee is beyond 70° and back at 40°, by the law of cosines.
fn expected_keys(frames: &[Frame]) -> Vec<String> {
    let (mut is_down, mut keys) = (false, Vec::new());
    for (number, frame) in frames.iter().enumerate() {
        let flexion = 180.0 - interior_deg(frame, [24, 26, 28]);
        let (turns_on, turns_off) = (!is_down && flexion >= 70.0, is_down && flexion <= 40.0);
        if turns_on || turns_off {
            is_down = turns_on;
            keys.push(format!(
                "{number} {} Space",
                if is_down { "down" } else { "up" }
            ));
        }
    }
    keys
}

#[test]
fn each_squat_presses_a_key_once_also_with_two_hands() {
    let Some(frames) = squats() else { return };
    let bodies: Vec<BodyLandmarks> = frames.iter().map(|frame| body(frame, &[])).collect();
    let expected = expected_keys(&frames);
    assert!(expected.len() >= 5, "three squats: {expected:?}");
    let one = play(&bodies, &[Side::Right]);
    let numbers = |keys: &[String]| -> Vec<(i32, String)> {
        let split = |key: &String| {
            let (number, key) = key.split_once(' ').expect("a number");
            (number.parse().expect("a number"), key.to_owned())
        };
        keys.iter().map(split).collect()
    };
    let (found, wanted) = (numbers(&one), numbers(&expected));
    assert_eq!(found.len(), wanted.len(), "{one:?} {expected:?}");
    for ((number, key), (frame, other)) in found.iter().zip(&wanted) {
        assert_eq!(key, other);
        // The filter is behind by a frame at most.
        assert!((0..=1).contains(&(number - frame)), "{one:?} {expected:?}");
    }
    assert_eq!(play(&bodies, &[Side::Left, Side::Right]), one);
}

#[test]
fn a_leg_that_disappears_releases_the_key_and_has_to_be_seen_straight_again() {
    let Some(frames) = squats() else { return };
    let keys = expected_keys(&frames);
    let number = |key: &String| {
        key.split(' ')
            .next()
            .expect("a number")
            .parse::<usize>()
            .expect("one")
    };
    let (down, up) = (number(&keys[0]), number(&keys[1]));
    let hidden = down + 2;
    assert!(hidden + 1 < up, "{keys:?}");
    let bodies: Vec<BodyLandmarks> = frames[..=up + 1]
        .iter()
        .enumerate()
        .map(|(index, frame)| body(frame, if index == hidden { &[26] } else { &[] }))
        .collect();
    let played = play(&bodies, &[Side::Right]);
    assert_eq!(played.len(), 2, "{played:?}");
    assert_eq!(played[1], format!("{hidden} up Space"));
}

#[test]
fn wrong_inputs_are_errors_with_a_name() {
    for (when, expected) in [
        (r#"Input(name: "head-yav")"#, "did you mean `head-yaw`"),
        (
            r#"Input(name: "stick-x", on: 20, off: 10)"#,
            "`stick-x` is from -1 to 1, so 20 is never reached",
        ),
        (r#"Input(name: "head-yaw", on: 200, off: 10)"#, "-180"),
    ] {
        let text = format!(
            r#"Layout(name: "A", triggers: [(name: "T", action: Key("A"), when: {when})])"#
        );
        let error = Layout::parse(&text, "a.ron").expect_err("an error");
        assert!(error.to_string().contains(expected), "{error}");
    }
}

//! Landmarks of people that MediaPipe found in images, with angles that another program computed from them.

use std::path::{Path, PathBuf};
use std::process::Command;

use ademan::capture::Sample;
use ademan::capture::protocol::{hand_landmarks, holistic};
use ademan::estimate::arm_attributes::{ArmAttributes, HALF_POSE_ROWS, HalfPose};
use ademan::estimate::hand_angles;
use ademan::hand::{Dof, Finger, HandPart, Joint, JointPositions, Side};
use glam::DVec3;
use serde_json::Value;

use crate::support::peers::peer;

/// The tolerance of the expected angles, in degrees.
const TOLERANCE_DEG: f64 = 1e-4;

/// Returns the path of a recording and its content.
pub fn recording(name: &str) -> Option<(PathBuf, Value)> {
    let path = peer(&format!("landmarks/{name}"))?;
    let text = std::fs::read_to_string(&path).expect("a text");
    let content = serde_json::from_str(&text).expect("a file of landmarks");
    Some((path, content))
}

fn half_pose(frame: &Value) -> HalfPose {
    let rows: [DVec3; HALF_POSE_ROWS] = std::array::from_fn(|row| {
        let point = &frame["world"][11 + row];
        DVec3::from_array([0, 1, 2].map(|axis| point[axis].as_f64().expect("a coordinate")))
    });
    HalfPose::from_rows(&rows)
}

#[test]
fn elbow_angles_of_a_recorded_person_agree_with_those_of_another_program() {
    let Some((_, squats)) = recording("tfjs_pose_squats_5fps.json") else {
        return;
    };
    let frames = squats["frames"].as_array().expect("a list of frames");
    assert!(!frames.is_empty());
    for (number, frame) in frames.iter().enumerate() {
        let pose = half_pose(frame);
        for &side in Side::ALL {
            let expected = frame["expected_deg_world"][side.name()].as_f64();
            let expected = expected.expect("an angle");
            let attributes = ArmAttributes::from_landmarks(&pose, side).expect("an arm");
            let elbow = attributes.elbow_angle.to_degrees();
            let difference = (elbow - expected).abs();
            assert!(
                difference < TOLERANCE_DEG,
                "{number} {side}: {elbow}, not {expected}"
            );
            let angles = attributes.joint_angles(side).expect("a direction");
            let flexion = 180.0 - angles.get(Dof::ElbowFlexion).to_degrees();
            assert!(
                (flexion - expected).abs() < TOLERANCE_DEG,
                "{number} {side}"
            );
        }
    }
}

/// Returns the angle between the bones at a joint, in degrees: 180 if they are in line.
fn interior_angle_deg(positions: &JointPositions, joints: &[Joint]) -> f64 {
    let at = |index: usize| positions.get(joints[index]).expect("a joint");
    let (before, after) = (at(0) - at(1), at(2) - at(1));
    let sine = before.cross(after).length();
    sine.atan2(before.dot(after)).to_degrees()
}

/// Returns the lines that the bridge of the webcam sends for a file of landmarks; prints SKIPPED without Python.
fn bridge_output(path: &Path) -> Option<Vec<u8>> {
    let bridge = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/bridges/mediapipe_webcam.py"
    );
    let output = Command::new("python3")
        .arg(bridge)
        .arg("--from")
        .arg(path)
        .output();
    let Ok(output) = output else {
        println!("SKIPPED: there is no python3");
        return None;
    };
    assert!(output.status.success(), "{output:?}");
    Some(output.stdout)
}

#[test]
fn fingers_of_recorded_hands_pass_the_bridge_of_the_webcam_unchanged_and_have_the_angles_of_their_bones()
 {
    let Some((path, recorded)) = recording("mediapipe_tasks_hands.json") else {
        return;
    };
    let Some(lines) = bridge_output(&path) else {
        return;
    };
    let mut decoder = (hand_landmarks::PROTOCOL.decoder)(&Default::default());
    let mut hands = Vec::new();
    decoder.push(&lines, &mut |packet| hands.push(packet));
    let samples = recorded["samples"].as_array().expect("a list of samples");
    assert!(!samples.is_empty());
    assert_eq!(
        (hands.len(), decoder.stats().invalid.total()),
        (samples.len(), 0)
    );
    for (hand, sample) in hands.iter().zip(samples) {
        let name = &sample["name"];
        let gesture = name.as_str().expect("a name");
        assert_eq!(hand.side, Some(Side::Right), "{name}");
        let Sample::Joints { positions } = &hand.sample else {
            panic!("{name}: {hand:?}");
        };
        let angles = hand_angles(positions, Side::Right);
        for (&finger, middle_joint, dof) in [
            (&Finger::Thumb, "thumb_ip", Dof::ThumbIpFlexion),
            (&Finger::Index, "index_pip", Dof::IndexPipFlexion),
            (&Finger::Middle, "middle_pip", Dof::MiddlePipFlexion),
            (&Finger::Ring, "ring_pip", Dof::RingPipFlexion),
            (&Finger::Little, "pinky_pip", Dof::LittlePipFlexion),
        ] {
            let expected = sample["expected_deg_world"][middle_joint].as_f64();
            let expected = expected.expect("an angle");
            let found = interior_angle_deg(positions, &finger.joints()[1..]);
            assert!(
                (found - expected).abs() < TOLERANCE_DEG,
                "{name} {finger}: {found}, not {expected}"
            );
            // The thumb of a hitchhiker is bent backwards.
            let is_extended = finger == Finger::Thumb && gesture.starts_with("thumb_up");
            let bend = (180.0 - expected) * if is_extended { -1.0 } else { 1.0 };
            let flexion = angles.get(dof).to_degrees();
            assert!(
                (flexion - bend).abs() < TOLERANCE_DEG,
                "{name} {finger}: {flexion}, not {bend}"
            );
        }
    }
}

#[test]
fn a_recorded_body_and_a_recorded_hand_pass_the_bridge_in_one_line() {
    let (Some((_, squats)), Some((_, mut hands))) = (
        recording("tfjs_pose_squats_5fps.json"),
        recording("mediapipe_tasks_hands.json"),
    ) else {
        return;
    };
    let frame = &squats["frames"][0];
    let samples = hands["samples"].as_array_mut().expect("a list of samples");
    for sample in &mut *samples {
        // Some holistic models give logits in place of probabilities.
        let point = |point: &Value| serde_json::json!([point[0], point[1], point[2], 4.0]);
        let points = frame["world"].as_array().expect("a list of points");
        sample["body"] = points.iter().map(point).collect();
    }
    let count = samples.len();
    assert!(count > 0);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("whole.json");
    std::fs::write(&path, hands.to_string()).expect("a file");
    let Some(lines) = bridge_output(&path) else {
        return;
    };
    let mut decoder = (holistic::PROTOCOL.decoder)(&Default::default());
    let mut packets = Vec::new();
    decoder.push(&lines, &mut |packet| packets.push(packet));
    assert_eq!(
        (packets.len(), decoder.stats().invalid.total()),
        (2 * count, 0)
    );
    for pair in packets.chunks(2) {
        assert_eq!(pair[0].part, Some(HandPart::Arm));
        assert_eq!(pair[1].part, Some(HandPart::Fingers));
        let Sample::Body(body) = &pair[0].sample else {
            panic!("{:?}", pair[0]);
        };
        let elbow = &body.points[14];
        let expected = frame["world"][14][0].as_f64().expect("a coordinate");
        assert!((f64::from(elbow.position[0]) - expected).abs() < 1e-6);
        assert!((0.98..0.99).contains(&elbow.confidence), "{elbow:?}");
    }
}

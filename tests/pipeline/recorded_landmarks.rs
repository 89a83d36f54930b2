//! Landmarks of a person that MediaPipe found in a video, with angles that another program computed from them.
//!
//! Reads the folder `ADEMAN_PEERS` (default: `../shared/peers` beside the project), which is not part of the project.

use std::path::PathBuf;

use ademan::estimate::arm_attributes::{ArmAttributes, HALF_POSE_ROWS, HalfPose};
use ademan::hand::{Dof, Side};
use glam::DVec3;
use serde_json::Value;

/// The tolerance of the expected angles, in degrees.
const TOLERANCE_DEG: f64 = 1e-4;

fn squats() -> Option<Value> {
    let folder = match std::env::var_os("ADEMAN_PEERS") {
        Some(folder) => folder.into(),
        None => PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/peers"),
    };
    let path = folder.join("landmarks/tfjs_pose_squats_5fps.json");
    let text = std::fs::read_to_string(&path);
    if text.is_err() {
        println!("SKIPPED: there is no {}", path.display());
    }
    Some(serde_json::from_str(&text.ok()?).expect("a file of landmarks"))
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
    let Some(squats) = squats() else {
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

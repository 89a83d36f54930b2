//! Attributes of arms of which landmarks are missing.

use serde_json::Value;

use super::{NAMES, assert_close, left_arm, vectors};
use crate::{file, objects, run};

#[test]
fn missing_landmarks_cost_only_the_attributes_that_need_them() {
    let case = &vectors()[0];
    let folder = tempfile::tempdir().unwrap();
    let mut rows = case["half_pose"].clone();
    // The left index finger.
    rows[8] = Value::Null;
    let pose = file(&folder, "pose.json", rows.to_string());
    let size = format!("{},{}", case["width"], case["height"]);
    let printed = run(["arm", "attributes", &pose, "--image-size", &size]).done();
    // As Python writes it.
    let nan = rows.to_string().replace("null", "[NaN, NaN, NaN]");
    let nan = file(&folder, "nan.json", nan);
    let of_nan = run(["arm", "attributes", &nan, "--image-size", &size]).done();
    assert_eq!(of_nan.out, printed.out);
    let line = &objects(&printed.out)[0];
    let known = NAMES.iter().filter(|(reference, name)| {
        let expected = &case["attributes"][format!("left_{reference}")];
        let found = &line["left"][name];
        if !found.is_null() {
            assert_close(found, expected, 1e-6, name);
        }
        !found.is_null()
    });
    assert_eq!(
        known.count(),
        5,
        "direction, lengths, rotation and angle: {line}"
    );
    assert!(line["right"]["index_vector"].is_array());

    // Without the elbow, the hand has its vectors.
    let mut elbow_rows = case["half_pose"].clone();
    elbow_rows[2] = Value::Null;
    let elbow_pose = file(&folder, "elbow.json", elbow_rows.to_string());
    let hand = run(["arm", "attributes", &elbow_pose, "--image-size", &size]).done();
    let hand = &objects(&hand.out)[0]["left"];
    for (reference, name) in NAMES {
        if name.ends_with("_vector") {
            let expected = &case["attributes"][format!("left_{reference}")];
            assert_close(&hand[name], expected, 1e-6, name);
        } else {
            assert!(hand[name].is_null(), "{name}: {hand}");
        }
    }

    // Without the hip, the elbow and the wrist have their angles.
    let mut hip_rows = case["half_pose"].clone();
    hip_rows[12] = Value::Null;
    let hip_pose = file(&folder, "hip.json", hip_rows.to_string());
    let without_hip = run(["arm", "attributes", &hip_pose, "--image-size", &size]).done();
    let without_hip = &objects(&without_hip.out)[0]["left"];
    for (reference, name) in NAMES {
        if ["shoulder_direction", "shoulder_rotation", "elbow_rotation"].contains(&name) {
            assert!(without_hip[name].is_null(), "{name}: {without_hip}");
        } else {
            let expected = &case["attributes"][format!("left_{reference}")];
            assert_close(&without_hip[name], expected, 1e-6, name);
        }
    }
    let back = file(&folder, "attributes.jsonl", &printed.out);
    let refused = run(["arm", "landmarks", &back]).exited(2);
    refused.reported("of the left arm is null");
}

#[test]
fn a_signed_rotation_keeps_its_sign_without_the_hand() {
    let cases = vectors();
    let mut poses = cases.iter();
    let case = poses.find(|case| case["name"] == "past_full_rotation");
    let case = case.expect("a pose past the full rotation");
    let folder = tempfile::tempdir().unwrap();
    let mut rows = case["half_pose"].clone();
    let whole = rows.to_string();
    // Both index fingers.
    (rows[8], rows[9]) = (Value::Null, Value::Null);
    let path = file(&folder, "poses.jsonl", format!("{whole}\n{rows}\n"));
    let size = format!("{},{}", case["width"], case["height"]);
    let printed = run([
        "arm",
        "attributes",
        &path,
        "--signed",
        "--image-size",
        &size,
    ]);
    let found = objects(&printed.done().out);
    assert_eq!(found.len(), 2);
    let rotation = |line: usize, side: &str| {
        let rotation = &found[line][side]["shoulder_rotation"];
        rotation.as_f64().expect("a number")
    };
    let sides = ["left", "right"];
    assert!(sides.iter().any(|side| rotation(0, side) < 0.0));
    for side in sides {
        let (seen, hidden) = (rotation(0, side), rotation(1, side));
        assert!((seen - hidden).abs() < 1e-9, "{side}: {seen} {hidden}");
    }
}

#[test]
fn a_straight_or_folded_arm_without_its_hand_has_no_shoulder_rotation() {
    let folder = tempfile::tempdir().unwrap();
    let straight = Some(std::f64::consts::PI);
    let wrists = [
        ([0.2, 0.05, 0.0], straight, false),
        ([0.2 + 1e-7, 0.05, 0.0], straight, false),
        ([0.2 - 1e-7, 0.05, 0.0], straight, false),
        ([0.2, 0.05, 1e-4], straight, false),
        ([0.2, -0.45, 0.0], Some(0.0), false),
        ([0.4, -0.2, 0.0], Some(std::f64::consts::FRAC_PI_2), true),
        // No forearm.
        ([0.2, -0.2, 0.0], None, false),
    ];
    let poses = wrists.map(|(wrist, ..)| left_arm(wrist).to_string());
    let poses = file(&folder, "poses.jsonl", poses.join("\n"));
    let printed = run(["arm", "attributes", &poses]).done();
    let found = objects(&printed.out);
    assert_eq!(found.len(), wrists.len());
    for (line, (wrist, angle, has_rotation)) in found.iter().zip(wrists) {
        let left = &line["left"];
        let rotation = &left["shoulder_rotation"];
        assert_eq!(rotation.is_number(), has_rotation, "{wrist:?}: {left}");
        match angle {
            Some(angle) => assert_close(&left["elbow_angle"], &angle.into(), 1e-9, "elbow"),
            None => {
                assert!(left["elbow_angle"].is_null(), "{left}");
                assert!(left["forearm_length"].is_null(), "{left}");
            }
        }
    }
}

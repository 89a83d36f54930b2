//! Joint angles of a body of twelve points, and back.

use std::path::Path;

use serde_json::Value;

use crate::{file, run};

fn vectors() -> Vec<Value> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors/tpose_angles.json");
    let text = std::fs::read_to_string(path).expect("the vectors are in the repository");
    let vectors: Value = serde_json::from_str(&text).expect("vectors are JSON");
    let cases = vectors["cases"].as_array().expect("a list of cases").iter();
    let with_angles = cases.filter(|case| case["zxy_degrees"].is_object());
    with_angles.cloned().collect()
}

fn lines(text: &str) -> Vec<Value> {
    let lines = text.lines();
    lines
        .map(|line| serde_json::from_str(line).expect("a line of JSON"))
        .collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list").iter();
    list.map(|number| number.as_f64().expect("a number"))
        .collect()
}

#[test]
fn angles_are_those_of_the_reference_and_give_the_positions_back_in_every_order() {
    let folder = tempfile::tempdir().unwrap();
    let cases = vectors();
    assert!(cases.len() > 5, "{} cases", cases.len());
    let poses: Vec<String> = cases
        .iter()
        .map(|case| case["points"].to_string())
        .collect();
    let poses = file(&folder, "poses.jsonl", poses.join("\n"));
    let printed = run(["body", "angles", poses.as_str(), "--check"]).done();
    assert!(
        printed.err.contains("poses; the positions"),
        "{}",
        printed.err
    );
    for (line, case) in lines(&printed.out).iter().zip(&cases) {
        let joints = case["zxy_degrees"].as_object().expect("joints");
        assert_eq!(joints.len(), 11);
        for (joint, expected) in joints {
            let found = numbers(&line["angles_deg"][joint.replace('_', "-")]);
            for (found, expected) in found.iter().zip(numbers(expected)) {
                let difference = (found - expected).rem_euclid(360.0);
                let difference = difference.min(360.0 - difference);
                assert!(difference < 1e-6, "{} {joint}: {found}", case["name"]);
            }
        }
    }
    for order in ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"] {
        let printed = run(["body", "angles", poses.as_str(), "--order", order]).done();
        let name = format!("{order}.jsonl");
        let angles = file(&folder, &name, &printed.out);
        let back = lines(&run(["body", "positions", angles.as_str()]).done().out);
        assert_eq!(back.len(), cases.len());
        for (back, case) in back.iter().zip(&cases) {
            for (point, expected) in case["points"].as_object().expect("points") {
                let found = numbers(&back[point.replace('_', "-")]);
                for (found, expected) in found.iter().zip(numbers(expected)) {
                    assert!((found - expected).abs() < 1e-8, "{order} {point}");
                }
            }
        }
    }
}

#[test]
fn a_pose_without_a_point_is_refused_by_its_name_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let mut pose = vectors()[0]["points"].clone();
    let whole = pose.to_string();
    pose.as_object_mut().unwrap().remove("left_knee");
    let path = file(&folder, "poses.jsonl", format!("{whole}\n{pose}\n"));
    let ended = run(["body", "angles", path.as_str()]);
    assert_eq!(ended.code, Some(2));
    let expected = ":2: the pose lacks the position of `left-knee`";
    assert!(ended.err.contains(expected), "{}", ended.err);
}

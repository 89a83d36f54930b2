//! Attributes of arms from landmarks, and movements between postures.

mod missing;

use std::path::Path;

use serde_json::{Value, json};

use crate::support::peers::peer;
use crate::text_line::pressed_keys;
use crate::{file, objects, run, run_in, text};

/// The names of attributes in the vectors, and here.
const NAMES: [(&str, &str); 11] = [
    ("shoulder_direction", "shoulder_direction"),
    ("upperarm_length", "upper_arm_length"),
    ("shoulder_rotation", "shoulder_rotation"),
    ("elbow_angle", "elbow_angle"),
    ("forearm_length", "forearm_length"),
    ("elbow_rotation", "elbow_rotation"),
    ("wrist_rotation", "wrist_rotation"),
    ("wrist_inclination", "wrist_inclination"),
    ("pinky_vector", "little_vector"),
    ("index_vector", "index_vector"),
    ("thumb_vector", "thumb_vector"),
];

fn vectors() -> Vec<Value> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors/arm_attributes.json");
    let text = std::fs::read_to_string(path).expect("the vectors are in the repository");
    let vectors: Value = serde_json::from_str(&text).expect("vectors are JSON");
    let cases = vectors["cases"].as_array().expect("a list of cases").iter();
    let is_pose = |case: &&Value| case["kind"] == "pose_to_attributes";
    cases.filter(is_pose).cloned().collect()
}

fn assert_close(found: &Value, expected: &Value, tolerance: f64, what: &str) {
    let numbers = |value: &Value| match value.as_array() {
        Some(list) => list.iter().filter_map(Value::as_f64).collect(),
        None => vec![value.as_f64().unwrap_or(f64::NAN)],
    };
    let (found, expected) = (numbers(found), numbers(expected));
    assert_eq!(found.len(), expected.len(), "{what}");
    for (number, wanted) in found.iter().zip(&expected) {
        let tolerance = tolerance * (1.0 + wanted.abs());
        assert!(
            (number - wanted).abs() <= tolerance,
            "{what}: {number} instead of {wanted}"
        );
    }
}

#[test]
fn normalized_landmarks_have_the_attributes_of_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let cases = vectors();
    assert!(cases.len() > 30, "{} cases", cases.len());
    for case in cases {
        let size = format!("{},{}", case["width"], case["height"]);
        let pose = file(&folder, "pose.json", case["half_pose"].to_string());
        let printed = run(["arm", "attributes", &pose, "--image-size", &size]).done();
        let line = &objects(&printed.out)[0];
        std::fs::remove_file(&pose).unwrap();
        if !case["attributes"].is_object() {
            // The reference refuses the pose: here what it does not determine is null.
            let arms = [&line["left"], &line["right"]];
            let is_unknown = |arm: &&Value| arm["elbow_rotation"].is_null();
            assert!(arms.iter().any(is_unknown), "{}", case["name"]);
            continue;
        }
        for side in ["left", "right"] {
            for (reference, name) in NAMES {
                let expected = &case["attributes"][format!("{side}_{reference}")];
                let what = format!("{} {side} {name}", case["name"]);
                assert_close(&line[side][name], expected, 1e-6, &what);
            }
        }
    }
}

/// Returns the landmarks of a recorded person in metres, frame by frame, as lines.
fn squats() -> Option<Vec<String>> {
    let path = peer("landmarks/tfjs_pose_squats_5fps.json")?;
    let text = std::fs::read_to_string(path).expect("a text");
    let recording: Value = serde_json::from_str(&text).expect("a file of landmarks");
    let frames = recording["frames"].as_array().expect("a list of frames");
    let line = |frame: &Value| json!({ "pose_world_landmarks": frame["world"] }).to_string();
    Some(frames.iter().map(line).collect())
}

fn point(pose: &Value, row: usize) -> [f64; 3] {
    [0, 1, 2].map(|axis| {
        pose["pose_world_landmarks"][row][axis]
            .as_f64()
            .expect("a number")
    })
}

fn distance(pose: &Value, from: usize, to: usize) -> f64 {
    let (from, to) = (point(pose, from), point(pose, to));
    let squares = from.iter().zip(to).map(|(from, to)| (from - to).powi(2));
    squares.sum::<f64>().sqrt()
}

#[test]
fn signed_attributes_give_the_landmarks_of_a_recorded_person_back() {
    let Some(squats) = squats() else { return };
    let folder = tempfile::tempdir().unwrap();
    let poses = file(&folder, "poses.jsonl", squats.join("\n"));
    let attributes = run(["arm", "attributes", &poses, "--signed"]).done();
    let attributes = file(&folder, "attributes.jsonl", &attributes.out);
    let back = objects(&run(["arm", "landmarks", &attributes]).done().out);
    assert_eq!(back.len(), squats.len());
    for (pose, line) in back.iter().zip(&squats) {
        let original: Value = serde_json::from_str(line).unwrap();
        for row in 11..25 {
            for (found, expected) in point(pose, row).iter().zip(point(&original, row)) {
                assert!((found - expected).abs() < 1e-9, "row {row}");
            }
        }
    }
}

#[test]
fn a_movement_joins_its_postures_and_no_bone_shrinks_on_the_way() {
    let Some(squats) = squats() else { return };
    let folder = tempfile::tempdir().unwrap();
    let start = file(&folder, "start.jsonl", &squats[0]);
    let end = file(&folder, "end.jsonl", &squats[12]);
    let movement = folder.path().join("movement.jsonl");
    let made = ["arm", "between", &start, &end, "--ms", "500", "--output"];
    let written = run(made.into_iter().chain([text(&movement)])).done();
    assert_eq!(written.err, format!("wrote {}\n", movement.display()));
    let poses = objects(&std::fs::read_to_string(&movement).unwrap());
    assert_eq!(poses.len(), 31);
    let ends = [&squats[0], &squats[12]].map(|line| serde_json::from_str::<Value>(line).unwrap());
    for (pose, original) in [(&poses[0], &ends[0]), (&poses[30], &ends[1])] {
        (11..25).for_each(|row| assert_eq!(point(pose, row), point(original, row)));
    }
    for (from, to) in [(11, 13), (13, 15), (12, 14), (14, 16)] {
        let ends = ends.each_ref().map(|pose| distance(pose, from, to));
        let (shortest, longest) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        for pose in &poses {
            let length = distance(pose, from, to);
            assert!(length > shortest - 1e-9 && length < longest + 1e-9);
        }
    }

    let source = format!("file:{}?protocol=body-landmarks", text(&movement));
    let angles = run(["trace", "angles", "--source", &source]).done();
    assert!(objects(&angles.out).len() >= 31, "{}", angles.err);
    let typed = run(["run", "--source", &source, "--output", "transcript"]).done();
    assert!(pressed_keys(&typed.out).is_empty(), "{}", typed.out);

    let again = run(["arm", "between", &start, &end, "--output", text(&movement)]);
    assert_eq!(again.code, Some(2), "an existing file is replaced");
    #[cfg(unix)]
    {
        let large = folder.path().join("large.jsonl");
        let too_large = ["arm", "between", &start, &end, "--output", text(&large)];
        let full = super::lab::run_with_small_files(&too_large).exited(1);
        full.reported("large.jsonl");
        assert!(!large.exists(), "a part of the movement is left");
    }
}

#[test]
fn a_file_of_attributes_or_landmarks_is_named_on_standard_error() {
    let folder = tempfile::tempdir().unwrap();
    let case = &vectors()[0];
    let pose = file(&folder, "pose.json", case["half_pose"].to_string());
    let path = |name: &str| text(&folder.path().join(name)).to_owned();
    let (attributes, poses) = (path("attributes.jsonl"), path("poses.jsonl"));
    for (action, from, to) in [
        ("attributes", &pose, &attributes),
        ("landmarks", &attributes, &poses),
    ] {
        let ended = run(["arm", action, from.as_str(), "--output", to.as_str()]).done();
        assert_eq!(
            (ended.out, ended.err),
            (String::new(), format!("wrote {to}\n"))
        );
        assert_eq!(objects(&std::fs::read_to_string(to).unwrap()).len(), 1);
    }
    let print = ["arm", "landmarks", attributes.as_str(), "--output", "-"];
    let printed = run_in(folder.path(), print);
    assert_eq!(printed.err, "");
    assert_eq!(printed.out, std::fs::read_to_string(&poses).unwrap());
    assert!(!folder.path().join("-").exists());
}

#[test]
fn a_file_without_poses_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let good = vectors()[0]["half_pose"].to_string();
    for (content, expected) in [
        (
            format!("{good}\n1,2,3\n"),
            ":2: neither JSON nor comma-separated numbers",
        ),
        (
            "[[0,0,0]]".to_owned(),
            ":1: 1 landmarks; a pose has 33, a half pose 14",
        ),
        (
            format!("[{good},{good}]"),
            ":1: a list of 2 poses; write each pose on a line of its own",
        ),
        ("{\"a\":1}".to_owned(), ":1: a pose is a list of landmarks"),
        ("\n\n".to_owned(), "holds no pose"),
    ] {
        let path = file(&folder, "bad.txt", &content);
        let ended = run(["arm", "attributes", &path]);
        assert_eq!(ended.code, Some(2), "{content}");
        ended.reported(expected);
        std::fs::remove_file(&path).unwrap();
    }
}

#[test]
fn comma_separated_values_have_a_column_for_each_number() {
    let case = &vectors()[0];
    let folder = tempfile::tempdir().unwrap();
    let rows = case["half_pose"].as_array().unwrap();
    let numbers: Vec<String> = rows
        .iter()
        .flat_map(|row| row.as_array().unwrap().iter().map(Value::to_string))
        .collect();
    let pose = file(&folder, "pose.csv", numbers.join(","));
    let printed = run(["arm", "attributes", &pose, "--csv"]).done();
    let decimal_commas = numbers.join(";").replace('.', ",");
    for (name, content) in [
        ("semicolons", numbers.join(";")),
        ("tabs", numbers.join("\t")),
        ("blanks", numbers.join(" ")),
        ("decimal-commas", decimal_commas),
    ] {
        let other = file(&folder, name, content + "\n");
        let read = run(["arm", "attributes", &other, "--csv"]).done();
        assert_eq!(read.out, printed.out, "{name}");
    }
    let printed_rows: Vec<Vec<&str>> = printed
        .out
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    assert_eq!(printed_rows.len(), 2);
    assert_eq!(printed_rows[0].len(), 1 + 2 * (7 + 4 * 3));
    assert_eq!(printed_rows[1].len(), printed_rows[0].len());
    assert_eq!(printed_rows[0][4], "left_upper_arm_length");
    assert!(
        printed_rows[1][1..]
            .iter()
            .all(|field| field.parse::<f64>().is_ok())
    );
}

#[test]
fn results_of_mediapipe_for_javascript_are_read_in_world_coordinates() {
    let case = &vectors()[0];
    let folder = tempfile::tempdir().unwrap();
    let rows = case["half_pose"].as_array().unwrap();
    let points = rows.iter();
    let points = points.map(|row| json!({"x": row[0], "y": row[1], "z": row[2]}));
    let person = points.collect::<Vec<Value>>();
    let result = json!({"landmarks": [[{"x": 0.0}]], "worldLandmarks": [person]});
    let nobody = json!({"landmarks": [], "worldLandmarks": []});
    let plain = file(&folder, "plain.json", case["half_pose"].to_string());
    let lines_of = file(&folder, "results.jsonl", format!("{result}\n{nobody}\n"));
    let expected = run(["arm", "attributes", &plain]).done();
    let printed = run(["arm", "attributes", &lines_of]).done();
    assert_eq!(printed.out, expected.out);
    printed.reported("1 of 2 lines");
}

/// Returns a line of landmarks of a person whose left wrist is at `wrist`, and whose left hand is hidden.
fn left_arm(wrist: [f64; 3]) -> Value {
    json!([
        [0.2, -0.5, 0.0],
        [-0.2, -0.5, 0.0],
        [0.2, -0.2, 0.0],
        [-0.2, -0.2, 0.0],
        wrist,
        [-0.2, 0.05, 0.0],
        null,
        [-0.22, 0.12, 0.02],
        null,
        [-0.18, 0.12, 0.02],
        null,
        [-0.16, 0.08, 0.0],
        [0.1, 0.0, 0.0],
        [-0.1, 0.0, 0.0]
    ])
}

#[test]
fn lines_that_show_nobody_are_counted_and_a_movement_names_the_landmark_that_it_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let pose = left_arm([0.4, -0.2, 0.0]);
    // Some programs begin a text with a mark of its encoding.
    let text =
        format!("\u{feff}{pose}\n{{\"pose_world_landmarks\":null}}\n{{\"pose_landmarks\":[]}}\n");
    let poses = file(&folder, "poses.jsonl", text);
    let printed = run(["arm", "attributes", &poses]).done();
    assert_eq!(printed.out.lines().count(), 1);
    printed.reported("2 of 3 lines of");

    let refused = run(["arm", "between", &poses, &poses]).exited(2);
    refused.reported("lacks the landmark `left-little`");

    let fraction = file(
        &folder,
        "fraction.jsonl",
        format!("{{\"time_us\":1.5,\"pose_landmarks\":{pose}}}"),
    );
    let timed = run(["arm", "attributes", &fraction]).exited(2);
    timed.reported("`time_us` is 1.5");
}

#[test]
fn attributes_out_of_their_ranges_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let pose = file(&folder, "pose.json", vectors()[0]["half_pose"].to_string());
    let printed = run(["arm", "attributes", &pose, "--signed"]).done();
    let good = &objects(&printed.out)[0];
    for (name, value, reason) in [
        (
            "shoulder_direction",
            json!([2.0, 0.0, 0.0]),
            "has the length 2",
        ),
        (
            "elbow_angle",
            json!(132.6),
            "is 132.6; it is in radians, 0.0000 to 3.1416",
        ),
        (
            "shoulder_rotation",
            json!(60),
            "is 60; it is in radians, -3.1416 to 3.1416",
        ),
        (
            "forearm_length",
            json!(-0.3),
            "is -0.3; a length is more than 0",
        ),
        ("upper_arm_length", json!(1e308), "is 1000000"),
        (
            "wrist_inclination",
            json!(-0.1),
            "is -0.1; it is in radians",
        ),
    ] {
        let mut line = good.clone();
        line["left"][name] = value;
        let path = file(&folder, &format!("{name}.jsonl"), line.to_string());
        let refused = run(["arm", "landmarks", &path]);
        assert_eq!(refused.code, Some(2), "{name}");
        refused.reported(&format!("`{name}` of the left arm {reason}"));
    }
}

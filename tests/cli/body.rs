//! Joint angles of a body of twelve points, and back.

use std::path::Path;

use serde_json::{Value, json};

use crate::{file, numbers, objects, run, text};

fn vectors() -> Vec<Value> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors/tpose_angles.json");
    let text = std::fs::read_to_string(path).expect("the vectors are in the repository");
    let vectors: Value = serde_json::from_str(&text).expect("vectors are JSON");
    let cases = vectors["cases"].as_array().expect("a list of cases").iter();
    let with_angles = cases.filter(|case| case["zxy_degrees"].is_object());
    with_angles.cloned().collect()
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
    printed.reported("poses; the positions");
    for (line, case) in objects(&printed.out).iter().zip(&cases) {
        let joints = case["zxy_degrees"].as_object().expect("joints");
        assert_eq!(joints.len(), 11);
        for (joint, expected) in joints {
            let found = numbers(&line["angles_deg"][joint.replace('_', "-")]);
            for (ours, theirs) in found.iter().zip(numbers(expected)) {
                let difference = (ours - theirs).rem_euclid(360.0);
                let difference = difference.min(360.0 - difference);
                assert!(difference < 1e-6, "{} {joint}: {ours}", case["name"]);
            }
        }
    }
    let orders = "xyz xzy yxz yzx zxy zyx xyx xzx yxy yzy zxz zyz";
    for order in orders.split(' ') {
        let in_order = run(["body", "angles", poses.as_str(), "--order", order]).done();
        let name = format!("{order}.jsonl");
        let angles = file(&folder, &name, &in_order.out);
        let back = objects(&run(["body", "positions", angles.as_str()]).done().out);
        assert_eq!(back.len(), cases.len());
        for (pose, case) in back.iter().zip(&cases) {
            for (point, expected) in case["points"].as_object().expect("points") {
                let found = numbers(&pose[point.replace('_', "-")]);
                for (ours, theirs) in found.iter().zip(numbers(expected)) {
                    assert!((ours - theirs).abs() < 1e-8, "{order} {point}");
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
    let ended = run(["body", "angles", path.as_str()]).exited(2);
    ended.reported(":2: the pose lacks the position of `left-knee`");
}

#[test]
fn a_pose_with_an_arm_of_no_length_is_left_out_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let mut pose = vectors()[0]["points"].clone();
    let whole = pose.to_string();
    pose["left_elbow"] = pose["left_shoulder"].clone();
    let path = file(&folder, "poses.jsonl", format!("{pose}\n{whole}\n"));
    let ended = run(["body", "angles", path.as_str()]).done();
    assert_eq!(objects(&ended.out).len(), 1);
    let expected = "1 of 2 poses have no angles and are left out; the first one is ";
    ended.reported(expected);
    // A fit gives such a bone no direction either.
    let fitted = run(["body", "angles", path.as_str(), "--fit"]).done();
    assert_eq!(objects(&fitted.out).len(), 1);
    fitted.reported(expected);
    let empty_path = file(&folder, "none.jsonl", pose.to_string());
    let empty = run(["body", "angles", empty_path.as_str()]).exited(2);
    empty.reported("no pose has angles");
}

#[test]
fn a_hidden_point_costs_its_pose_alone_and_landmarks_may_have_names() {
    let folder = tempfile::tempdir().unwrap();
    let mut pose = vectors()[0]["points"].clone();
    let whole = pose.to_string();
    pose["left_wrist"] = Value::Null;
    let nobody = r#"{"pose_world_landmarks":null}"#;
    let path = file(
        &folder,
        "poses.jsonl",
        [&whole, &pose.to_string(), &whole, nobody].join("\n"),
    );
    for options in [&[][..], &["--fit"]] {
        let angles = ["body", "angles", path.as_str()];
        let ended = run(angles.into_iter().chain(options.iter().copied())).done();
        assert_eq!(objects(&ended.out).len(), 2);
        let expected = format!(
            "2 of 4 poses have no angles and are left out; the first one is {path}:2: the pose lacks the position of `left-wrist`"
        );
        ended.reported(&expected);
    }

    let position = |row: u32| [f64::from(row) * 0.03, (f64::from(row) * 0.7).sin(), 0.1];
    let list: Vec<_> = (0..33).map(position).collect();
    let named = list.iter().map(|[x, y, z]| json!({"x": x, "y": y, "z": z}));
    let named = json!({"pose_world_landmarks": named.collect::<Vec<_>>()});
    let as_lists = file(
        &folder,
        "lists.jsonl",
        json!({"pose_world_landmarks": list}).to_string(),
    );
    let as_objects = file(&folder, "objects.jsonl", named.to_string());
    let from_objects = run(["body", "angles", as_objects.as_str()]).done().out;
    assert_eq!(
        from_objects,
        run(["body", "angles", as_lists.as_str()]).done().out
    );
}

#[test]
fn positions_keep_the_time_of_their_line_and_wrong_numbers_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut pose = vectors()[0]["points"].clone();
    pose["time_us"] = 12_500.into();
    let poses = file(&folder, "poses.jsonl", pose.to_string());
    let printed = run(["body", "angles", poses.as_str()]).done().out;
    let angles = &objects(&printed)[0];
    let positions = |name: &str, change: &dyn Fn(&mut Value)| {
        let mut line = angles.clone();
        change(&mut line);
        let path = file(&folder, name, line.to_string());
        run(["body", "positions", path.as_str()])
    };
    let lower_case = positions("order.jsonl", &|line| line["order"] = "zxy".into()).done();
    assert_eq!(objects(&lower_case.out)[0]["time_us"], 12_500);
    let negative =
        positions("hips.jsonl", &|line| line["lengths"]["hips"] = json!(-0.24)).exited(2);
    negative.reported("the length of `hips` is -0.24; a length is 0 or more");
    pose["time_us"] = json!(-5);
    let early = file(&folder, "early.jsonl", pose.to_string());
    let refused = run(["body", "angles", early.as_str()]).exited(2);
    refused.reported("`time_us` is -5");
}

/// Returns the bytes of an array of NumPy of 64-bit numbers.
fn npy(shape: &str, numbers: &[f64]) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    bytes
}

#[test]
fn an_array_of_numpy_gives_the_angles_of_its_lines_and_others_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let names = "left_hip right_hip left_knee right_knee left_foot right_foot left_shoulder right_shoulder left_elbow \
                 right_elbow left_wrist right_wrist";
    let (mut numbers_of, mut text) = (Vec::new(), String::new());
    for case in vectors().iter().take(4) {
        let points = names
            .split_whitespace()
            .map(|name| numbers(&case["points"][name]));
        let points: Vec<Vec<f64>> = points.collect();
        text += &format!("{points:?}\n");
        numbers_of.extend(points.concat());
    }
    let lines = file(&folder, "poses.jsonl", text);
    let path = folder.path().join("poses.npy");
    std::fs::write(&path, npy("(4, 12, 3)", &numbers_of)).unwrap();
    let path = path.to_str().unwrap();
    let from_array = run(["body", "angles", path]).done();
    assert_eq!(
        from_array.out,
        run(["body", "angles", lines.as_str()]).done().out
    );
    assert_eq!(from_array.out.lines().count(), 4);
    std::fs::write(path, npy("(4, 12, 3)", &numbers_of[1..])).unwrap();
    let cut = run(["body", "angles", path]).exited(2);
    cut.reported("the array is not complete");
}

#[test]
fn fitted_bones_have_one_length_in_every_pose() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = fastrand::Rng::with_seed(5);
    let case = vectors()[0]["points"].clone();
    let mut text = String::new();
    for _ in 0..60 {
        let mut pose = case.clone();
        for (_, point) in pose.as_object_mut().unwrap() {
            let moved = numbers(point)
                .into_iter()
                .map(|n| n + 0.002 * (random.f64() - 0.5));
            *point = moved.collect();
        }
        text += &format!("{pose}\n");
    }
    let poses = file(&folder, "poses.jsonl", text);
    let spread = |options: &[&str]| {
        let arguments = ["body", "angles", poses.as_str()].into_iter();
        let printed = run(arguments.chain(options.iter().copied())).done();
        let lengths = |joint: &str| -> Vec<f64> {
            let lines = objects(&printed.out);
            lines
                .iter()
                .map(|line| line["lengths"][joint].as_f64().unwrap())
                .collect()
        };
        let spread = |joint: &str| {
            let lengths = lengths(joint);
            let largest = lengths.iter().fold(f64::MIN, |a, b| a.max(*b));
            largest - lengths.iter().fold(f64::MAX, |a, b| a.min(*b))
        };
        ["left-elbow", "right-knee"].map(spread)
    };
    assert!(spread(&[]).iter().all(|spread| *spread > 5e-4));
    assert!(spread(&["--fit"]).iter().all(|spread| *spread < 1e-9));
}

#[test]
fn a_file_that_is_written_is_named_on_standard_error() {
    let folder = tempfile::tempdir().unwrap();
    let poses = file(&folder, "poses.jsonl", vectors()[0]["points"].to_string());
    let path = |name: &str| text(&folder.path().join(name)).to_owned();
    let (angles, positions) = (path("angles.jsonl"), path("positions.jsonl"));
    for (action, from, to) in [
        ("angles", &poses, &angles),
        ("positions", &angles, &positions),
    ] {
        let ended = run(["body", action, from.as_str(), "--output", to.as_str()]).done();
        assert_eq!(
            (ended.out, ended.err),
            (String::new(), format!("wrote {to}\n"))
        );
        assert_eq!(objects(&std::fs::read_to_string(to).unwrap()).len(), 1);
    }
}

#[test]
fn points_that_are_not_visible_have_no_position() {
    let folder = tempfile::tempdir().unwrap();
    let row = |number: usize| {
        let is_arm = (11..25).contains(&number);
        let along = number as f64;
        json!([along, along * along, 1.0 / along.max(1.0), u8::from(is_arm)])
    };
    let landmarks: Vec<Value> = (0..33).map(row).collect();
    let line = json!({ "pose_world_landmarks": landmarks });
    let poses = file(&folder, "arms.jsonl", line.to_string());
    let refused = run(["body", "angles", &poses]).exited(2);
    let reason = format!(
        "no pose has angles; the first one is {poses}:1: the pose lacks the position of `left-knee`"
    );
    refused.reported(&reason);
}

#[test]
fn a_line_that_has_no_angles_is_refused_in_words_of_the_command() {
    let folder = tempfile::tempdir().unwrap();
    let list = vec![[0.0, 1.0, 2.0]; 12];
    for (line, reason) in [
        (json!(list).to_string(), "this is not an object"),
        ("[1,2]".to_owned(), "this is not an object"),
        ("hello".to_owned(), "this is not JSON"),
        ("{\"order\":\"zxy\"}".to_owned(), "missing field `root`"),
    ] {
        let path = file(&folder, "angles.jsonl", &line);
        let refused = run(["body", "positions", &path]);
        assert_eq!(refused.code, Some(2), "{line}");
        refused.reported(&format!(
            "{path}:1: {reason}; expected a line of `ademan body angles`"
        ));
    }
}

#[test]
fn the_standard_input_is_not_named_as_a_file() {
    for command in [
        ["body", "angles"],
        ["body", "positions"],
        ["arm", "attributes"],
        ["arm", "landmarks"],
    ] {
        let refused = run(command.iter().chain(&["-"]));
        assert_eq!(refused.code, Some(2), "{command:?}");
        refused.reported("error: the standard input holds no pose");
    }
}

//! `ademan trace`: one JSON object per line, as documented in the module `trace`.

use std::io::{BufRead, BufReader, Read};
use std::process::Stdio;

use ademan::contact::Phase;
use ademan::device::KeyCode;
use ademan::hand::{Dof, Finger, Joint};
use serde_json::{Map, Value};

use super::{Ended, ademan, file, numbers, run, text};
use crate::support::source::text_lines;

/// The objects of a stage while `hi` is typed. Their times must not decrease.
fn lines(stage: &str) -> Vec<Map<String, Value>> {
    let ended = run(["trace", stage, "--source", "typist:hi"]).done();
    assert_eq!(ended.err, "");
    let lines: Vec<Map<String, Value>> = ended
        .out
        .lines()
        .map(|line| serde_json::from_str(line).expect("each line is an object"))
        .collect();
    let times: Vec<u64> = lines
        .iter()
        .map(|line| line["time_us"].as_u64().unwrap())
        .collect();
    assert!(!times.is_empty());
    if stage != "touches" {
        assert!(times.is_sorted(), "{times:?}");
    }
    lines
}

#[test]
fn readings_have_64_channels_in_wire_order() {
    for line in lines("readings") {
        let channels = numbers(&line["channels"]);
        assert_eq!(channels.len(), 64);
        assert!(channels.iter().all(|count| (0.0..=255.0).contains(count)));
        assert_eq!(line["full_scale"], 255);
    }
}

#[test]
fn angles_are_in_radians_by_joint() {
    for line in lines("angles") {
        let angles = line["angles"].as_object().unwrap();
        assert!(angles.contains_key("index-mcp-flexion"), "{angles:?}");
        for (name, angle) in angles {
            name.parse::<Dof>().unwrap();
            assert!(angle.as_f64().unwrap().abs() < 4.0, "{name} {angle}");
        }
    }
}

#[test]
fn a_trace_without_results_says_what_became_of_the_readings() {
    let folder = tempfile::tempdir().unwrap();
    let mut lines = text_lines("hi");
    // Of more of them, only the hand would not be trusted.
    lines.truncate(8);
    // The wrist is bent further than any.
    let impossible = lines.iter().map(|line| {
        let mut values: Vec<_> = line.split_ascii_whitespace().collect();
        values[4] = "150";
        values.join(" ") + "\n"
    });
    let path = file(&folder, "hand.txt", impossible.collect::<String>());
    let source = format!("file:{path}?protocol=text-line");
    for stage in ["angles", "pose", "events"] {
        let ended = run(["trace", stage, "--source", &source]).done();
        assert_eq!(ended.out, "");
        let readings = format!("{} readings: 0 accepted, ", lines.len());
        assert!(ended.err.starts_with(&readings), "{}", ended.err);
        ended.reported(" rejected (");
    }
}

#[test]
fn a_pose_has_positions_in_metres_by_joint() {
    for line in lines("pose") {
        assert_eq!(line["side"], "right");
        let positions = line["positions"].as_object().unwrap();
        assert!(positions.contains_key("index-finger-tip"), "{positions:?}");
        for (name, position) in positions {
            name.parse::<Joint>().unwrap();
            let position = numbers(position);
            assert_eq!(position.len(), 3);
            assert!(position.iter().all(|metres| metres.abs() < 1.0), "{name}");
        }
        let orientations = line["orientations"].as_object().unwrap();
        assert_eq!(orientations.len(), positions.len());
        for (name, orientation) in orientations {
            let squares: f64 = numbers(orientation).iter().map(|part| part * part).sum();
            assert!((squares - 1.0).abs() < 1e-4, "{name}");
        }
    }
}

#[test]
fn touches_have_a_finger_a_target_and_a_phase() {
    let mut presses = 0;
    for line in lines("touches") {
        line["finger"].as_str().unwrap().parse::<Finger>().unwrap();
        let phase: Phase = line["phase"].as_str().unwrap().parse().unwrap();
        presses += u32::from(phase == Phase::Pressed);
        assert!((0.0..=1.0).contains(&line["depth"].as_f64().unwrap()));
        assert!(["H", "I"].contains(&line["target"].as_str().unwrap()));
    }
    assert_eq!(presses, 2);
}

#[test]
fn events_are_presses_and_releases_of_keys() {
    let events: Vec<String> = lines("events")
        .iter()
        .map(|line| {
            let key = line["key"].as_str().unwrap();
            key.parse::<KeyCode>().unwrap();
            format!("{} {key}", line["event"].as_str().unwrap())
        })
        .collect();
    assert_eq!(events, ["key-down H", "key-up H", "key-down I", "key-up I"]);
}

#[test]
fn a_closed_standard_output_ends_the_program_without_an_error() {
    let cases = [
        [
            "trace",
            "pose",
            "--source",
            "typist:a long text that overflows any pipe",
        ]
        .as_slice(),
        &["run", "--source", "typist:three", "--output", "transcript"],
        &["layout", "show", "qwerty-flat"],
        &["demo", "--text", "a"],
    ];
    for arguments in cases {
        let mut child = ademan(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut first = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut first)
            .unwrap();
        assert!(!first.is_empty());
        let status = child.wait().unwrap();
        let mut err = String::new();
        child.stderr.unwrap().read_to_string(&mut err).unwrap();
        assert_eq!(status.code(), Some(0), "{arguments:?}: {err}");
        assert!(
            !err.contains("error") && !err.contains("panicked"),
            "{arguments:?}: {err}"
        );
    }
}

#[test]
fn the_angles_of_a_body_are_traced_as_those_of_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let pose = |name: &str| format!("{}/examples/poses/{name}.jsonl", env!("CARGO_MANIFEST_DIR"));
    let movement = run(["arm", "between", &pose("rest"), &pose("wave")])
        .done()
        .out;
    let movement = file(&folder, "movement.jsonl", movement);
    let lines = |out: &str| -> Vec<serde_json::Value> {
        let lines = out.lines().map(serde_json::from_str);
        lines.collect::<Result<_, _>>().expect("JSON")
    };
    // The movement has no legs.
    let with_legs: Vec<String> = lines(&std::fs::read_to_string(movement).unwrap())
        .into_iter()
        .map(|mut line| {
            for (landmark, place) in [
                (25_usize, [0.12, 0.4]),
                (26, [-0.12, 0.4]),
                (27, [0.12, 0.8]),
                (28, [-0.12, 0.8]),
            ] {
                line["pose_world_landmarks"][landmark] =
                    serde_json::json!([place[0], place[1], 0.05, 1.0]);
            }
            line.to_string()
        })
        .collect();
    let body = file(&folder, "body.jsonl", with_legs.join("\n"));
    let source = format!("file:{body}?protocol=body-landmarks");
    for order in ["zxy", "xyz"] {
        let traced = run(["trace", "body", "--euler", order, "--source", &source]).done();
        let traced = lines(&traced.out);
        let expected = lines(&run(["body", "angles", &body, "--order", order]).done().out);
        assert!(traced.len() > 40 && traced.len() == expected.len());
        for (line, wanted) in traced.iter().zip(&expected) {
            assert_eq!(line["order"], wanted["order"]);
            for (joint, angles) in wanted["angles_deg"].as_object().unwrap() {
                for axis in 0..3_usize {
                    let [found, expected_deg] =
                        [&line["angles_deg"][joint], angles].map(|it| it[axis].as_f64().unwrap());
                    let difference = (found - expected_deg + 180.0).rem_euclid(360.0) - 180.0;
                    assert!(difference.abs() < 1e-3, "{joint}: {found} {expected_deg}");
                }
            }
        }
    }
}

#[test]
fn euler_angles_of_the_joints_are_those_that_turn_them() {
    let trace = [
        "trace",
        "angles",
        "--source",
        "typist:hola",
        "--euler",
        "yzx",
    ];
    let traced = run(trace).done().out;
    let mut largest: f64 = 0.0;
    for line in traced.lines() {
        let line: serde_json::Value = serde_json::from_str(line).unwrap();
        assert_eq!(line["order"], "YZX");
        for (joint, turns) in [
            ("elbow", ["elbow-flexion", "", "forearm-supination"]),
            ("wrist", ["wrist-deviation", "wrist-flexion", ""]),
            (
                "index-finger-phalanx-intermediate",
                ["", "index-pip-flexion", ""],
            ),
        ] {
            for (axis, turn) in turns.into_iter().enumerate() {
                let expected = line["angles"][turn].as_f64().unwrap_or(0.0).to_degrees();
                let found = line["euler_deg"][joint][axis].as_f64().unwrap();
                assert!(
                    (found - expected).abs() < 1e-3,
                    "{joint}: {found} {expected}"
                );
                largest = largest.max(expected);
            }
        }
    }
    assert!(largest > 30.0, "{largest}");
    let refused = run(["trace", "pose", "--source", "typist:hola", "--euler", "yzx"]).exited(2);
    refused.reported("`--euler` is for");
}

#[test]
fn a_recording_that_is_not_there_has_no_setup_that_is_announced() {
    let ended = run(["trace", "readings", "--source", "recording:/nope.mcap"]).exited(2);
    ended.reported("cannot open recording:/nope.mcap");
    assert!(!ended.err.contains("using the setup"), "{}", ended.err);
}

#[test]
fn a_trace_of_a_recording_corrects_words_only_if_it_is_asked_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("slips.mcap");
    let slips = ["--source", "typist:teh quikc fox "];
    run([&["record", text(&path)][..], &slips].concat()).done();
    let source = format!("recording:{}", text(&path));
    let trace = |options: &[&str]| {
        let arguments = ["trace", "events", "--source", &source];
        run([&arguments[..], options].concat())
    };
    let events = |ended: Ended| ended.done().out.lines().count();
    let (plain, corrected) = (events(trace(&[])), events(trace(&["--decoder", "auto"])));
    assert!(plain < corrected, "{plain} {corrected}");
    let refused = trace(&["--decoder", "auto", "--learned", "me.ron"]).exited(2);
    refused.reported("`--learned`");
}

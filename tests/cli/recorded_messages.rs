//! Recordings read by the packages `mcap` and `mcap-protobuf-support`, which others wrote.

use std::collections::BTreeMap;
use std::process::Command;

use serde_json::{Map, Value};

use crate::support::python::python;
use crate::{run, text};

/// Prints topic, time and fields of each message as JSON.
const READER: &str = "
import json, sys
from google.protobuf.json_format import MessageToDict
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
with open(sys.argv[1], 'rb') as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
        fields = MessageToDict(decoded, preserving_proto_field_name=True)
        print(json.dumps([channel.topic, message.log_time, fields]))
";

/// Messages by topic: the time of each in nanoseconds and its fields.
type Messages = BTreeMap<String, Vec<(u64, Map<String, Value>)>>;

/// Returns the messages of a recording, or the reason why no package can read it.
fn messages(recording: &str) -> Result<Messages, String> {
    let packages = ["mcap", "mcap-protobuf-support"];
    let python = python("mcap", "mcap, mcap_protobuf", &packages)?;
    let output = Command::new(python)
        .args(["-c", READER, recording])
        .output();
    let output = output.expect("it was run before");
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{err}");
    let mut messages = Messages::new();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let (topic, time, fields) = serde_json::from_str(line).expect("a line of the reader");
        let topic: String = topic;
        messages.entry(topic).or_default().push((time, fields));
    }
    Ok(messages)
}

/// Returns what the program prints of a stage of a recording.
fn trace(stage: &str, recording: &str) -> Vec<Map<String, Value>> {
    let source = format!("recording:{recording}");
    let ended = run(["trace", stage, "--source", &source]).done();
    let lines = ended.out.lines();
    lines
        .map(|line| serde_json::from_str(line).expect("an object"))
        .collect()
}

/// Returns the numbers of a message of numbers; those that are 0 are not in it.
fn numbers(value: &Value, names: &[&str]) -> Vec<f64> {
    let number = |name: &&str| {
        value
            .get(name)
            .map_or(0.0, |number| number.as_f64().unwrap())
    };
    names.iter().map(number).collect()
}

fn listed(value: &Value) -> Vec<f64> {
    let values = value.as_array().expect("a list").iter();
    values
        .map(|number| number.as_f64().expect("a number"))
        .collect()
}

/// Compares named values: `index-finger-tip` in JSON is `index_finger_tip` in a message.
fn assert_same_map(message: &Value, object: &Value, fields: &[&str]) {
    let (message, object) = (message.as_object().unwrap(), object.as_object().unwrap());
    assert_eq!(message.len(), object.len());
    for (name, expected) in object {
        let value = &message[&name.replace('-', "_")];
        match fields {
            [] => assert_eq!(value.as_f64(), expected.as_f64(), "{name}"),
            _ => assert_eq!(numbers(value, fields), listed(expected), "{name}"),
        }
    }
}

/// Compares named angles, which a message has in single precision.
fn assert_rounded(message: &Value, object: &Value) {
    let (message, object) = (message.as_object().unwrap(), object.as_object().unwrap());
    assert_eq!(message.len(), object.len());
    for (name, expected) in object {
        let radians = message[&name.replace('-', "_")].as_f64().unwrap();
        assert_eq!(radians as f32, expected.as_f64().unwrap() as f32, "{name}");
    }
}

fn assert_same_time((time, _): &(u64, Map<String, Value>), object: &Map<String, Value>) {
    assert_eq!(Some(time / 1000), object["time_us"].as_u64());
}

/// Compares metres of a message with millimetres of a line.
fn assert_all_close(metres: &[f64], millimetres: &[f64]) {
    assert_eq!(metres.len(), millimetres.len());
    for (found, expected) in metres.iter().zip(millimetres) {
        assert!(
            (found * 1e3 - expected).abs() < 1e-3,
            "{found} m, {expected} mm"
        );
    }
}

#[test]
fn other_programs_read_every_stage_as_it_is_traced() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hand.mcap");
    let recording = text(&path);
    run(["run", "--source", "typist:Hi", "--record", recording]).done();
    let mut messages = match messages(recording) {
        Ok(messages) => messages,
        Err(reason) => return println!("SKIPPED: no packages of Python: {reason}"),
    };
    let topics: Vec<&str> = messages.keys().map(String::as_str).collect();
    let expected = ["/angles", "/events", "/presses", "/readings", "/touches"];
    assert_eq!(topics, expected);
    let mut both = |topic: &str, stage: &str| {
        let messages = messages.remove(topic).expect("the topic was read");
        let lines = trace(stage, recording);
        assert_eq!(messages.len(), lines.len(), "{stage}");
        messages.into_iter().zip(lines)
    };
    for (message, line) in both("/readings", "readings") {
        assert_same_time(&message, &line);
        let channels = &message.1["channels"];
        assert_eq!(channels["full_scale"], line["full_scale"]);
        assert_eq!(channels["counts"], line["channels"]);
    }
    for (message, line) in both("/angles", "angles") {
        assert_same_time(&message, &line);
        assert_eq!(message.1["side"], "SIDE_RIGHT");
        assert_rounded(&message.1["angles_rad"], &line["angles"]);
    }
    let upper = |prefix: &str, name: &Value| {
        let name = name.as_str().expect("a name").replace('-', "_");
        format!("{prefix}_{}", name.to_uppercase())
    };
    for (message, line) in both("/touches", "touches") {
        assert_same_time(&message, &line);
        let fields = Value::Object(message.1);
        assert_eq!(fields["finger"], upper("FINGER", &line["finger"]));
        assert_eq!(fields["phase"], upper("PHASE", &line["phase"]));
        assert_eq!(fields["name"], line["target"]);
        let mut position = listed(&line["position"]);
        position.push(line["depth"].as_f64().expect("a number"));
        assert_single(&numbers(&fields, &["x_m", "y_m", "depth"]), &position);
    }
    for (message, line) in both("/presses", "presses") {
        assert_same_time(&message, &line);
        let fields = Value::Object(message.1);
        assert_eq!(fields["finger"], upper("FINGER", &line["finger"]));
        assert_eq!(fields["name"], line["target"]);
        let found = numbers(&fields, &["x_m", "y_m", "z_m", "depth_m", "speed_m_s"]);
        let mut evidence = listed(&line["point_mm"]);
        evidence.extend(numbers(
            &Value::Object(line.clone()),
            &["depth_mm", "speed_mm_s"],
        ));
        assert_all_close(&found, &evidence);
        let neighbors = fields["neighbors"].as_array().expect("neighbors of a key");
        let expected_neighbors = line["neighbors"].as_array().unwrap();
        assert!(!neighbors.is_empty());
        assert_eq!(neighbors.len(), expected_neighbors.len());
        for (neighbor, wanted) in neighbors.iter().zip(expected_neighbors) {
            assert_eq!(neighbor["name"], wanted["target"]);
            let distance = numbers(neighbor, &["distance_m"]);
            assert_all_close(&distance, &numbers(wanted, &["distance_mm"]));
        }
    }
    for (message, line) in both("/events", "events") {
        assert_same_time(&message, &line);
        assert_eq!(message.1["kind"], upper("EVENT", &line["event"]));
        assert_eq!(message.1["key"], line["key"]);
    }
}

#[test]
fn other_programs_read_readings_of_every_kind_of_sensor() {
    let folder = tempfile::tempdir().expect("a folder");
    let quaternion = ["x", "y", "z", "w"];
    for (protocol, field, names) in [
        ("text-line&rate_hz=30", "angles_rad", &[][..]),
        ("openxr", "joints_m", &quaternion[..3]),
        (
            "body-landmarks",
            "body_landmarks",
            &["x", "y", "z", "confidence"],
        ),
        ("vmc", "bones", &quaternion),
        ("opentrack", "displacement", &quaternion),
    ] {
        let name = protocol.split('&').next().expect("a name");
        let path = folder.path().join(format!("{name}.mcap"));
        let source = format!("typist:h?protocol={protocol}");
        run(["record", text(&path), "--source", &source]).done();
        let mut messages = match messages(text(&path)) {
            Ok(messages) => messages,
            Err(reason) => return println!("SKIPPED: no packages of Python: {reason}"),
        };
        let messages = messages.remove("/readings").expect("it has readings");
        let lines = trace("readings", text(&path));
        assert!(messages.len() == lines.len() && lines.len() > 20, "{name}");
        for (message, line) in messages.iter().zip(&lines) {
            assert_same_time(message, line);
            let fields = &message.1;
            let expected = &line[field];
            match field {
                "body_landmarks" => {
                    let points = fields["body"]["points"].as_array().unwrap();
                    let expected = expected.as_array().unwrap();
                    assert_eq!(points.len(), expected.len());
                    for (point, wanted) in points.iter().zip(expected) {
                        assert_single(&numbers(point, names), &listed(wanted));
                    }
                }
                "bones" => {
                    for (side, bones) in expected.as_object().unwrap() {
                        let Some(found) = fields["bones"].get(side) else {
                            assert!(bones.as_object().unwrap().is_empty());
                            continue;
                        };
                        for (bone, rotation) in bones.as_object().unwrap() {
                            let found = &found[bone.replace('-', "_")];
                            assert_single(&numbers(found, names), &listed(rotation));
                        }
                    }
                }
                "displacement" => {
                    let found = &fields[field];
                    assert_eq!(found["joint"], expected["joint"]);
                    let rotation = numbers(&found["rotation"], names);
                    assert_single(&rotation, &listed(&expected["rotation"]));
                }
                _ => assert_same_map(&fields[field], expected, names),
            }
        }
    }
}

/// Compares numbers in single precision, which two programs print with different digits.
fn assert_single(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (&one, &other) in found.iter().zip(expected) {
        assert_eq!(one as f32, other as f32);
    }
}

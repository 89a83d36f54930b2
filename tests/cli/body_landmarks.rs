//! Landmarks of a body as the source of the program, without a glove.

use std::io::Write;
use std::process::Stdio;

use ademan::capture::protocol::body_landmarks::encode;
use ademan::hand::Side;
use tempfile::TempDir;

use crate::support::body::{ONE_KEY, TWO_KEYS, taps};
use crate::support::run::without_time;
use crate::{Ended, ademan, file, objects, run, text};

/// Lines of a person who taps with these hands.
fn lines(sides: &[Side]) -> Vec<String> {
    taps(sides).iter().map(encode).collect()
}

/// Returns the presses and releases of a transcript, in order.
pub fn keys(transcript: &str) -> Vec<String> {
    let events = transcript.lines().map(without_time);
    events
        .filter(|event| event.starts_with("down ") || event.starts_with("up "))
        .collect()
}

/// Asserts that a run with these options, and the replay of their recording, tap the key J.
pub fn assert_tapped_and_replayed(options: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("body.mcap");
    let typed = run([&["run", "--output", "transcript"][..], options].concat()).done();
    assert_eq!(keys(&typed.out), TAPPED, "{}{}", typed.out, typed.err);
    run([&["record", text(&recording)][..], options].concat()).done();
    let replayed = run(["replay", text(&recording)]).done();
    assert_eq!(keys(&replayed.out), TAPPED, "{}", replayed.err);
}

const TAPPED: [&str; 2] = ["down J", "up J"];

#[test]
fn a_file_of_landmarks_is_typed_recorded_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let layout = file(&folder, "one-key.ron", ONE_KEY);
    let path = file(&folder, "body.jsonl", lines(&[Side::Right]).concat());
    let source = format!("file:{path}?protocol=body-landmarks");
    let with = ["--source", &source, "--layout", &layout];
    assert_tapped_and_replayed(&with);
    let readings = run([&["trace", "readings"], &with[..]].concat()).done();
    let first = readings.out.lines().next().expect("a reading");
    assert!(
        first.contains("\"side\":\"right\",\"body_landmarks\":[["),
        "{first}"
    );
    let poses = run([&["trace", "pose"], &with[..]].concat()).done();
    let poses = objects(&poses.out);
    let pose = poses.last().expect("a pose");
    let across = pose["positions"]["index-finger-tip"][0].as_f64();
    let across = across.expect("the position of the finger");
    assert!((across + 0.03).abs() < 1e-5, "{across}");
}

/// Writes a layout with two keys and the lines of a body whose hands tap them. Returns the setup that reads them.
pub fn two_hands(folder: &TempDir) -> String {
    file(folder, "two-keys.ron", TWO_KEYS);
    let lines = lines(&[Side::Left, Side::Right]).concat();
    let path = file(folder, "body.jsonl", lines);
    let setup = format!(
        "Setup(source: \"file:{path}?protocol=body-landmarks\", other_hand: OtherHand(), layout: \"two-keys.ron\")"
    );
    file(folder, "two.ron", setup)
}

#[test]
fn both_hands_of_a_body_type() {
    let folder = tempfile::tempdir().unwrap();
    let setup = two_hands(&folder);
    let typed = run(["run", &setup]).done();
    assert_eq!(
        keys(&typed.out),
        ["down F", "up F", "down J", "up J"],
        "{}",
        typed.err
    );
}

#[test]
fn a_trace_of_a_recording_shows_both_hands_and_touches_its_own_layout() {
    let folder = tempfile::tempdir().unwrap();
    let setup = two_hands(&folder);
    let recording = folder.path().join("two-hands.mcap");
    let recording = recording.to_str().unwrap();
    run(["record", recording, "--setup", &setup]).done();
    let trace = |stage: &str| {
        let source = format!("recording:{recording}");
        let ended = run(["trace", stage, "--source", &source]).done();
        ended.reported(&format!("using the setup in {recording}\n"));
        objects(&ended.out)
    };
    for stage in ["angles", "pose"] {
        let lines = trace(stage);
        for side in ["left", "right"] {
            assert!(lines.iter().any(|line| line["side"] == side), "{stage}");
        }
    }
    let events = trace("events");
    let keys: Vec<_> = events.iter().map(|line| line["key"].as_str()).collect();
    assert_eq!(keys, [Some("F"), Some("F"), Some("J"), Some("J")]);
}

#[test]
fn landmarks_on_the_standard_input_are_read() {
    let lines = lines(&[Side::Right]);
    let mut program = ademan([
        "trace",
        "readings",
        "--source",
        "stdin:?protocol=body-landmarks",
    ])
    .stdin(Stdio::piped())
    .stdout(Stdio::piped())
    .spawn()
    .expect("the program starts");
    let mut stdin = program.stdin.take().expect("it is piped");
    let sent = lines.len();
    let writer = std::thread::spawn(move || {
        let write = |line: String| stdin.write_all(line.as_bytes());
        lines.into_iter().try_for_each(write).expect("it is read");
    });
    let ended = Ended::from(program.wait_with_output().expect("the program ends"));
    writer.join().expect("all lines are written");
    let received = ended.done().out.matches("\"body_landmarks\"").count();
    // A live source drops readings that a busy machine cannot process.
    assert!((1..=sent).contains(&received), "{received} of {sent}");
}

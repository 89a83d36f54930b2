//! Text lines of joint angles as the source of the program, without a glove.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Stdio};
use std::time::{Duration, Instant};

use ademan::capture::protocol::text_line::{VALUES, angles, parse};
use ademan::estimate::JointLimits;
use ademan::hand::Dof;

use crate::support::process::signal;
use crate::support::source::text_lines;
use crate::{Ended, ademan, file, run, text};

const TYPED: &str = "Hola";

/// Keys that are pressed to type [`TYPED`].
const KEYS: [&str; 5] = ["ShiftLeft", "H", "O", "L", "A"];

/// Returns the keys that a transcript presses, in order.
pub fn pressed_keys(transcript: &str) -> Vec<&str> {
    let lines = transcript.lines();
    lines
        .filter_map(|line| line.split_once("down "))
        .map(|(_, key)| key)
        .collect()
}

/// Asserts that a run with these options, and the replay of their recording, press these keys.
pub fn assert_typed_and_replayed(options: &[&str], keys: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("hand.mcap");
    let typed = run([&["run", "--output", "transcript"][..], options].concat()).done();
    assert_eq!(pressed_keys(&typed.out), keys, "{}", typed.err);
    run([&["record", text(&recording)][..], options].concat()).done();
    let replayed = run(["replay", text(&recording)]).done();
    assert_eq!(pressed_keys(&replayed.out), keys, "{}", replayed.err);
}

/// Starts a run of text lines on its standard input, with pipes, and returns the end to write to.
fn reading_lines() -> (Child, ChildStdin) {
    let source = "stdin:?protocol=text-line";
    let mut program = ademan(["run", "--source", source, "--output", "transcript"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let stdin = program.stdin.take().expect("it is piped");
    (program, stdin)
}

#[test]
fn a_file_of_text_lines_is_typed_recorded_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "angles.txt", text_lines(TYPED).concat());
    let source = format!("file:{path}?protocol=text-line&rate_hz=170");
    assert_typed_and_replayed(&["--source", &source], &KEYS);
}

#[test]
fn a_line_that_a_killed_writer_has_cut_is_no_reading() {
    let lines = text_lines(TYPED);
    let (whole, last) = (lines[..10].concat(), &lines[10]);
    for (cut, invalid) in [
        (last.trim_end(), "1 invalid packet (1 truncated)"),
        ("", "10 readings"),
    ] {
        let (program, mut stdin) = reading_lines();
        stdin
            .write_all(format!("{whole}{cut}").as_bytes())
            .expect("it is read");
        drop(stdin);
        let ended = Ended::from(program.wait_with_output().expect("the program ends"));
        ended.reported("10 readings").reported(invalid);
    }
}

#[test]
fn text_lines_on_the_standard_input_are_typed() {
    let (program, mut stdin) = reading_lines();
    let start = Instant::now();
    for (index, line) in text_lines(TYPED).iter().enumerate() {
        let due = Duration::from_micros(5_729 * index as u64);
        std::thread::sleep(due.saturating_sub(start.elapsed()));
        stdin.write_all(line.as_bytes()).expect("it is read");
    }
    drop(stdin);
    let ended = Ended::from(program.wait_with_output().expect("the program ends")).done();
    assert_eq!(pressed_keys(&ended.out), KEYS, "{}", ended.err);
}

#[test]
fn bytes_without_a_line_end_are_named_and_fail() {
    let (mut program, mut stdin) = reading_lines();
    let unended = text_lines(TYPED)[0].replace('\n', "\r");
    let sender = std::thread::spawn(move || {
        while stdin.write_all(unended.as_bytes()).is_ok() {
            std::thread::sleep(Duration::from_millis(10));
        }
    });
    let stderr = BufReader::new(program.stderr.take().expect("it is piped"));
    let mut lines = stderr.lines().map(|line| line.expect("UTF-8"));
    let warning = lines.find(|line| line.contains("no valid packet"));
    let warning = warning.expect("a warning");
    assert!(warning.contains("no line end (LF) within"), "{warning}");
    signal("INT", program.id());
    let rest = lines.collect::<Vec<_>>().join("\n");
    assert!(rest.contains("bytes belonged to no packet"), "{rest}");
    assert!(rest.contains("sent no valid packet"), "{rest}");
    let status = program.wait().expect("it ends");
    assert_eq!(status.code(), Some(1), "{rest}");
    sender.join().expect("no panic");
}

#[test]
fn the_documentation_has_the_place_and_the_range_of_each_joint() {
    let page = include_str!("../../docs/sources.md");
    let limits = JointLimits::human();
    let mut found = Vec::new();
    for place in 0..VALUES {
        let mut values = [0.0; VALUES];
        values[place] = 1.0;
        let turned = angles(&values);
        for (dof, _) in turned.known().filter(|(_, radians)| *radians != 0.0) {
            let (low, high) = limits.range(dof);
            let (low, high) = (low.to_degrees(), high.to_degrees());
            let row = format!("| {place} | `{dof}` | {low:.0} to {high:.0} |");
            assert!(page.contains(&row), "{row}");
            found.push(dof);
        }
    }
    assert_eq!(found.len(), 21);
    let mut lines = page.lines();
    let example = lines.find(|line| line.starts_with("0 0 "));
    let values = parse(example.expect("an example")).expect("a valid line");
    let bend = angles(&values).get(Dof::IndexMcpFlexion);
    assert!((bend.to_degrees() - 30.0).abs() < 1e-6, "{bend}");
}

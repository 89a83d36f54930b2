//! A body and its hand in one line as the source of the program: the arm places the hand, whose index finger taps a key.

use ademan::capture::protocol::{body_landmarks, hand_landmarks, holistic};
use ademan::hand::{Finger, Joint, JointPositions, Side};
use glam::DVec3;

use crate::body_landmarks::{assert_tapped_and_replayed, keys};
use crate::support::body::{ONE_KEY, RATE_HZ, taps};
use crate::{file, run};

/// Returns a straight hand whose index fingertip is as far from the wrist as in the body. The other fingers are short.
fn hand() -> JointPositions {
    let wrist = DVec3::new(0.0, -0.1, -0.5);
    let mut positions = JointPositions::default();
    positions.set(Joint::Wrist, wrist);
    for &finger in Finger::ALL {
        let tip = match finger {
            Finger::Index => DVec3::new(-0.03, 0.0, -0.09),
            _ => DVec3::new(0.005 * finger.index() as f64, 0.0, -0.02),
        };
        let joints = finger.joints();
        for (number, &joint) in joints.iter().enumerate() {
            let along = (number + 1) as f64 / joints.len() as f64;
            positions.set(joint, wrist + tip * along);
        }
    }
    positions
}

/// Returns the lines of a person who taps.
fn lines(with_hand: bool) -> String {
    let hand = with_hand.then(|| (Side::Right, hand()));
    let bodies = taps(&[Side::Right]);
    let line = |(number, body): (usize, &_)| {
        let time_us = ((number + 1) as f64 * 1e6 / RATE_HZ) as u64;
        let hands = hand_landmarks::encode(Some(time_us), hand.as_slice());
        holistic::join(&body_landmarks::encode(body), &hands)
    };
    bodies.iter().enumerate().map(line).collect()
}

#[test]
fn a_body_with_its_hand_is_typed_recorded_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let layout = file(&folder, "one-key.ron", ONE_KEY);
    let path = file(&folder, "whole.jsonl", lines(true));
    let source = format!("file:{path}?protocol=holistic&camera=head");
    let with = ["--source", &source, "--layout", &layout];
    assert_tapped_and_replayed(&with);
}

#[test]
fn a_body_without_its_hand_presses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let layout = file(&folder, "one-key.ron", ONE_KEY);
    let path = file(&folder, "body.jsonl", lines(false));
    let source = format!("file:{path}?protocol=holistic&camera=head");
    let typed = run(["run", "--source", &source, "--layout", &layout]).done();
    assert_eq!(keys(&typed.out), [""; 0], "{}", typed.err);
}

#[test]
fn a_second_source_for_the_arm_is_refused() {
    let arm = "udp:127.0.0.1:5005?protocol=body-landmarks";
    let refused = run([
        "run",
        "--source",
        "stdin:?protocol=holistic",
        "--arm-source",
        arm,
    ])
    .exited(2);
    refused.reported("remove `arm_source`");
}

#[test]
fn a_source_that_shows_only_the_other_hand_says_so_with_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let line = |number: u64| hand_landmarks::encode(Some(number * 10_000), &[(Side::Left, hand())]);
    let lines: String = (1..8).map(line).collect();
    let path = file(&folder, "left.jsonl", lines);
    let source = format!("file:{path}?protocol=hand-landmarks&camera=head");
    for command in [&["run"][..], &["trace", "readings"]] {
        let ended = run(command.iter().copied().chain(["--source", &source]));
        ended.reported("7 of the other hand left out");
        let expected = "shows only the left hand, which the setup does not use: add `hand=left` to the options of the source";
        ended.reported(expected);
    }
    let left = format!("{source}&hand=left");
    let used = run(["run", "--source", &left]).done();
    used.reported("7 readings: 7 accepted");
    assert!(!used.err.contains("other hand"), "{}", used.err);
}

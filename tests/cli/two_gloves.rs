//! Two gloves on one converter: 64 channels carry both hands.

use ademan::files::Load;
use ademan::hand::{Dof, Side};
use ademan::layout::Glove;
use tempfile::TempDir;

use crate::{file, objects, run, run_in};

/// Packets of one posture.
const PACKETS: usize = 120;

/// The start of a packet.
const HEADER: [u8; 2] = [6, 6];

/// A channel of the left glove: the neighbor of the right glove's channel, which is free.
fn left_channel(channel: usize) -> usize {
    channel ^ 1
}

/// Returns the text of the left glove on channels of its own.
fn left_glove() -> String {
    let text = include_str!("../../layouts/gloves/unam-hc11-left.ron");
    let mut parts = text.split("channel: ");
    let mut moved = parts.next().expect("a start").to_owned();
    for part in parts {
        let (number, rest) = part.split_once(',').expect("a number and more");
        let channel: usize = number.parse().expect("a channel");
        moved += &format!("channel: {},{rest}", left_channel(channel));
    }
    moved
}

/// Returns the packets of two hands whose index fingers have these flexions of the knuckle, in radians.
fn packets(right: f64, left: f64) -> Vec<u8> {
    let glove = Glove::load("unam-hc11").expect("a glove");
    let mut body = [100; 64];
    for row in glove.map.rows().iter().rev() {
        let count = |knuckle: f64| {
            let angle = match row.dof {
                Dof::IndexMcpFlexion => knuckle,
                Dof::ElbowFlexion => 0.6,
                _ => 0.0,
            };
            row.calibration
                .apply_inverse(angle)
                .round()
                .clamp(10.0, 245.0) as u8
        };
        body[row.channel] = count(right);
        body[left_channel(row.channel)] = count(left);
    }
    [&HEADER[..], &body].concat().repeat(PACKETS)
}

/// Writes a setup with these fields of the other hand. Returns the arguments of a command that reads it.
fn setup(folder: &TempDir, other_hand: &str) -> String {
    let stream = [packets(0.2, 0.2), packets(1.0, 0.2), packets(1.0, 0.8)].concat();
    let source = file(folder, "hands.bin", stream);
    file(folder, "left.ron", left_glove());
    let text = format!(
        "Setup(source: \"file:{source}?protocol=hc11\", smoothing: Off, other_hand: ({other_hand}), layout: \"qwerty-two-flat\")"
    );
    file(folder, "setup.ron", text)
}

#[test]
fn one_converter_carries_the_gloves_of_both_hands() {
    let folder = tempfile::tempdir().expect("a folder");
    let setup = setup(&folder, "glove: \"left.ron\"");
    let traced = run_in(folder.path(), ["trace", "pose", "--setup", &setup]).done();
    let poses = objects(&traced.out);
    let heights = |side: Side| -> Vec<f64> {
        let own = poses.iter().filter(|pose| pose["side"] == side.name());
        own.map(|pose| {
            pose["positions"]["index-finger-tip"][2]
                .as_f64()
                .expect("a height")
        })
        .collect()
    };
    let (right, left) = (heights(Side::Right), heights(Side::Left));
    // A jump is one rejected reading.
    let is_complete = |seen: &[f64]| seen.len() + 10 > 3 * PACKETS;
    assert!(is_complete(&right) && is_complete(&left), "{}", traced.err);
    let phase = |seen: &[f64], number: usize| seen[number * PACKETS + PACKETS - 20];
    let moved = |seen: &[f64], number: usize| (phase(seen, number) - phase(seen, number - 1)).abs();
    assert!(moved(&right, 1) > 0.02 && moved(&left, 1) < 0.001);
    assert!(moved(&right, 2) < 0.001 && moved(&left, 2) > 0.02);
}

#[test]
fn two_gloves_with_the_same_channels_on_one_source_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let setup = setup(&folder, "");
    let ended = run_in(folder.path(), ["trace", "pose", "--setup", &setup]).exited(2);
    ended.reported("`other_hand` has no `source`, and both gloves have channel 4 of the first one");
    assert_eq!(ended.out, "");
}

#[test]
fn two_simulated_persons_move_one_hand_each() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "Setup(source: \"typist:jump\", other_hand: (source: \"typist:sad\"), layout: \"qwerty-two-flat\", output: \"transcript\")";
    let setup = file(&folder, "setup.ron", text);
    let ended = run(["run", &setup, "--control", "off", "--armed"]).done();
    let keys = |word: &str| -> Vec<String> {
        let downs = ended
            .out
            .lines()
            .filter_map(|line| line.split_once(" down "));
        let own = downs.map(|(_, key)| key.trim().to_owned());
        own.filter(|key| word.contains(key.as_str())).collect()
    };
    assert_eq!(keys("JUMP").concat(), "JUMP", "{}", ended.out);
    assert_eq!(keys("SAD").concat(), "SAD", "{}", ended.out);
    assert!(!ended.err.contains("out-of-order"), "{}", ended.err);
}

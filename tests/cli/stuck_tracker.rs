//! A tracker that repeats the positions of a hand that holds a key, live and in a replay.

use ademan::capture::protocol::joint_sets;
use ademan::hand::{Finger, Joint, JointPositions, Side};
use glam::DVec3;

use crate::body_landmarks::keys;
use crate::{file, run, text};

/// A key below the index fingertip.
const ONE_KEY: &str = r#"Layout(name: "one key", boards: [(
    pose: (anchor: world, right_mm: 150, forward_mm: 470, height_mm: -270),
    size_mm: Box(40, 40), travel_mm: 10, keys: [(code: "J", at_mm: (0, 0))],
)])"#;

const PERIOD_US: u64 = 16_667;

/// Returns a hand with straight fingers whose index fingertip is at this height. The other fingers are higher.
fn hand(height: f64) -> JointPositions {
    let mut positions = JointPositions::default();
    let wrist = DVec3::new(0.15, height, -0.30);
    positions.set(Joint::Wrist, wrist);
    for finger in Finger::ALL {
        let across = 0.02 * (finger.index() as f64 - 1.0);
        let raise = if *finger == Finger::Index { 0.0 } else { 0.04 };
        for (bone, &joint) in finger.joints().iter().rev().enumerate() {
            let ahead = -0.17 + 0.03 * bone as f64;
            positions.set(joint, wrist + DVec3::new(across, raise, ahead));
        }
    }
    positions
}

/// Returns lines of a hand that trembles above the key for 1 s, holds it for 8 s in which all positions repeat, and trembles above it
/// again.
fn lines() -> String {
    let lines = (0..600_u64).map(|number| {
        let tremor = 1e-5 * (number % 2) as f64;
        let height = match number {
            ..60 => -0.21 + tremor,
            60..70 => -0.21 - 0.0065 * (number - 60) as f64,
            70..550 => -0.275,
            _ => -0.21 + tremor,
        };
        let hands = [(Side::Right, hand(height))];
        joint_sets::encode(&joint_sets::OPENXR, Some(PERIOD_US * number), &hands)
    });
    lines.collect()
}

#[test]
fn a_key_that_a_stuck_tracker_holds_is_released_and_a_message_says_why_live_and_in_a_replay() {
    let folder = tempfile::tempdir().unwrap();
    let layout = file(&folder, "one-key.ron", ONE_KEY);
    let path = file(&folder, "hand.jsonl", lines());
    let recording = folder.path().join("hand.mcap");
    let source = format!("file:{path}?protocol=openxr");
    let with = ["--source", &source, "--layout", &layout];
    let typed = run([&["run", "--output", "transcript"][..], &with].concat()).done();
    assert_eq!(keys(&typed.out), ["down J", "up J"], "{}", typed.err);
    typed.reported(
        "the tracker of the right hand has repeated exactly the same positions for 5 s: what the hand held is released, and it \
         touches nothing until the positions change; if they stay the same while you move the hand, check the camera and restart \
         the tracker\n",
    );
    typed.reported("the right hand is tracked again\n");
    let is_blamed = typed.err.contains("check its wire");
    assert!(!is_blamed, "{}", typed.err);
    run([&["record", text(&recording)][..], &with].concat()).done();
    let replayed = run(["replay", text(&recording)]).done();
    assert_eq!(replayed.out, typed.out, "{}", replayed.err);
}

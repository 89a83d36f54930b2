//! Motion capture files of other programs in the session of the page.
//!
//! They are in the folder `ADEMAN_PEERS` (default: `../shared/peers` beside the project), which is not part of the project.

use std::path::{Path, PathBuf};
use std::time::Duration;

use ademan_core::document::Document;
use ademan_web::{HandState, PageSession};
use serde_json::Value;

const FRAME: Duration = Duration::from_micros(16_667);

fn session() -> PageSession {
    let layout = Document::shipped("qwerty-flat").expect("a shipped layout");
    PageSession::new(&layout.text).expect("a valid layout")
}

/// Returns a file of a suit with fingers, made by Rokoko Studio, and the positions of its joints by frame, from another program;
/// `None` without the folder.
fn dance() -> Option<(String, Value)> {
    let folder = std::env::var_os("ADEMAN_PEERS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/peers"),
        PathBuf::from,
    );
    if !folder.is_dir() {
        println!("SKIPPED: there is no folder {}", folder.display());
        return None;
    }
    let read = |name: &str| {
        let path = folder.join("bvh").join(name);
        std::fs::read_to_string(path).expect("a file of the folder")
    };
    let positions = read("rokoko_fingers_dance.json");
    let positions = serde_json::from_str(&positions).expect("JSON");
    Some((read("rokoko_fingers_dance.bvh"), positions))
}

/// Plays what waits, and returns the poses.
fn poses(session: &mut PageSession) -> Vec<Value> {
    let mut poses = Vec::new();
    for _ in 0..200 {
        let lines = session.advance(FRAME);
        let objects = lines
            .lines()
            .map(|line| serde_json::from_str(line).expect("an object"));
        poses.extend(objects.filter(|it: &Value| it["kind"] == "pose"));
    }
    poses
}

/// Returns the angle at the second of three joints, in degrees.
fn angle(positions: &Value, joints: [&str; 3]) -> f64 {
    let [from, at, to] = joints.map(|joint| {
        let axes = positions[joint].as_array().expect(joint);
        [0, 1, 2].map(|axis| axes[axis].as_f64().expect("a number"))
    });
    let way = |end: [f64; 3]| [0, 1, 2].map(|axis: usize| end[axis] - at[axis]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (a, b) = (way(from), way(to));
    (dot(a, b) / (dot(a, a) * dot(b, b)).sqrt())
        .acos()
        .to_degrees()
}

#[test]
fn a_motion_capture_file_moves_the_arm_that_is_asked_for() {
    let Some((text, positions)) = dance() else {
        return;
    };
    for (protocol, side, name) in [("bvh", "right", "Right"), ("bvh?hand=left", "left", "Left")] {
        let mut session = session();
        assert_eq!(session.play_file(protocol, text.as_bytes()), Ok((40, None)));
        assert_eq!(session.hand_state(), HandState::Followed);
        let poses = poses(&mut session);
        assert!(poses.len() > 20, "{}", poses.len());
        assert!(poses.iter().all(|pose| pose["side"] == side));
        let joints = ["Arm", "ForeArm", "Hand"].map(|joint| format!("{name}{joint}"));
        // The page shows the latest pose of each picture, at the end the pose of the last frame.
        let expected = angle(&positions["39"], joints.each_ref().map(String::as_str));
        let last = &poses[poses.len() - 1]["positions"];
        let found = angle(last, ["shoulder", "elbow", "wrist"]);
        assert!((found - expected).abs() < 0.5, "{side}: {found} {expected}");
    }
}

#[test]
fn a_file_replaces_the_one_before_and_a_wrong_one_changes_nothing() {
    let Some((text, _)) = dance() else { return };
    let mut session = session();
    for _ in 0..2 {
        assert_eq!(session.play_file("bvh", text.as_bytes()), Ok((40, None)));
    }
    for (protocol, bytes) in [
        ("bvh", "HIERARCHY\nROOT"),
        ("bvh", ""),
        ("webxr", "{\"hands\":[]}\n"),
        ("hc11", &*text),
    ] {
        let refused = session.play_file(protocol, bytes.as_bytes());
        let reason = refused.expect_err(protocol);
        assert!(!reason.is_empty());
        assert_eq!(session.hand_state(), HandState::Followed);
    }
    assert!(poses(&mut session).len() > 20);
    // The frames before a damaged one are played.
    let lines: Vec<&str> = text.lines().collect();
    let damaged = [&lines[..lines.len() - 10], &["0 x 0"]].concat().join("\n");
    let played = session.play_file("bvh", damaged.as_bytes());
    let (readings, error) = played.expect("the frames before");
    assert!((25..40).contains(&readings), "{readings}");
    let error = error.expect("an error");
    assert!(error.contains("`x`, not a finite number"), "{error}");
}

//! Steps with joint positions do not allocate after the start.

use ademan::capture::protocol::{hand_landmarks, joint_sets};
use ademan::capture::{Reading, SourceUri};
use ademan::device::Events;
use ademan::hand::{JointPositions, Side};
use ademan::kinematics::HandPose;
use ademan::setup::Setup;

use crate::steady_state::allocations;
use crate::support::source::typing_poses;

fn hand(pose: &HandPose) -> (Side, JointPositions) {
    (Side::Right, pose.positions())
}

/// Types lines of a protocol and counts the allocations of decoder and pipeline.
fn type_lines(source: &str, encode: impl Fn(&HandPose) -> String) {
    let setup = Setup {
        source: Some(source.parse().expect("a source")),
        ..Setup::default()
    };
    let Some(SourceUri::Stream(stream)) = &setup.source else {
        panic!("a stream");
    };
    let mut decoder = stream.format.decoder();
    let mut pipeline = setup.load_files().expect("a valid setup").pipeline();
    let mut lines: Vec<String> = typing_poses("ho").iter().map(encode).collect();
    // The hand leaves the view.
    lines.extend(vec!["{\"hands\":[]}\n".to_owned(); 50]);
    let mut events = Events::new();
    let (mut steps, mut sent) = (0, 0);
    let before = allocations();
    for line in &lines {
        decoder.push(line.as_bytes(), &mut |packet| {
            steps += 1;
            let time = packet.time.expect("a time");
            let reading = Reading::new(time, packet.side, packet.sample);
            events.clear();
            let _ = std::hint::black_box(pipeline.step(&reading, &mut events));
            sent += events.len();
        });
    }
    let allocated = allocations() - before;
    assert_eq!((pipeline.accepted(), steps), (steps, lines.len() as u64));
    assert_eq!(sent, 4, "two presses and releases");
    assert_eq!(
        allocated, 0,
        "{source}: {allocated} allocations in {steps} steps"
    );
}

#[test]
fn hands_of_cameras_and_headsets_are_processed_to_events_without_allocation() {
    type_lines(
        "file:x?protocol=hand-landmarks&camera=head&rate_hz=175",
        |pose| hand_landmarks::encode(None, &[hand(pose)]),
    );
    type_lines("file:x?protocol=openxr&rate_hz=175", |pose| {
        joint_sets::encode(&joint_sets::OPENXR, None, &[hand(pose)])
    });
    type_lines("file:x?protocol=webxr&rate_hz=175", |pose| {
        joint_sets::encode(&joint_sets::WEBXR, None, &[hand(pose)])
    });
}

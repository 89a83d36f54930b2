//! Steps with joint positions do not allocate after the start.

use ademan::capture::protocol::{body_landmarks, hand_landmarks, holistic, joint_sets};
use ademan::capture::{Reading, SourceUri};
use ademan::device::Events;
use ademan::hand::{JointPositions, Side};
use ademan::kinematics::HandPose;
use ademan::setup::Setup;

use crate::steady_state::allocations;
use crate::support::body::Person;
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

#[test]
fn a_body_and_its_hand_are_decoded_and_fused_without_allocation() {
    let setup = Setup {
        source: Some(
            "file:x?protocol=holistic&camera=head"
                .parse()
                .expect("a source"),
        ),
        ..Setup::default()
    };
    let mut decoder = setup.source.as_ref().and_then(SourceUri::protocol);
    let mut decoder = (decoder.take().expect("a protocol").decoder)(&Default::default());
    let mut pipeline = setup.load_files().expect("a valid setup").pipeline();
    let body = body_landmarks::encode(&Person::new().landmarks());
    let line = |pose: &HandPose| {
        holistic::join(
            &body,
            &hand_landmarks::encode(Some(pose.time.0), &[hand(pose)]),
        )
    };
    let lines: Vec<String> = typing_poses("h").iter().map(line).collect();
    let (mut events, mut steps) = (Events::new(), 0);
    let before = allocations();
    for pose_line in &lines {
        decoder.push(pose_line.as_bytes(), &mut |packet| {
            steps += 1;
            // Both parts have the time of the line; a source keeps them apart by a microsecond.
            let time =
                packet.time.expect("a time") + std::time::Duration::from_micros((steps + 1) % 2);
            let mut reading = Reading::new(time, Some(Side::Right), packet.sample);
            reading.part = packet.part;
            events.clear();
            let _ = std::hint::black_box(pipeline.step(&reading, &mut events));
        });
    }
    let allocated = allocations() - before;
    assert_eq!(steps, 2 * lines.len() as u64);
    assert!(
        pipeline.accepted() > steps / 2,
        "{} of {steps}",
        pipeline.accepted()
    );
    assert_eq!(allocated, 0, "{allocated} allocations in {steps} steps");
}

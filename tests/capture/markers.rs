//! Markers of three cameras over every transport, from the cameras to the typed text.

use std::fs;
use std::io::Write;
use std::net::{TcpListener, UdpSocket};

use ademan::capture::{Sample, SourceEvent, open};
use ademan::hand::{Joint, JointPositions, Side};

use crate::support::free_address::free_address;
use crate::support::source::{marker_lines, next_within, typing_poses};
use crate::text_line::{TIMEOUT, samples, type_with, uri};

const TEXT: &str = "Hola";

/// Returns how far a sample is from the poses of the hand, in metres.
fn error(sample: &Sample, pose: usize) -> f64 {
    let Sample::Joints { positions } = sample else {
        panic!("no positions: {sample:?}");
    };
    let poses = typing_poses(TEXT);
    let mut expected = JointPositions::default();
    for (joint, joint_pose) in poses[pose].known() {
        expected.set(joint, joint_pose.translation.as_dvec3());
    }
    let distance = |joint: &Joint| match (positions.get(*joint), expected.get(*joint)) {
        (Some(found), Some(expected)) => found.distance(expected),
        (None, None) => 0.0,
        _ => f64::INFINITY,
    };
    Joint::ALL.iter().map(distance).fold(0.0, f64::max)
}

#[test]
fn markers_arrive_over_tcp_and_an_invalid_line_keeps_the_connection() {
    let lines = marker_lines(TEXT);
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let mut source = open(&uri(&format!("tcp:{address}?protocol=markers"))).unwrap();
    let (mut peer, _) = listener.accept().expect("the source connects");
    peer.write_all(lines[0].as_bytes()).unwrap();
    peer.write_all(b"{\"cameras\":[]}\nnothing\n").unwrap();
    peer.write_all(lines[50].as_bytes()).unwrap();
    let received = samples(&mut *source, 2);
    assert!(error(&received[0], 0) < 1e-6);
    assert!(error(&received[1], 50) < 1e-6);
    let stats = source.stats();
    assert_eq!((stats.readings, stats.losses, stats.resyncs), (2, 0, 1));
    assert_eq!(stats.skipped_bytes, 23);
}

#[test]
fn a_datagram_holds_the_markers_of_all_cameras_and_a_cut_one_is_dropped() {
    let lines = marker_lines(TEXT);
    let sender = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let address = free_address();
    let mut source = open(&uri(&format!("udp:{address}?protocol=markers"))).unwrap();
    assert!(lines[0].len() > 4096, "a long datagram");
    let (cut, _) = lines[0].split_at(1000);
    sender.send_to(cut.as_bytes(), address).unwrap();
    sender
        .send_to(lines[0].trim_end().as_bytes(), address)
        .unwrap();
    match next_within(&mut *source, TIMEOUT) {
        Ok(SourceEvent::Reading(reading)) => {
            assert!(error(&reading.sample, 0) < 1e-6);
            assert_eq!(reading.side, Some(Side::Right));
        }
        other => panic!("no reading: {other:?}"),
    }
    assert_eq!(source.stats().skipped_bytes, 1000);
}

#[test]
fn a_file_of_markers_is_typed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("markers.jsonl");
    fs::write(&path, marker_lines(TEXT).concat()).unwrap();
    let uri = format!("file:{}?protocol=markers", path.display());
    let (text, readings) = type_with(open(&uri.parse().unwrap()).unwrap());
    assert_eq!(text, TEXT);
    let poses = typing_poses(TEXT);
    assert_eq!(readings.len(), poses.len());
    assert_eq!(readings[9].time, poses[9].time);
}

//! Motion capture files: typed, and read by an independent program.

use std::fs;
use std::io::Write;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::Command;

use ademan::capture::{CaptureError, SourceEvent, open};
use ademan::hand::Joint;

use crate::support::source::{TYPING_RATE_HZ, bvh_text, next_within, typing_poses};
use crate::text_line::{TIMEOUT, samples, type_with, uri};

const TEXT: &str = "Hola";

/// Prints the positions of all joints in all frames, computed from what the package `bvh` reads: one line of JSON per
/// frame, in the unit of the file.
const READER: &str = r##"
import json, math, sys
from bvh import Bvh

def rotation(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {
        "X": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "Y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "Z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }[axis]

def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]

def moved(origin, turned, offset):
    return [origin[i] + sum(turned[i][k] * offset[k] for k in range(3)) for i in range(3)]

file = Bvh(open(sys.argv[1]).read())
print(json.dumps(file.frame_time))
for frame in range(file.nframes):
    positions, rotations = {}, {}
    for name in file.get_joints_names():
        parent = file.joint_parent(name)
        parent = parent.name if parent else None
        turned = rotations.get(parent, [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
        offset = list(file.joint_offset(name))
        channels = file.joint_channels(name)
        values = file.frame_joint_channels(frame, name, channels)
        for channel, value in zip(channels, values):
            if channel.endswith("position"):
                offset["XYZ".index(channel[0])] = value
        positions[name] = moved(positions.get(parent, [0, 0, 0]), turned, offset)
        for channel, value in zip(channels, values):
            if channel.endswith("rotation"):
                turned = product(turned, rotation(channel[0], value))
        rotations[name] = turned
        ends = [node for node in file.get_joint(name).children if node.value[:2] == ["End", "Site"]]
        for node in ends:
            positions[name + "#end"] = moved(positions[name], turned, [float(n) for n in node["OFFSET"]])
    print(json.dumps(positions))
"##;

/// Names of the joints that the reader gives.
const NAMES: [(&str, Joint); 8] = [
    ("RightArm", Joint::Shoulder),
    ("RightForeArm", Joint::Elbow),
    ("RightHand", Joint::Wrist),
    ("RightHandIndex1", Joint::IndexPhalanxProximal),
    ("RightHandIndex3", Joint::IndexPhalanxDistal),
    ("RightHandIndex3#end", Joint::IndexTip),
    ("RightHandThumb3#end", Joint::ThumbTip),
    ("RightHandPinky3#end", Joint::LittleTip),
];

/// Returns a Python with the package `bvh`, installed once per build folder, or the reason why there is none.
fn python() -> Result<PathBuf, String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bvh-reader");
    let python = folder.join("bin/python");
    let run =
        |program: &Path, arguments: &[&str]| match Command::new(program).args(arguments).output() {
            Ok(output) if output.status.success() => Ok(()),
            Ok(output) => Err(String::from_utf8_lossy(&output.stderr).trim().to_owned()),
            Err(error) => Err(error.to_string()),
        };
    if run(&python, &["-c", "import bvh"]).is_ok() {
        return Ok(python);
    }
    let folder = folder.display().to_string();
    run(Path::new("python3"), &["-m", "venv", "--clear", &folder])?;
    let install = [
        "-m",
        "pip",
        "install",
        "--quiet",
        "--timeout",
        "10",
        "--retries",
        "1",
        "bvh==0.3",
    ];
    run(&python, &install)?;
    Ok(python)
}

#[test]
fn an_independent_reader_gives_the_captured_positions_within_a_millimetre() {
    let python = match python() {
        Ok(python) => python,
        Err(reason) => {
            println!("SKIPPED: cannot install the package bvh: {reason}");
            return;
        }
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    fs::write(&path, bvh_text(TEXT)).unwrap();
    let reader = Command::new(python)
        .args(["-c", READER])
        .arg(&path)
        .output();
    let reader = reader.expect("it starts");
    assert!(
        reader.status.success(),
        "{}",
        String::from_utf8_lossy(&reader.stderr)
    );
    let out = String::from_utf8(reader.stdout).unwrap();
    let mut lines = out.lines();
    let frame_time: f64 = lines.next().unwrap().parse().unwrap();
    assert!((frame_time * TYPING_RATE_HZ - 1.0).abs() < 1e-9);
    let poses = typing_poses(TEXT);
    let (mut frames, mut worst) = (0, 0.0_f64);
    for (frame, line) in lines.enumerate() {
        let read: serde_json::Value = serde_json::from_str(line).unwrap();
        let time = poses[0].time.0 as f64 * 1e-6 + frame as f64 * frame_time;
        let at_time = poses
            .iter()
            .rfind(|pose| pose.time.0 as f64 * 1e-6 <= time + 1e-6);
        let pose = at_time.expect("a pose at or before the frame");
        for (name, joint) in NAMES {
            let read: Vec<f64> = serde_json::from_value(read[name].clone()).expect(name);
            let [x, y, z] = pose.position(joint).expect(name).as_dvec3().to_array();
            let expected = [-x, y, -z];
            for (read, expected) in read.iter().zip(expected) {
                worst = worst.max((read * 10.0 - expected * 1000.0).abs());
            }
        }
        frames += 1;
    }
    println!("{frames} frames, largest difference {worst:.6} mm");
    assert!(
        frames >= poses.len() - 1,
        "{frames} of {} frames",
        poses.len()
    );
    assert!(worst < 1.0, "{worst} mm");
}

#[test]
fn a_motion_capture_file_is_typed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    fs::write(&path, bvh_text(TEXT)).unwrap();
    let uri = format!("file:{}?protocol=bvh", path.display());
    let (text, readings) = type_with(open(&uri.parse().unwrap()).unwrap());
    assert_eq!(text, TEXT);
    let frame_10 = (10.0 / TYPING_RATE_HZ * 1e6) as u64;
    assert!(
        readings[9].time.0.abs_diff(frame_10) <= 1,
        "{:?}",
        readings[9].time
    );
}

#[test]
fn a_damaged_file_gives_its_frames_and_then_the_line_of_the_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    let mut text = bvh_text(TEXT);
    text.extend_from_slice(b"1 2 3\n");
    fs::write(&path, &text).unwrap();
    let mut source = open(&uri(&format!("file:{}?protocol=bvh", path.display()))).unwrap();
    let mut frames = 0;
    let error = loop {
        match next_within(&mut *source, TIMEOUT) {
            Ok(SourceEvent::Reading(_)) => frames += 1,
            Ok(other) => panic!("{other:?} instead of an error"),
            Err(error) => break error,
        }
    };
    let lines = text.iter().filter(|&&byte| byte == b'\n').count();
    assert!(matches!(error, CaptureError::Malformed { .. }), "{error}");
    let message = error.to_string();
    assert!(
        message.contains(&format!("line {lines}: `1` follows the last of {frames}")),
        "{message}"
    );
    assert_eq!(source.next().unwrap(), SourceEvent::End);
}

#[test]
fn a_stream_over_tcp_starts_again_with_each_connection() {
    let text = bvh_text("h");
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let mut source = open(&uri(&format!("tcp:{address}?protocol=bvh"))).unwrap();
    let (mut peer, _) = listener.accept().expect("the source connects");
    let motion = text.windows(7).position(|at| at == b"MOTION\n").unwrap();
    peer.write_all(&text[..motion + 4000]).unwrap();
    let first = samples(&mut *source, 3);
    drop(peer);
    loop {
        match next_within(&mut *source, TIMEOUT) {
            Ok(SourceEvent::Reading(_)) => {}
            Err(CaptureError::Lost { .. }) => break,
            other => panic!("{other:?} instead of a loss"),
        }
    }
    let server = std::thread::spawn(move || {
        let (mut peer, _) = listener.accept().expect("the source connects again");
        peer.write_all(&text).unwrap();
        peer
    });
    assert_eq!(samples(&mut *source, 3), first);
    drop(server.join());
}

#[test]
fn datagrams_cannot_carry_a_motion_capture_file() {
    let error = "udp:127.0.0.1:9000?protocol=bvh".parse::<ademan::capture::SourceUri>();
    let message = error.unwrap_err().to_string();
    assert!(
        message.contains("needs a stream from its start"),
        "{message}"
    );
}

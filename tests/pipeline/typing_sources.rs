//! One text, typed on one layout through each kind of source.

use ademan::capture::protocol::{hand_landmarks, joint_sets};
use ademan::capture::{Reading, Sample, SourceUri};
use ademan::device::{EventKind, Events};
use ademan::hand::{JointPositions, Side};
use ademan::kinematics::HandPose;
use ademan::setup::Setup;
use ademan::sim::{UsTextField, error_rate};
use ademan::time::Timestamp;

use crate::support::checked::CheckedPipeline;
use crate::support::source::{TYPING_RATE_HZ, bvh_text, marker_lines, text_lines, typing_poses};

const TEXT: &str = "hola mundo";

/// A text that was typed, and the times of the presses.
struct Typed {
    text: String,
    presses: Vec<Timestamp>,
}

/// Types the bytes of a stream through the setup of its source.
fn typed(source: &str, bytes: &[u8]) -> Typed {
    let setup = Setup {
        source: Some(source.parse().expect("a source")),
        ..Setup::default()
    };
    let Some(SourceUri::Stream(stream)) = &setup.source else {
        panic!("a stream");
    };
    let mut decoder = stream.format.decoder();
    let mut pipeline = CheckedPipeline::new(&setup.load_files().expect("a valid setup"));
    let (mut field, mut presses, mut packets) = (UsTextField::new(), Vec::new(), 0);
    let mut step = |packet: ademan::capture::protocol::Packet| {
        packets += 1;
        let nominal = Timestamp::from_seconds(f64::from(packets) / TYPING_RATE_HZ);
        let time = packet.time.unwrap_or(nominal);
        let mut events = Events::new();
        let reading = Reading::new(time, packet.side, packet.sample);
        let _ = pipeline.step(&reading, &mut events);
        for event in &events {
            field.handle(event);
            if matches!(event.kind, EventKind::KeyDown(_)) {
                presses.push(event.time);
            }
        }
    };
    decoder.push(bytes, &mut step);
    decoder.finish(&mut step);
    Typed {
        text: field.text().to_owned(),
        presses,
    }
}

fn hands(pose: &HandPose) -> [(Side, JointPositions); 1] {
    let mut positions = JointPositions::default();
    for (joint, pose) in pose.known() {
        positions.set(joint, pose.translation.as_dvec3());
    }
    [(Side::Right, positions)]
}

/// Returns the presses of the poses themselves: neither encoded nor smoothed.
fn exact() -> Typed {
    let setup = Setup::default().load_files().expect("the default setup");
    let mut pipeline = CheckedPipeline::new(&setup);
    let (mut field, mut presses) = (UsTextField::new(), Vec::new());
    for pose in typing_poses(TEXT) {
        let [(side, positions)] = hands(&pose);
        let mut events = Events::new();
        let reading = Reading::new(pose.time, Some(side), Sample::Joints { positions });
        pipeline
            .step(&reading, &mut events)
            .expect("a valid reading");
        for event in &events {
            field.handle(event);
            if matches!(event.kind, EventKind::KeyDown(_)) {
                presses.push(event.time);
            }
        }
    }
    Typed {
        text: field.text().to_owned(),
        presses,
    }
}

#[test]
fn every_source_types_the_same_text_on_the_same_layout() {
    let exact = exact();
    assert_eq!(exact.text, TEXT);
    let poses = typing_poses(TEXT);
    let lines = |encode: &dyn Fn(&HandPose) -> String| poses.iter().map(encode).collect::<String>();
    let camera = |pose: &HandPose| hand_landmarks::encode(Some(pose.time.0), &hands(pose));
    let set = |protocol: &'static _| {
        move |pose: &HandPose| joint_sets::encode(protocol, Some(pose.time.0), &hands(pose))
    };
    let rate = format!("rate_hz={TYPING_RATE_HZ}");
    let sources = [
        (
            format!("file:x?protocol=text-line&{rate}"),
            text_lines(TEXT).concat().into_bytes(),
        ),
        (
            "file:x?protocol=markers".to_owned(),
            marker_lines(TEXT).concat().into_bytes(),
        ),
        ("file:x?protocol=bvh".to_owned(), bvh_text(TEXT)),
        (
            "file:x?protocol=hand-landmarks&camera=head".to_owned(),
            lines(&camera).into_bytes(),
        ),
        (
            "file:x?protocol=openxr".to_owned(),
            lines(&set(&joint_sets::OPENXR)).into_bytes(),
        ),
        (
            "file:x?protocol=webxr".to_owned(),
            lines(&set(&joint_sets::WEBXR)).into_bytes(),
        ),
    ];
    println!("| source | typed | CER | lag |");
    for (source, bytes) in sources {
        let typed = typed(&source, &bytes);
        let name = source.split_once('=').expect("a protocol").1;
        let name = name.split('&').next().expect("a name");
        let cer = 100.0 * error_rate(TEXT, &typed.text);
        let lag: f64 = typed
            .presses
            .iter()
            .zip(&exact.presses)
            .map(|(press, exact)| (press.0 as f64 - exact.0 as f64) / 1000.0)
            .sum();
        let lag = lag / exact.presses.len() as f64;
        println!("| `{name}` | {} | {cer:.1} % | {lag:.1} ms |", typed.text);
        assert_eq!(typed.text, TEXT, "{source}");
    }
}

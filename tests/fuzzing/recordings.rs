//! Recordings: a replayed recording can be recorded again, with the same content.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::LazyLock;

use ademan::capture::body::{BODY_LANDMARKS, BodyLandmarks, Landmark};
use ademan::capture::recording::message::{
    decode_external_command, decode_reading, encode_command, encode_reading,
};
use ademan::capture::recording::{
    JSON_ENCODING, MESSAGE_ENCODING, READINGS_TOPIC, RecordedSetup, Replay,
};
use ademan::capture::{Channels, Hc11Format, Reading, Sample, Source, SourceEvent};
use ademan::hand::{
    ArmBone, BoneRotations, Displacement, Dof, HandPart, Joint, JointAngles, JointPositions, Side,
};
use ademan::pipeline::PipelineState;
use ademan::recorder::Recorder;
use ademan::setup::{LoadedSetup, Setup};
use ademan::snapshot::Snapshot;
use ademan::time::Timestamp;
use ademan::trace::reading_json;
use glam::{DVec3, Quat, Vec3};
use mcap::WriteOptions;
use mcap::records::MessageHeader;

/// The content of a recording, and `true` if it is complete.
struct Replayed {
    setup: RecordedSetup,
    readings: Vec<Reading>,
    is_whole: bool,
}

fn replay(bytes: &[u8]) -> Option<Replayed> {
    let mut replay = Replay::from_reader("fuzz", bytes).ok()?;
    let mut readings = Vec::new();
    let is_whole = loop {
        match replay.next() {
            Ok(SourceEvent::Reading(reading)) => readings.push(reading),
            Ok(SourceEvent::Command(command)) => assert_eq!(command.check(), Ok(())),
            Ok(SourceEvent::End) => break replay.truncation().is_none(),
            Ok(SourceEvent::Idle) => panic!("a recording is never quiet"),
            Err(error) => {
                assert!(!error.to_string().is_empty());
                break false;
            }
        }
    };
    let counts = replay.stats();
    assert_eq!(counts.readings, readings.len() as u64);
    assert!(counts.bytes <= bytes.len() as u64 && counts.skipped_bytes <= counts.bytes);
    if let Some(cut) = replay.truncation() {
        assert!(cut.offset <= bytes.len() as u64 && !cut.reason.is_empty());
    }
    Some(Replayed {
        setup: replay.setup().clone(),
        readings,
        is_whole,
    })
}

/// Replays an input. Returns `true` if it is a recording and complete.
pub fn recording(data: &[u8]) -> bool {
    let Some(replayed) = replay(data) else {
        return false;
    };
    if !replayed.is_whole {
        return false;
    }
    // The setup may name any files, which are not opened.
    if let Some(settings) = replayed.setup.get("setup") {
        super::texts::setup(settings.text.as_bytes());
    }
    if let Some(bytes) = record(&replayed.setup, &replayed.readings) {
        let again = replay(&bytes).expect("what was recorded can be replayed");
        assert!(again.is_whole);
        assert_eq!(again.setup, replayed.setup);
        // Bytes, as a number may be NaN.
        let copied = record(&again.setup, &again.readings);
        assert!(copied == Some(bytes), "a copy of a recording differs");
    }
    true
}

/// Decodes a message as a reading and as a command. Returns `true` if it is a reading.
pub fn message(data: &[u8]) -> bool {
    if let Ok(Some(command)) = decode_external_command(data) {
        assert_eq!(command.check(), Ok(()));
        let mut message = Vec::new();
        encode_command(Timestamp(7), &command, true, &mut message);
        assert_eq!(decode_external_command(&message), Ok(Some(command)));
    }
    let Ok(reading) = decode_reading(data) else {
        return false;
    };
    let encode = |given: &Reading| {
        let mut message = Vec::new();
        encode_reading(given, &mut message);
        message
    };
    let message = encode(&reading);
    let again = decode_reading(&message).expect("what was encoded can be decoded");
    assert!(encode(&again) == message, "a copy of a reading differs");
    true
}

/// Returns messages of readings of every kind, and of commands.
pub fn message_seeds() -> Vec<Vec<u8>> {
    let mut angles = JointAngles::default();
    let mut positions = JointPositions::default();
    let mut bones = BoneRotations::default();
    let mut body = BodyLandmarks::default();
    for &dof in Dof::ALL {
        angles.set(dof, 0.1);
    }
    for &joint in Joint::ALL {
        positions.set(joint, DVec3::new(0.1, -0.2, 0.0));
    }
    for &bone in ArmBone::ALL {
        bones.right.set(bone, Quat::IDENTITY);
    }
    for _ in 0..BODY_LANDMARKS {
        body.points.push(Landmark {
            position: [0.1, 0.2, -0.3],
            confidence: 0.9,
        });
    }
    let displacement = Displacement::new(Joint::Wrist, Vec3::X, Quat::IDENTITY);
    let counts = (0..64).map(|channel| channel * 4).collect();
    let samples = [
        Sample::Channels(Channels {
            full_scale: 255,
            counts,
            unsent: Default::default(),
        }),
        Sample::Angles { angles },
        Sample::Joints { positions },
        Sample::Body(body),
        Sample::Bones { bones },
        Sample::Displacement { displacement },
    ];
    let mut messages: Vec<Vec<u8>> = samples
        .into_iter()
        .map(|sample| {
            let mut reading = Reading::new(Timestamp(12_500), Some(Side::Left), sample);
            reading.part = Some(HandPart::Fingers);
            let mut message = Vec::new();
            encode_reading(&reading, &mut message);
            message
        })
        .collect();
    for text in [
        "recenter",
        "nudge 1 -2 3",
        "tilt 5",
        "scale 0.9",
        "profile a",
        "text auto",
        "candidate 2",
    ] {
        let command = text.parse().expect("a command");
        let mut message = Vec::new();
        encode_command(Timestamp(1), &command, true, &mut message);
        messages.push(message);
    }
    messages
}

/// Returns the bytes of a recording of these readings; `None` if the recorder refuses them.
fn record(setup: &RecordedSetup, readings: &[Reading]) -> Option<Vec<u8>> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("again.mcap");
    let mut recorder = Recorder::create(&path, setup).ok()?;
    for reading in readings {
        recorder.write(&snapshot(reading)).ok()?;
    }
    recorder.finish().ok()?;
    Some(std::fs::read(&path).expect("the recording"))
}

fn snapshot(reading: &Reading) -> Snapshot {
    Snapshot {
        state: PipelineState::Paused,
        target_names: ASSEMBLY.layout.target_names(),
        reading: Some(reading.clone()),
        ..Snapshot::default()
    }
}

static ASSEMBLY: LazyLock<LoadedSetup> = LazyLock::new(|| {
    let setup = Setup {
        layout: "arrows".into(),
        ..Setup::default()
    };
    setup.load_files().expect("a shipped layout")
});

/// Returns recordings of a hand that presses an arrow key: with and without the setup, in both encodings, and each also
/// without checksum and compression, so that damage reaches the parser.
pub fn seeds() -> Vec<Vec<u8>> {
    let hand = ASSEMBLY.scripted("tap ArrowUp", &Hc11Format::default(), 0.0, 0);
    let mut hand = hand.expect("a hand");
    let mut readings = Vec::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        readings.push(reading);
    }
    readings.truncate(8);
    let recorded = [ASSEMBLY.recorded_setup(), RecordedSetup::default()];
    let compressed = recorded.map(|setup| record(&setup, &readings).expect("a recording"));
    let plain = [MESSAGE_ENCODING, JSON_ENCODING]
        .into_iter()
        .flat_map(|encoding| [true, false].map(|has_chunk| plain(&readings, encoding, has_chunk)));
    let checked: Vec<Vec<u8>> = compressed.into_iter().chain(plain).collect();
    let unchecked: Vec<Vec<u8>> = checked.iter().map(|bytes| unchecked(bytes)).collect();
    let hostile = super::hostile::recordings(&unchecked[2]);
    [checked, unchecked, hostile].concat()
}

/// Returns a recording without setup and compression.
fn plain(readings: &[Reading], encoding: &str, has_chunk: bool) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let options = WriteOptions::new()
        .use_chunks(has_chunk)
        .calculate_chunk_crcs(false)
        .compression(None);
    let mut writer = options.create(&mut bytes).expect("a recording");
    let channel = writer.add_channel(0, READINGS_TOPIC, encoding, &BTreeMap::new());
    let channel_id = channel.expect("room");
    for reading in readings {
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time: reading.time.0 * 1000,
            publish_time: reading.time.0 * 1000,
        };
        let mut message = Vec::new();
        match encoding {
            MESSAGE_ENCODING => encode_reading(reading, &mut message),
            _ => _ = reading_json(reading, &mut message),
        }
        let written = writer.write_to_known_channel(&header, &message);
        written.expect("room");
    }
    writer.finish().expect("room");
    drop(writer);
    bytes.into_inner()
}

/// Replaces the checksum by 0, which means that there is none.
fn unchecked(bytes: &[u8]) -> Vec<u8> {
    /// The start of the record that ends the data: its code and its length, 4 bytes.
    const DATA_END: [u8; 9] = [0x0f, 4, 0, 0, 0, 0, 0, 0, 0];
    let mut bytes = bytes.to_vec();
    let at = bytes.windows(9).rposition(|window| window == DATA_END);
    let at = at.expect("a recording has an end") + DATA_END.len();
    bytes[at..at + 4].fill(0);
    bytes
}

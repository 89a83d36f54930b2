//! Recordings: what is written comes back, whatever became of the file in between.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Cursor, Read};
use std::path::Path;
use std::time::Duration;

use ademan::capture::recording::{RecordedSetup, Replay};
use ademan::capture::{CaptureError, Channels, Reading, Sample, Source, SourceEvent};
use ademan::contact::{Phase, TargetId, TargetNames, Touch, Touches};
use ademan::device::{EventKind, Events, OutputEvent};
use ademan::estimate::JointAngles;
use ademan::hand::{Dof, Finger, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::pipeline::PipelineState;
use ademan::recorder::Recorder;
use ademan::snapshot::{Snapshot, Stats};
use ademan::time::Timestamp;
use parry3d::math::{Pose, Vec2, Vec3};

const READINGS: u64 = 40;

fn reading(number: u64) -> Reading {
    let count = |channel: u64| (number * 31 + channel * 7) as u16 % 256;
    Reading {
        time: Timestamp(number * 5_729),
        side: None,
        sample: Sample::Channels(Channels {
            full_scale: 255,
            counts: (0..64).map(count).collect(),
        }),
    }
}

fn snapshot(number: u64) -> Snapshot {
    let reading = reading(number);
    let time = reading.time;
    let mut angles = JointAngles::default();
    angles.set(Dof::WristFlexion, number as f64 * 0.01);
    let mut pose = HandPose::new(time, Side::Right, 0.008);
    let wrist = Pose::from_translation(Vec3::new(0.1, 0.2, -0.3));
    pose.set(Joint::Wrist, wrist);
    let touch = Touch {
        time,
        side: Side::Right,
        finger: Finger::Index,
        target: TargetId(3),
        phase: Phase::Moved,
        depth: 0.25,
        position: Vec2::new(0.001, -0.002),
    };
    let event = OutputEvent {
        time,
        kind: EventKind::KeyDown("Q".parse().unwrap()),
    };
    Snapshot {
        profile: 0,
        target_names: TargetNames::default(),
        state: PipelineState::Running,
        is_paused: false,
        reading: Some(reading),
        source_error: None,
        angles: Some(angles),
        pose: Some(pose),
        touches: Touches::from_iter([touch]),
        events: Events::from_iter([event]),
        commands: Default::default(),
        stats: Stats::default(),
    }
}

fn setup() -> RecordedSetup {
    RecordedSetup::default()
        .with("glove", "unam-hc11", "(channels: [])")
        .with("layout", "qwerty-flat", "(keys: [\"ñ\"])")
}

fn record(path: &Path) {
    let mut recorder = Recorder::create(path, &setup()).unwrap();
    for number in 0..READINGS {
        recorder.write(&snapshot(number)).unwrap();
    }
    recorder.finish().unwrap();
}

fn recorded() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    record(&path);
    fs::read(path).unwrap()
}

/// All readings of a replay, and the error that ended it.
fn readings(mut replay: Replay<impl Read + Send>) -> (Vec<Reading>, Option<CaptureError>) {
    let mut readings = Vec::new();
    loop {
        match replay.next() {
            Ok(SourceEvent::Reading(reading)) => readings.push(reading),
            Ok(SourceEvent::Idle) => {}
            Ok(SourceEvent::End) => return (readings, None),
            Err(error) => {
                assert_eq!(replay.next().unwrap(), SourceEvent::End, "after {error}");
                return (readings, Some(error));
            }
        }
    }
}

/// How many readings a replay has, and what it tells of its end: an error, or a cut.
fn all_of(mut replay: Replay<impl Read + Send>) -> (u64, Option<String>) {
    let mut readings = 0;
    loop {
        match replay.next() {
            Ok(SourceEvent::Reading(_)) => readings += 1,
            Ok(SourceEvent::Idle) => {}
            Ok(SourceEvent::End) => {
                return (readings, replay.truncation().map(|cut| format!("{cut:?}")));
            }
            Err(error) => return (readings, Some(error.to_string())),
        }
    }
}

fn replay(bytes: &[u8]) -> Result<Replay<Cursor<Vec<u8>>>, CaptureError> {
    Replay::from_reader("recording:a.mcap", Cursor::new(bytes.to_vec()))
}

fn error(bytes: &[u8]) -> String {
    replay(bytes).err().unwrap().to_string()
}

/// Where the records of a file start, each with its kind; by the layout that the specification
/// gives: 8 bytes of magic, then 1 byte of kind, 8 of length, and the contents.
fn records(bytes: &[u8]) -> Vec<(u8, usize, usize)> {
    let mut records = Vec::new();
    let mut start = 8;
    while start + 9 <= bytes.len() - 8 {
        let length = u64::from_le_bytes(bytes[start + 1..start + 9].try_into().unwrap());
        let end = start + 9 + length as usize;
        records.push((bytes[start], start, end));
        start = end;
    }
    records
}

const MESSAGE: u8 = 5;

/// Where the messages of the channel of readings start and end.
fn messages_of_readings(bytes: &[u8]) -> Vec<(usize, usize)> {
    let of_readings = |start: usize| bytes[start + 9..start + 11] == [1, 0];
    records(bytes)
        .into_iter()
        .filter(|&(kind, start, _)| kind == MESSAGE && of_readings(start))
        .map(|(_, start, end)| (start, end))
        .collect()
}

#[test]
fn what_is_recorded_comes_back_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    record(&path);
    let replay = Replay::open(&path).unwrap();
    assert_eq!(replay.name(), format!("recording:{}", path.display()));
    assert!(!replay.is_live());
    assert_eq!(*replay.setup(), setup());
    assert_eq!(
        replay.setup().get("layout").unwrap().text,
        "(keys: [\"ñ\"])"
    );
    let (readings, error) = readings(replay);
    assert!(error.is_none());
    assert_eq!(readings, (0..READINGS).map(reading).collect::<Vec<_>>());
}

#[test]
fn a_whole_recording_is_not_cut_and_its_bytes_are_accounted_for() {
    let bytes = recorded();
    let mut replay = replay(&bytes).unwrap();
    while replay.next().unwrap() != SourceEvent::End {}
    assert_eq!(replay.truncation(), None);
    let counts = replay.stats();
    assert_eq!(
        (counts.readings, counts.bytes),
        (READINGS, bytes.len() as u64)
    );
    assert_eq!(counts.skipped_bytes, 0);
}

#[test]
fn the_setup_is_at_the_start_and_needs_nothing_of_what_follows() {
    let bytes = recorded();
    let (first, _) = messages_of_readings(&bytes)[0];
    assert_eq!(*replay(&bytes[..first]).unwrap().setup(), setup());
}

#[test]
fn a_recording_cut_anywhere_gives_every_whole_reading_before_the_cut() {
    let bytes = recorded();
    let messages = messages_of_readings(&bytes);
    assert_eq!(messages.len() as u64, READINGS);
    let ends: Vec<_> = records(&bytes).iter().map(|&(_, _, end)| end).collect();
    let of_last_messages = messages[messages.len() - 3].0..bytes.len();
    let cuts = (1..bytes.len()).step_by(97).chain(of_last_messages);
    for cut in cuts {
        let mut replay = replay(&bytes[..cut]).unwrap_or_else(|error| panic!("{cut}: {error}"));
        let mut count = 0;
        while let SourceEvent::Reading(found) = replay.next().unwrap() {
            assert_eq!(found, reading(count), "cut at {cut}");
            count += 1;
        }
        let whole = messages.iter().filter(|(_, end)| *end <= cut).count();
        assert_eq!(count, whole as u64, "cut at {cut}");

        let told = replay
            .truncation()
            .unwrap_or_else(|| panic!("cut at {cut}"));
        let before = ends.iter().rfind(|end| **end <= cut).copied();
        let before = before.unwrap_or(if cut < 8 { 0 } else { 8 }) as u64;
        assert_eq!(told.offset, before, "cut at {cut}");
        assert_eq!(replay.stats().skipped_bytes, cut as u64 - before);
    }
}

#[test]
fn a_damaged_recording_never_panics_and_never_gives_more_than_there_was() {
    let bytes = recorded();
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        seed as usize
    };
    let end_of_data = records(&bytes)
        .iter()
        .find(|(kind, ..)| *kind == 0x0f)
        .map(|&(_, start, _)| start)
        .unwrap();
    let mut noticed = 0;
    let rounds = 4_000;
    for round in 0..rounds {
        let mut damaged = bytes.clone();
        // Half of them at the start, where the declarations are.
        let range = if round % 2 == 0 { 4_096 } else { end_of_data };
        damaged[next() % range] ^= 1 << (next() % 8);
        let Ok(replay) = replay(&damaged) else {
            noticed += 1;
            continue;
        };
        let (found, ending) = all_of(replay);
        assert!(found <= READINGS);
        noticed += u32::from(ending.is_some());
    }
    assert_eq!(noticed, rounds, "every flipped bit is told");
}

#[test]
fn what_is_no_recording_is_refused_with_the_place() {
    let start = "cannot use recording:a.mcap: at byte ";
    assert_eq!(error(b""), format!("{start}0, the file is empty"));
    assert_eq!(
        error(b"RIFF...."),
        format!("{start}0, it is not an MCAP file")
    );
    assert_eq!(
        error(b"\x89MCAP9\r\n"),
        format!("{start}0, it is not MCAP version 0")
    );
}

#[test]
fn a_file_without_readings_and_one_of_another_format_are_refused() {
    let file = |name: &str, format: &str| {
        let mut bytes = Cursor::new(Vec::new());
        let options = mcap::WriteOptions::new().use_chunks(false);
        let mut writer = options.create(&mut bytes).unwrap();
        let metadata = BTreeMap::from([("format".to_owned(), format.to_owned())]);
        let name = name.to_owned();
        let record = mcap::records::Metadata { name, metadata };
        writer.write_metadata(&record).unwrap();
        writer.finish().unwrap();
        drop(writer);
        bytes.into_inner()
    };
    let other = error(&file("camera", "9"));
    assert!(other.contains("it has no channel `/readings`"), "{other}");
    let newer = error(&file("ademan", "9"));
    assert!(newer.contains("it has format `9`"), "{newer}");
}

#[test]
fn a_reading_that_no_sensor_gives_ends_the_replay_at_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut recorder = Recorder::create(&path, &setup()).unwrap();
    let mut impossible = snapshot(1);
    let mut reading_of_it = reading(1);
    let Sample::Channels(channels) = &mut reading_of_it.sample else {
        panic!("it has channels");
    };
    channels.counts[3] = 256;
    impossible.reading = Some(reading_of_it);
    for snapshot in [&snapshot(0), &impossible, &snapshot(2)] {
        recorder.write(snapshot).unwrap();
    }
    recorder.finish().unwrap();
    let (second, _) = messages_of_readings(&fs::read(&path).unwrap())[1];
    let (found, error) = readings(Replay::open(&path).unwrap());
    assert_eq!(found, [reading(0)]);
    let end = format!("at byte {second}, a count is larger than its full scale");
    assert!(error.unwrap().to_string().ends_with(&end));
}

#[test]
fn a_missing_file_is_named() {
    let error = Replay::open(Path::new("/nowhere/a.mcap")).err().unwrap();
    let start = "cannot open recording:/nowhere/a.mcap: ";
    assert!(error.to_string().starts_with(start), "{error}");
}

#[test]
fn an_endless_recording_is_read_piece_by_piece() {
    /// The messages of a recording over and over.
    struct Endless {
        head: Cursor<Vec<u8>>,
        body: Vec<u8>,
    }

    impl Read for Endless {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let read = self.head.read(buffer)?;
            if read > 0 {
                return Ok(read);
            }
            self.head = Cursor::new(self.body.clone());
            self.head.read(buffer)
        }
    }

    let bytes = recorded();
    let (start, end) = messages_of_readings(&bytes)[0];
    let endless = Endless {
        head: Cursor::new(bytes[..end].to_vec()),
        body: bytes[start..end].to_vec(),
    };
    let mut replay = Replay::from_reader("recording:-", endless).unwrap();
    for _ in 0..10_000 {
        assert_eq!(replay.next().unwrap(), SourceEvent::Reading(reading(0)));
    }
}

#[test]
fn a_file_that_is_there_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    fs::write(&path, "mine").unwrap();
    let error = Recorder::create(&path, &setup()).err().unwrap().to_string();
    assert!(error.ends_with("the file exists; choose another name or remove it"));
    assert_eq!(fs::read(&path).unwrap(), b"mine");
}

#[test]
fn a_recording_that_is_not_finished_is_readable_up_to_the_last_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut recorder = Recorder::create(&path, &setup()).unwrap();
    recorder.write(&snapshot(0)).unwrap();
    let (found, _) = readings(Replay::open(&path).unwrap());
    assert_eq!(found, [reading(0)]);
    drop(recorder);
    let mut replay = Replay::open(&path).unwrap();
    while replay.next().unwrap() != SourceEvent::End {}
    assert_eq!(replay.truncation(), None);
}

#[test]
fn a_setup_that_could_not_be_read_back_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let setup = RecordedSetup::default().with("layout", "huge", &"x".repeat(5 << 20));
    let error = Recorder::create(&path, &setup).err().unwrap().to_string();
    assert!(
        error.contains("the layout huge has 5242890 bytes"),
        "{error}"
    );
    assert!(!path.exists());
}

#[cfg(unix)]
#[test]
fn only_its_owner_can_read_a_recording() {
    use std::os::unix::fs::PermissionsExt;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    record(&path);
    let mode = fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
}

#[test]
fn a_recording_keeps_the_pace_of_its_source() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("slow.mcap");
    let period = Duration::from_micros(68_750);
    let setup = RecordedSetup::default().with_packet_period(Some(period));
    let recorder = Recorder::create(&path, &setup).unwrap();
    recorder.finish().unwrap();
    assert_eq!(Replay::open(&path).unwrap().packet_period(), Some(period));
}

//! Recordings: readings are replayed as they were recorded, also from truncated and damaged files.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};
use std::time::Duration;

use ademan::capture::recording::{RecordedSetup, Replay};
use ademan::capture::{CaptureError, Channels, Reading, Sample, SampleKind, Source, SourceEvent};
use ademan::contact::{Phase, TargetId, Touch, Touches};
use ademan::device::{EventKind, Events, OutputEvent};
use ademan::estimate::JointAngles;
use ademan::hand::{Dof, Finger, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::pipeline::PipelineState;
use ademan::recorder::Recorder;
use ademan::snapshot::Snapshot;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Vec2, Vec3};

/// Readings of a recording of some chunks.
const READINGS: u64 = 400;

fn reading(number: u64) -> Reading {
    let count = |channel: u64| (number * 31 + channel * 7) as u16 % 256;
    Reading::new(
        Timestamp(number * 5_729),
        None,
        Sample::Channels(Channels {
            full_scale: 255,
            counts: (0..64).map(count).collect(),
            unsent: Default::default(),
        }),
    )
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
        state: PipelineState::Running,
        reading: Some(reading),
        angles: Some(angles),
        pose: Some(pose),
        touches: Touches::from_iter([touch]),
        events: Events::from_iter([event]),
        ..Snapshot::default()
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

/// Returns all readings of a replay, and the error that ended it.
fn readings_and_error(
    mut replay: Replay<impl Read + Send>,
) -> (Vec<Reading>, Option<CaptureError>) {
    let mut readings = Vec::new();
    loop {
        match replay.next() {
            Ok(SourceEvent::Reading(reading)) => readings.push(reading),
            Ok(SourceEvent::Idle | SourceEvent::Command(_)) => {}
            Ok(SourceEvent::End) => return (readings, None),
            Err(error) => {
                assert_eq!(replay.next().unwrap(), SourceEvent::End, "after {error}");
                return (readings, Some(error));
            }
        }
    }
}

/// Returns the number of readings of a replay and its abnormal end: an error or a truncation.
fn count_and_end(mut replay: Replay<impl Read + Send>) -> (u64, Option<String>) {
    let mut readings = 0;
    loop {
        match replay.next() {
            Ok(SourceEvent::Reading(_)) => readings += 1,
            Ok(SourceEvent::Idle | SourceEvent::Command(_)) => {}
            Ok(SourceEvent::End) => {
                return (readings, replay.truncation().map(|end| format!("{end:?}")));
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

/// Returns opcode, start and end of each record. MCAP: 8 bytes of magic, then per record 1 byte of opcode, 8 of
/// length, and the content.
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

const CHUNK: u8 = 6;

/// A chunk of a recording: its place in the file and its last time.
struct Chunk {
    start: usize,
    end: usize,
    last: Timestamp,
}

/// Returns the chunks of a recording. Their content begins with their first and last time in nanoseconds.
fn chunks(bytes: &[u8]) -> Vec<Chunk> {
    let chunks = records(bytes)
        .into_iter()
        .filter(|record| record.0 == CHUNK);
    chunks
        .map(|(_, start, end)| {
            let time = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
            let (first, last) = (time(start + 9), time(start + 17));
            assert!(last - first < 1_000_000_000, "a chunk is shorter than 1 s");
            let last = Timestamp(last / 1000);
            Chunk { start, end, last }
        })
        .collect()
}

#[test]
fn readings_and_setup_are_replayed_as_recorded() {
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
    let (readings, error) = readings_and_error(replay);
    assert!(error.is_none());
    assert_eq!(readings, (0..READINGS).map(reading).collect::<Vec<_>>());
}

#[test]
fn a_complete_recording_is_not_truncated_and_all_bytes_are_counted() {
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
fn the_setup_is_readable_without_the_readings() {
    let bytes = recorded();
    let first = chunks(&bytes)[0].start;
    assert_eq!(*replay(&bytes[..first]).unwrap().setup(), setup());
}

#[test]
fn a_recording_cut_at_any_byte_gives_everything_but_its_last_second() {
    // Few readings far apart, so that the file has some chunks and is small.
    let numbers: Vec<u64> = (0..16).map(|index| index * 30).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.mcap");
    let mut recorder = Recorder::create(&path, &setup()).unwrap();
    for &number in &numbers {
        recorder.write(&snapshot(number)).unwrap();
    }
    recorder.finish().unwrap();
    let bytes = fs::read(&path).unwrap();
    let chunks = chunks(&bytes);
    let (first, last) = (&chunks[0], &chunks[chunks.len() - 1]);
    assert!(chunks.len() > 3, "the recording has some chunks");
    assert_eq!(last.last, reading(numbers[15]).time);
    let ends: Vec<_> = records(&bytes).iter().map(|&(_, _, end)| end).collect();
    let declarations = (1..first.start).step_by(997);
    let summary = (last.end + 40..bytes.len()).step_by(997);
    let chunk_bytes = first.start..last.end + 40;
    for length in declarations.chain(chunk_bytes).chain(summary) {
        let mut replay =
            replay(&bytes[..length]).unwrap_or_else(|error| panic!("{length}: {error}"));
        let mut count = 0;
        while let SourceEvent::Reading(replayed) = replay.next().unwrap() {
            assert_eq!(replayed, reading(numbers[count]), "cut at {length}");
            count += 1;
        }
        let complete = chunks.iter().rfind(|chunk| chunk.end <= length);
        let complete = complete.map_or(0, |chunk| {
            numbers.partition_point(|&number| reading(number).time <= chunk.last)
        });
        assert_eq!(count, complete, "cut at {length}");

        let truncation = replay
            .truncation()
            .unwrap_or_else(|| panic!("cut at {length}"));
        let before = ends.iter().rfind(|end| **end <= length).copied();
        let before = before.unwrap_or(if length < 8 { 0 } else { 8 }) as u64;
        assert_eq!(truncation.offset, before, "cut at {length}");
        assert_eq!(replay.stats().skipped_bytes, length as u64 - before);
    }
}

#[test]
fn a_long_recording_cut_anywhere_gives_everything_but_its_last_second() {
    const READINGS: u64 = 5_000;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.mcap");
    let mut recorder = Recorder::create(&path, &setup()).unwrap();
    // The size of the file after each reading is what a crash at that time leaves.
    let mut lengths = Vec::new();
    for number in 0..READINGS {
        recorder.write(&snapshot(number)).unwrap();
        lengths.push(fs::metadata(&path).unwrap().len());
    }
    recorder.finish().unwrap();
    let bytes = fs::read(&path).unwrap();
    let mut random = fastrand::Rng::with_seed(7);
    for _ in 0..30 {
        let length = random.usize(60_000..bytes.len());
        let (count, end) = count_and_end(replay(&bytes[..length]).unwrap());
        assert!(end.is_some(), "cut at {length}");
        let written = lengths.partition_point(|&written| written <= length as u64) as u64;
        let lost = reading(written).time.since(reading(count).time);
        assert!(lost < Duration::from_secs(1), "cut at {length}: {lost:?}");
    }
}

#[test]
fn every_flipped_bit_of_a_recording_is_detected() {
    let bytes = recorded();
    let mut random = fastrand::Rng::with_seed(1);
    let end_of_data = records(&bytes)
        .iter()
        .find(|(kind, ..)| *kind == 0x0f)
        .map(|&(_, start, _)| start)
        .unwrap();
    let mut detected = 0;
    let rounds = 4_000;
    for round in 0..rounds {
        let mut damaged = bytes.clone();
        // Half of the bits are at the start, where the declarations are.
        let range = if round % 2 == 0 { 4_096 } else { end_of_data };
        damaged[random.usize(..range)] ^= 1 << random.u8(..8);
        let Ok(replay) = replay(&damaged) else {
            detected += 1;
            continue;
        };
        let (count, end) = count_and_end(replay);
        assert!(count <= READINGS);
        detected += u32::from(end.is_some());
    }
    assert_eq!(detected, rounds, "every flipped bit is detected");
}

#[test]
fn other_files_are_rejected_with_their_offset() {
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
fn files_without_readings_and_of_another_format_are_rejected() {
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
fn an_impossible_reading_ends_the_replay_with_the_offset_of_its_chunk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut recorder = Recorder::create(&path, &setup()).unwrap();
    let mut impossible = snapshot(1);
    let mut impossible_reading = reading(1);
    let Sample::Channels(channels) = &mut impossible_reading.sample else {
        panic!("not channels");
    };
    channels.counts[3] = 256;
    impossible.reading = Some(impossible_reading);
    for snapshot in [&snapshot(0), &impossible, &snapshot(2)] {
        recorder.write(snapshot).unwrap();
    }
    recorder.finish().unwrap();
    let chunk = chunks(&fs::read(&path).unwrap())[0].start;
    let (replayed, error) = readings_and_error(Replay::open(&path).unwrap());
    assert_eq!(replayed, [reading(0)]);
    let end = format!("at byte {chunk}, a count is larger than its full scale");
    assert!(error.unwrap().to_string().ends_with(&end));
}

#[test]
fn a_missing_file_is_named_in_the_error() {
    let error = Replay::open(Path::new("/nowhere/a.mcap")).err().unwrap();
    let start = "cannot open recording:/nowhere/a.mcap: ";
    assert!(error.to_string().starts_with(start), "{error}");
}

#[test]
fn an_endless_recording_is_read_in_pieces() {
    /// Reader of a recording whose first chunk repeats endlessly.
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
    let first = &chunks(&bytes)[0];
    let endless = Endless {
        head: Cursor::new(bytes[..first.end].to_vec()),
        body: bytes[first.start..first.end].to_vec(),
    };
    let numbers = (0..READINGS).take_while(|&number| reading(number).time <= first.last);
    let numbers: Vec<u64> = numbers.collect();
    let mut replay = Replay::from_reader("recording:-", endless).unwrap();
    let mut latest = Timestamp(0);
    for &number in numbers.iter().cycle().take(10_000) {
        // The times of the repeated chunk would go back.
        latest = latest.max(reading(number).time);
        let expected = Reading {
            time: latest,
            ..reading(number)
        };
        assert_eq!(replay.next().unwrap(), SourceEvent::Reading(expected));
    }
}

#[test]
fn an_existing_file_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    fs::write(&path, "mine").unwrap();
    let error = Recorder::create(&path, &setup()).err().unwrap().to_string();
    assert!(error.ends_with("the file exists; choose another name or remove it"));
    assert_eq!(fs::read(&path).unwrap(), b"mine");
}

#[test]
fn an_unfinished_recording_is_readable_up_to_its_last_flush() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut recorder = Recorder::create(&path, &setup()).unwrap();
    recorder.write(&snapshot(0)).unwrap();
    recorder.flush().unwrap();
    let (replayed, _) = readings_and_error(Replay::open(&path).unwrap());
    assert_eq!(replayed, [reading(0)]);
    drop(recorder);
    let mut replay = Replay::open(&path).unwrap();
    while replay.next().unwrap() != SourceEvent::End {}
    assert_eq!(replay.truncation(), None);
}

#[test]
fn a_setup_text_that_exceeds_the_record_limit_is_rejected() {
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
fn only_the_owner_can_read_a_recording() {
    use std::os::unix::fs::PermissionsExt;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    record(&path);
    let mode = fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
}

#[test]
fn a_recording_keeps_the_packet_period_of_its_source() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("slow.mcap");
    let period = Duration::from_micros(68_750);
    let setup = RecordedSetup::default().with_packet_period(Some(period));
    let recorder = Recorder::create(&path, &setup).unwrap();
    recorder.finish().unwrap();
    assert_eq!(Replay::open(&path).unwrap().packet_period(), Some(period));
}

/// The recordings of the folder `tests/recordings`, which have format 1: messages in JSON without chunks.
fn json_recordings() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recordings");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let mut paths: Vec<PathBuf> = files.map(|file| file.path()).collect();
    paths.retain(|path| {
        path.extension()
            .is_some_and(|extension| extension == "mcap")
    });
    let is_json = |path: &PathBuf| {
        let bytes = fs::read(path).unwrap();
        records(&bytes).iter().all(|record| record.0 != CHUNK)
    };
    paths.retain(is_json);
    paths
}

#[test]
fn readings_of_every_kind_of_sensor_have_the_same_bits_in_both_formats() {
    let recordings = json_recordings();
    let mut kinds = Vec::new();
    for path in &recordings {
        let old = Replay::open(path).unwrap();
        let setup = old.setup().clone();
        let (readings, error) = readings_and_error(old);
        assert!(
            error.is_none() && readings.len() > 50,
            "{path:?}: {error:?}"
        );
        let folder = tempfile::tempdir().unwrap();
        let copy = folder.path().join("copy.mcap");
        let mut recorder = Recorder::create(&copy, &setup).unwrap();
        for reading in &readings {
            recorder.write_reading(reading).unwrap();
        }
        recorder.finish().unwrap();
        let new = Replay::open(&copy).unwrap();
        assert_eq!(*new.setup(), setup);
        let (copied, new_error) = readings_and_error(new);
        assert!(new_error.is_none(), "{new_error:?}");
        // JSON distinguishes 0 from −0.
        let json = |list: &[Reading]| serde_json::to_string(list).unwrap();
        assert!(json(&copied) == json(&readings), "{path:?}");
        kinds.push(readings[0].sample.kind());
    }
    for kind in [
        SampleKind::Channels,
        SampleKind::Angles,
        SampleKind::Joints,
        SampleKind::Body,
        SampleKind::Bones,
        SampleKind::Displacement,
    ] {
        assert!(
            kinds.contains(&kind),
            "no recording of format 1 has {kind:?}"
        );
    }
}

#[test]
fn a_channel_that_was_not_measured_is_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut recorder = Recorder::create(&path, &setup()).unwrap();
    let mut partial = reading(0);
    if let Sample::Channels(channels) = &mut partial.sample {
        channels.counts[7] = Channels::UNKNOWN;
    }
    recorder.write_reading(&partial).unwrap();
    recorder.finish().unwrap();
    let (replayed, error) = readings_and_error(Replay::open(&path).unwrap());
    assert!(error.is_none(), "{error:?}");
    assert_eq!(replayed, [partial]);
}

/// Returns a recording of format 2 whose only chunk states these sizes and this compression.
fn with_chunk(compression: &str, uncompressed_size: u64, data: &[u8]) -> Vec<u8> {
    let bytes = recorded();
    let first = chunks(&bytes)[0].start;
    let mut chunk = vec![0; 16];
    chunk.extend(uncompressed_size.to_le_bytes());
    chunk.extend(0_u32.to_le_bytes());
    chunk.extend((compression.len() as u32).to_le_bytes());
    chunk.extend(compression.as_bytes());
    chunk.extend((data.len() as u64).to_le_bytes());
    chunk.extend(data);
    let length = (chunk.len() as u64).to_le_bytes();
    [&bytes[..first], &[CHUNK], &length, &chunk].concat()
}

#[test]
fn chunks_that_are_not_what_they_state_are_refused() {
    let huge = error(&with_chunk("lz4", u64::MAX, b""));
    assert!(
        huge.contains("a chunk states a size of 18446744073709551615 bytes"),
        "{huge}"
    );
    let noise = error(&with_chunk("lz4", 9, b"no frame of LZ4"));
    assert!(
        noise.contains("a chunk cannot be decompressed: the file was damaged"),
        "{noise}"
    );
    let long = error(&with_chunk("", 9, &[0; 10]));
    assert!(
        long.contains("a chunk has another size than it states"),
        "{long}"
    );
    let record = error(&with_chunk("", 9, &[5, 1, 0, 0, 0, 0, 0, 0, 0]));
    assert!(
        record.contains("a record is longer than its chunk"),
        "{record}"
    );
    let foreign = error(&with_chunk("zstd", 9, &[0; 9]));
    assert!(
        foreign.contains("its chunks are compressed with `zstd`, and this program reads `lz4`"),
        "{foreign}"
    );
}

#[test]
fn times_of_a_recording_never_decrease() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("back.mcap");
    let mut recorder = Recorder::create(&path, &setup()).unwrap();
    for time in [100_000_000, 5, 99_000_000, 100_000_000, 101_000_000] {
        let reading = Reading {
            time: Timestamp(time),
            ..reading(1)
        };
        recorder.write_reading(&reading).unwrap();
    }
    recorder.finish().unwrap();
    let (replayed, _) = readings_and_error(Replay::open(&path).unwrap());
    let times: Vec<_> = replayed.iter().map(|reading| reading.time.0).collect();
    let latest = 100_000_000;
    assert_eq!(times, [latest, latest, latest, latest, 101_000_000]);
}

/// Returns a metadata record with a setup text.
fn setup_record(kind: &str, text: &str) -> Vec<u8> {
    let mut fields = Vec::new();
    let put = |record: &mut Vec<u8>, word: &str| {
        record.extend((word.len() as u32).to_le_bytes());
        record.extend(word.as_bytes());
    };
    for (key, value) in [("kind", kind), ("name", "a name"), ("text", text)] {
        put(&mut fields, key);
        put(&mut fields, value);
    }
    let mut content = Vec::new();
    put(&mut content, "ademan.setup");
    content.extend((fields.len() as u32).to_le_bytes());
    content.extend(fields);
    const METADATA: u8 = 12;
    let length = (content.len() as u64).to_le_bytes();
    [&[METADATA][..], &length, &content].concat()
}

/// Returns the bytes of the setup texts that a replay keeps.
fn setup_bytes(replay: &Replay<impl Read + Send>) -> usize {
    let entries = replay.setup().entries.iter();
    entries.map(|entry| entry.text.len()).sum()
}

#[test]
fn setup_texts_that_expand_come_late_or_repeat_a_kind_take_no_memory() {
    let bytes = recorded();
    let first = chunks(&bytes)[0].start;
    let own = setup_bytes(&replay(&bytes).unwrap());
    let text = "x".repeat(1_000_000);

    let repeated = setup_record("layout", &text).repeat(50);
    let repeated = [&bytes[..first], &repeated, &bytes[first..]].concat();
    assert_eq!(setup_bytes(&replay(&repeated).unwrap()), own);

    let mut late = bytes.clone();
    late.truncate(chunks(&bytes)[1].end);
    late.extend((0..50).flat_map(|kind| setup_record(&kind.to_string(), &text)));
    let mut late = replay(&late).unwrap();
    while late.next().unwrap() != SourceEvent::End {}
    assert_eq!(setup_bytes(&late), own);

    let content = setup_record("expanding", &text);
    let chunk = with_chunk("", content.len() as u64, &content);
    assert_eq!(setup_bytes(&replay(&chunk).unwrap()), own);
}

#[test]
fn setup_texts_beyond_the_limits_are_refused() {
    let bytes = recorded();
    let first = chunks(&bytes)[0].start;
    let text = "x".repeat(1_000_000);
    let many: Vec<u8> = (0..50)
        .flat_map(|kind| setup_record(&kind.to_string(), &text))
        .collect();
    let many = error(&[&bytes[..first], &many].concat());
    assert!(many.contains("more than the limit of 33554432"), "{many}");
    let large = setup_record("large", &"x".repeat(2_000_000));
    let large = error(&[&bytes[..first], &large].concat());
    assert!(large.contains("more than the limit of 1048576"), "{large}");
}

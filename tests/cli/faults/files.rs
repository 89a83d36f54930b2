//! Malicious and damaged files.

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::Path;

use ademan::capture::recording::{
    FORMAT_RECORD, JSON_ENCODING, JSON_FORMAT_VERSION, MAX_RECORD_BYTES, READINGS_TOPIC, Replay,
};
use ademan::capture::{Source, SourceEvent};
use ademan::files::Load;
use ademan::layout::Layout;
use mcap::records::{MessageHeader, Metadata};

use crate::run;
use crate::support::run::shipped;

/// Returns a recording with these messages in place of readings.
fn recording(messages: &[&[u8]]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().use_chunks(false);
    let mut writer = options.create(&mut bytes).expect("a recording");
    let metadata = BTreeMap::from([("format".to_owned(), JSON_FORMAT_VERSION.to_owned())]);
    let name = FORMAT_RECORD.to_owned();
    writer
        .write_metadata(&Metadata { name, metadata })
        .expect("room");
    let channel_id = writer
        .add_channel(0, READINGS_TOPIC, JSON_ENCODING, &BTreeMap::new())
        .expect("room");
    for (sequence, data) in messages.iter().enumerate() {
        let header = MessageHeader {
            channel_id,
            sequence: sequence as u32,
            log_time: sequence as u64,
            publish_time: sequence as u64,
        };
        writer.write_to_known_channel(&header, data).expect("room");
    }
    writer.finish().expect("room");
    drop(writer);
    bytes.into_inner()
}

/// Bytes of the schemas at the start of a recording, and again at its end.
const SCHEMA_BYTES: usize = 67_000;

const READING: &str = r#"{"time_us":1000,"full_scale":255,"channels":[1,2,3]}"#;

/// Returns the number of readings of a recording, and the error at its end.
fn replay_all(bytes: Vec<u8>) -> (usize, String) {
    let replay = Replay::from_reader("recording:a.mcap", Cursor::new(bytes));
    let mut replay = match replay {
        Ok(replay) => replay,
        Err(error) => return (0, error.to_string()),
    };
    let mut readings = 0;
    loop {
        match replay.next() {
            Ok(SourceEvent::Reading(_)) => readings += 1,
            Ok(SourceEvent::Idle | SourceEvent::Command(_)) => {}
            Ok(SourceEvent::End) => return (readings, String::new()),
            Err(error) => return (readings, error.to_string()),
        }
    }
}

fn refused(message: &[u8]) -> String {
    let (readings, error) = replay_all(recording(&[READING.as_bytes(), message]));
    let shown = String::from_utf8_lossy(&message[..message.len().min(80)]).into_owned();
    assert_eq!(readings, 1, "{shown}");
    assert!(error.contains("at byte "), "{shown}: {error}");
    error
}

#[test]
fn a_complete_reading_is_accepted() {
    assert_eq!(
        replay_all(recording(&[READING.as_bytes()])),
        (1, String::new())
    );
}

#[test]
fn json_that_is_too_deep_too_long_or_has_duplicate_keys_is_refused() {
    let deep = |open: &str| {
        format!(
            "{{\"time_us\":1,\"full_scale\":255,\"x\":{}",
            open.repeat(10_000)
        )
    };
    refused(deep("[").as_bytes());
    refused(deep("{\"a\":").as_bytes());
    refused(format!("{{\"channels\":{}", "[".repeat(10_000)).as_bytes());
    let long = "9".repeat(1 << 20);
    refused(READING.replace("1000", &long).as_bytes());
    refused(READING.replace("[1,", &format!("[{long},")).as_bytes());
    refused(READING.replace("{", r#"{"time_us":7,"#).as_bytes());
    refused(READING.replace("{", r#"{"full_scale":7,"#).as_bytes());
    refused(READING.replace("{", r#"{"channels":[7],"#).as_bytes());
    let many = format!("[{}1]", "1,".repeat(100_000));
    refused(READING.replace("[1,2,3]", &many).as_bytes());
}

#[test]
fn numbers_that_no_sensor_can_measure_are_refused() {
    for count in [
        "NaN",
        "Infinity",
        "-Infinity",
        "1e308",
        "1e999",
        "5e-324",
        "-0.0",
        "-1",
        "1.5",
        "256",
        "null",
    ] {
        refused(READING.replace("[1,", &format!("[{count},")).as_bytes());
    }
    for time in ["NaN", "-1", "1e999", "0.5", "18446744073709551616"] {
        refused(READING.replace("1000", time).as_bytes());
    }
    // The last possible time: nothing overflows.
    let last = READING.replace("1000", "18446744073709551615");
    let (readings, _) = replay_all(recording(&[READING.as_bytes(), last.as_bytes()]));
    assert_eq!(readings, 2);
}

#[test]
fn invalid_utf8_is_refused_in_readings_and_files() {
    for bytes in [&b"\xff\xfe"[..], b"\xc3\x28", b"\xed\xa0\x80", b"\0"] {
        let message = [b"{\"time_us\":1,\"x\":\"", bytes, b"\"}"].concat();
        refused(&message);
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ron");
    let load = |bytes: &[u8]| {
        fs::write(&path, bytes).expect("room");
        Layout::load(path.to_str().expect("a plain path"))
    };
    let good = shipped("arrows");
    for bytes in [&b"\xff\xfe"[..], b"\xc3\x28", b"\0"] {
        let error = load(&[bytes, good.as_bytes()].concat()).expect_err("invalid text");
        assert_eq!(error.line(), Some(1), "{error}");
    }
    let targets = |layout: Layout| layout.scene.len();
    let plain = targets(load(good.as_bytes()).expect("a layout"));
    let marked = load(format!("\u{feff}{}", good.replace('\n', "\r\n")).as_bytes());
    assert_eq!(
        targets(marked.expect("a byte order mark and CRLF are accepted")),
        plain
    );
}

#[test]
fn a_length_of_four_gigabytes_is_refused_before_memory_is_allocated() {
    let whole = recording(&[READING.as_bytes()]);
    for length in [u64::from(u32::MAX), u64::MAX, MAX_RECORD_BYTES as u64 + 1] {
        // The first record begins after the magic number, with a kind and a length.
        let mut bytes = whole.clone();
        bytes[9..17].copy_from_slice(&length.to_le_bytes());
        let (readings, error) = replay_all(bytes);
        assert_eq!(readings, 0);
        assert!(error.contains("at byte 8"), "{error}");
        assert!(error.contains("the limit is"), "{error}");
    }
}

#[test]
fn a_damaged_recording_is_played_up_to_the_damage_releases_everything_and_ends_with_3() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hand.mcap");
    let recorded = path.to_str().expect("a plain path");
    run(["record", recorded, "--source", "typist:hola"]).done();
    let bytes = fs::read(&path).expect("the recording");
    let whole = run(["replay", recorded]).out;
    let damaged = |name: &str, content: &[u8]| {
        let file = folder.path().join(name);
        fs::write(&file, content).expect("room");
        file.to_str().expect("a plain path").to_owned()
    };
    let messages = bytes.len() - 2 * SCHEMA_BYTES;
    let mut held = 0;
    for eighths in [3, 4, 5, 6] {
        let cut = damaged("cut.mcap", &bytes[..SCHEMA_BYTES + messages * eighths / 8]);
        let ended = run(["replay", &cut]).exited(3);
        ended.reported("cut off at byte ");
        held += check_releases(&ended.out, &whole);
    }
    assert!(held > 0, "no key is pressed at a cut");
    let mut broken = bytes.clone();
    broken[SCHEMA_BYTES + messages * 6 / 8] ^= 0x10;
    let ended = run(["replay", &damaged("broken.mcap", &broken)]).exited(3);
    ended.reported("at byte ");
    let held_at_the_damage = check_releases(&ended.out, &whole);
    assert!(held_at_the_damage > 0, "no key is pressed at the damage");
    for (name, content) in [
        ("empty", &b""[..]),
        ("letter", b"Dear reader"),
        ("version", b"\x89MCAP9\r\n"),
    ] {
        let odd = run(["replay", &damaged(name, content)]);
        assert_eq!((odd.code, &*odd.out), (Some(3), ""), "{name}: {}", odd.err);
        assert!(odd.err.contains("at byte 0"), "{name}: {}", odd.err);
    }
    assert!(Path::new(recorded).exists());
}

/// Checks that `part` is the start of `whole`, followed by releases only. Returns their number.
fn check_releases(part: &str, whole: &str) -> usize {
    let same = part.lines().zip(whole.lines()).take_while(|(a, b)| a == b);
    let rest: Vec<_> = part.lines().skip(same.count()).collect();
    assert!(
        rest.len() <= 2 && rest.iter().all(|line| line.contains(" up ")),
        "{part}"
    );
    assert_eq!(
        part.matches("down ").count(),
        part.matches(" up ").count(),
        "{part}"
    );
    rest.len()
}

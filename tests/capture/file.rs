//! Streams in files.

use std::path::Path;

use ademan::capture::hc11::{Framing, encode};
use ademan::capture::{SourceEvent, SourceUri, open};

fn uri(path: &Path, options: &str) -> SourceUri {
    let text = format!("file:{}?{options}", path.display());
    text.parse().unwrap()
}

#[test]
fn a_file_plays_at_the_nominal_bit_rate_to_its_last_packet() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let mut bytes = b"noise".to_vec();
    for number in 1..=30 {
        bytes.extend(encode(Framing::Double06, &[number; 64]));
    }
    std::fs::write(file.path(), bytes).unwrap();
    let mut source = open(&uri(file.path(), "baud=9600")).unwrap();
    assert!(!source.is_live());
    for number in 1..=30 {
        let SourceEvent::Reading(reading) = source.next().unwrap() else {
            panic!("no packet {number}");
        };
        assert_eq!(reading.time.0, number * 68_750);
    }
    assert_eq!(source.next().unwrap(), SourceEvent::End);
    assert_eq!(source.next().unwrap(), SourceEvent::End);
    let stats = source.stats();
    assert_eq!(
        (stats.readings, stats.skipped_bytes, stats.losses),
        (30, 5, 0)
    );
}

#[test]
fn a_file_of_text_lines_plays_at_its_rate_and_needs_no_last_line_end() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let line = "1.5 ".repeat(64);
    std::fs::write(file.path(), format!("{line}\nnonsense\n{line}")).unwrap();
    let mut source = open(&uri(file.path(), "protocol=text-line&rate_hz=50")).unwrap();
    let mut times = Vec::new();
    loop {
        match source.next().unwrap() {
            SourceEvent::Reading(reading) => times.push(reading.time.0),
            SourceEvent::Idle | SourceEvent::Command(_) => {}
            SourceEvent::End => break,
        }
    }
    assert_eq!(times, [20_000, 40_000]);
    assert_eq!(
        (source.stats().readings, source.stats().skipped_bytes),
        (2, 9)
    );
}

#[test]
fn folders_and_missing_files_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let message = |path: &Path| open(&uri(path, "baud=9600")).err().unwrap().to_string();
    assert!(message(folder.path()).contains("this is a directory"));
    assert!(message(&folder.path().join("absent")).contains("cannot open file:"));
}

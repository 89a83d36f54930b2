//! A recording gives the same transcript, byte for byte, every time, at any speed, in every build.
//!
//! The expected transcripts are in the files beside this one, for debug and release builds and for all machines. After an
//! intended change:
//! `ADEMAN_WRITE=1 cargo test --test cli determinism`, and review the difference.

mod gap;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use ademan::capture::Source;
use ademan::capture::recording::Replay;
use ademan::output::Transcript;
use ademan::session::{CommandReceiver, run_pipeline};
use ademan::setup::{LoadedSetup, ReplaySettings};
use tempfile::TempDir;

use crate::support::recording;
use crate::support::wearer::shipped_setup;

/// The number of replays of each recording.
const TIMES: usize = 100;

/// The recordings: the name of the expected transcript, the layout, and the script of the hand.
const RECORDINGS: [(&str, &str, &str); 3] = [
    (
        "keys",
        "qwerty-flat",
        "tap ShiftLeft; tap H; press J; slide 19 0; lift",
    ),
    ("slider", "media", "press Seek 0 0; slide 20 0 500; lift"),
    (
        "stick",
        "game",
        "press Stick; slide 10 8 300; lift; bend ring 50 200",
    ),
];

/// A buffer that can be read while a transcript writes to it.
#[derive(Clone, Default)]
struct SharedBuffer(Arc<Mutex<Vec<u8>>>);

impl Write for SharedBuffer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0
            .lock()
            .expect("no panic while it is locked")
            .write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Records the simulated hand that plays a script.
fn record(folder: &TempDir, (name, layout, script): (&str, &str, &str)) -> PathBuf {
    let loaded = shipped_setup(layout);
    let source = format!("script:{script}").parse().expect("a source");
    let hand = loaded.open_source(&source).expect("the hand can do it");
    record_source(folder, name, &loaded, hand)
}

/// Records the readings of a source with a setup.
fn record_source(
    folder: &TempDir,
    name: &str,
    loaded: &LoadedSetup,
    source: Box<dyn Source>,
) -> PathBuf {
    let path = folder.path().join(format!("{name}.mcap"));
    recording::record_source(&path, loaded, source);
    path
}

/// Returns the transcript of a recording, replayed without delays.
fn replay(path: &Path) -> Vec<u8> {
    let replay = Replay::open(path).expect("a recording");
    let loaded = LoadedSetup::from_recording(replay.setup(), &ReplaySettings::default())
        .expect("the recorded setup");
    let page = SharedBuffer::default();
    let mut transcript = Transcript::new("test", page.clone());
    let mut pipeline = loaded.pipeline();
    let run = run_pipeline(
        replay,
        &mut pipeline,
        &mut transcript,
        &CommandReceiver::disconnected(),
        &mut |_| {},
    );
    run.expect("a run");
    drop(transcript);
    page.0.lock().expect("no panic while it is locked").clone()
}

/// Returns the transcript of `ademan replay` at a speed, or without delays if `None`.
fn replay_by_program(path: &Path, speed: Option<&str>) -> Vec<u8> {
    let mut command = crate::support::binary::ademan(["replay", path.to_str().expect("letters")]);
    if let Some(speed) = speed {
        command.args(["--speed", speed]);
    }
    let output = command.output().expect("it starts");
    assert!(output.status.success(), "{output:?}");
    output.stdout
}

fn expected(name: &str, found: &[u8]) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/determinism");
    let path = folder.join(format!("{name}.out"));
    if std::env::var_os("ADEMAN_WRITE").is_some() {
        fs::write(&path, found).expect("it can be written");
    }
    fs::read(path).expect("the expected transcript")
}

#[track_caller]
fn assert_same(name: &str, how: &str, found: &[u8], expected: &[u8]) {
    if found != expected {
        let (found, expected) = (
            String::from_utf8_lossy(found),
            String::from_utf8_lossy(expected),
        );
        let line = found
            .lines()
            .zip(expected.lines())
            .position(|(found, expected)| found != expected);
        panic!(
            "{name}, {how}: differs from line {line:?} on\nfound:\n{found}\nexpected:\n{expected}"
        );
    }
}

#[test]
fn a_recording_gives_the_same_bytes_in_each_of_a_hundred_replays() {
    let folder = tempfile::tempdir().expect("a folder");
    for recording in RECORDINGS {
        let name = recording.0;
        let path = record(&folder, recording);
        let first = replay(&path);
        let expected = expected(name, &first);
        assert!(
            expected.len() > 100,
            "the transcript of {name} is not empty"
        );
        assert_same(name, "the first time", &first, &expected);
        for time in 2..=TIMES {
            assert_same(name, &format!("time {time}"), &replay(&path), &expected);
        }
        println!("{name}: {TIMES} times {} bytes", expected.len());
    }
}

#[test]
fn the_program_gives_the_same_bytes_at_any_speed() {
    let folder = tempfile::tempdir().expect("a folder");
    std::thread::scope(|scope| {
        for recording in RECORDINGS {
            let path = record(&folder, recording);
            scope.spawn(move || {
                let first = replay_by_program(&path, None);
                let expected = expected(recording.0, &first);
                assert_same(recording.0, "without delays", &first, &expected);
                for speed in ["10", "10", "10", "1"] {
                    let found = replay_by_program(&path, Some(speed));
                    assert_same(recording.0, &format!("speed {speed}"), &found, &expected);
                }
            });
        }
    });
}

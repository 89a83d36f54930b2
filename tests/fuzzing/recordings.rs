//! Recordings: a replayed recording can be recorded again, with the same content.

use std::sync::LazyLock;

use ademan::capture::recording::{RecordedSetup, Replay};
use ademan::capture::{Hc11Format, Reading, Source, SourceEvent};
use ademan::contact::Touches;
use ademan::device::Events;
use ademan::pipeline::PipelineState;
use ademan::recorder::Recorder;
use ademan::setup::{LoadedSetup, Setup};
use ademan::snapshot::{Snapshot, Stats};

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
        assert_eq!(again.readings, replayed.readings);
        assert_eq!(again.setup, replayed.setup);
    }
    true
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
        source_error: None,
        state: PipelineState::Paused,
        profile: 0,
        target_names: ASSEMBLY.layout.target_names(),
        paused_by: None,
        reading: Some(reading.clone()),
        angles: None,
        pose: None,
        touches: Touches::new(),
        events: Events::new(),
        commands: Default::default(),
        executed: None,
        lost_hands: Default::default(),
        stats: Stats::default(),
    }
}

static ASSEMBLY: LazyLock<LoadedSetup> = LazyLock::new(|| {
    let setup = Setup {
        layout: "arrows".into(),
        ..Setup::default()
    };
    setup.load_files().expect("a shipped layout")
});

/// Returns recordings of a hand that presses an arrow key: with and without the setup, each with and without a checksum,
/// so that damage reaches the parser.
pub fn seeds() -> Vec<Vec<u8>> {
    let hand = ASSEMBLY.scripted("tap ArrowUp", &Hc11Format::default(), 0.0, 0);
    let mut hand = hand.expect("a hand");
    let mut readings = Vec::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        readings.push(reading);
    }
    let recorded = [ASSEMBLY.recorded_setup(), RecordedSetup::default()];
    let bytes = recorded.map(|setup| record(&setup, &readings[..8]).expect("a recording"));
    bytes
        .into_iter()
        .flat_map(|bytes| [unchecked(&bytes), bytes])
        .collect()
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

//! Recording and replay allocate for each chunk of half a second, not for each reading.

use std::path::Path;

use ademan::capture::recording::Replay;
use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::output;
use ademan::recorder::Recorder;
use ademan::session::{CommandReceiver, run_pipeline};
use ademan::setup::{LoadedSetup, Setup};

use super::steady_state::allocations;

/// Readings at the start, in which buffers reach their size: two seconds.
const WARM_UP: usize = 350;

/// The fewest readings between two allocations: a chunk has 87 of a glove.
const READINGS_OF_CHUNK: usize = 80;

/// Records a typing hand, and returns, for each step, whether writing it allocated.
fn record(path: &Path, setup: &LoadedSetup) -> Vec<bool> {
    let recorder = Recorder::create(path, &setup.recorded_setup());
    let mut recorder = recorder.expect("room on the disk");
    let typist = setup.typist(
        &"the quick brown fox ".repeat(4),
        &Hc11Format::default(),
        0.5,
        1,
    );
    let mut nowhere = output::open("none", &setup.required_capabilities()).expect("nowhere");
    let mut allocated = Vec::with_capacity(1 << 16);
    let summary = run_pipeline(
        typist.expect("the hand can type the text"),
        &mut setup.pipeline(),
        &mut *nowhere,
        &CommandReceiver::disconnected(),
        &mut |step| {
            let snapshot = step.to_snapshot();
            let before = allocations();
            recorder.write(&snapshot).expect("room on the disk");
            allocated.push(allocations() != before);
        },
    );
    summary.expect("a run");
    recorder.finish().expect("room on the disk");
    allocated
}

/// Replays a recording, and returns, for each reading, whether reading it allocated.
fn replay(path: &Path) -> Vec<bool> {
    let mut replay = Replay::open(path).expect("the recording");
    let mut allocated = Vec::with_capacity(1 << 16);
    loop {
        let before = allocations();
        match replay.next().expect("a reading") {
            SourceEvent::Reading(_) => allocated.push(allocations() != before),
            SourceEvent::End => return allocated,
            _ => {}
        }
    }
}

fn assert_only_chunks_allocate(allocated: &[bool], what: &str) {
    assert!(allocated.len() > 4 * WARM_UP, "{what}: too few readings");
    let steady = &allocated[WARM_UP..];
    let count = steady
        .iter()
        .filter(|has_allocated| **has_allocated)
        .count();
    let limit = steady.len() / READINGS_OF_CHUNK + 1;
    assert!(
        count <= limit,
        "{what}: {count} of {} readings",
        steady.len()
    );
}

#[test]
fn recording_and_replay_do_not_allocate_for_each_reading() {
    let setup = Setup {
        arm_immediately: true,
        ..Setup::default()
    };
    let setup = setup.load_files().expect("the default setup");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hand.mcap");
    assert_only_chunks_allocate(&record(&path, &setup), "record");
    assert_only_chunks_allocate(&replay(&path), "replay");
}

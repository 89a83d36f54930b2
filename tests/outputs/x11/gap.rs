//! A recording with a gap, replayed in real time.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use ademan::setup::Setup;

use crate::support::press::{Press, readings, x11_code};
use crate::support::program::Program;
use crate::support::recording::{Readings, record_source};
use crate::support::x11::{XServer, wait_for};

/// The gap, during which a key is pressed.
const GAP: Duration = Duration::from_secs(2);

/// Number of attempts: a busy machine may drop the press, or release it before the gap.
const ATTEMPTS: usize = 5;

/// Records a press of H that lasts until after a gap.
fn record(path: &Path) {
    let press = Press::for_text("h");
    let mut postures = vec![press.clear(); 80];
    postures.extend(&press.approach);
    let gap = postures.len();
    postures.extend(&press.lift);
    let mut readings = readings(&postures);
    for reading in &mut readings[gap..] {
        reading.time = reading.time + GAP;
    }
    let setup = Setup::default().load_files().expect("the default setup");
    record_source(path, &setup, Readings::new(readings));
}

#[test]
fn the_transcript_of_a_replay_with_a_gap_agrees_with_the_display() {
    let Some(server) = XServer::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let recording = path("gap.mcap");
    record(Path::new(&recording));
    let replay = |output: &str| {
        let arguments = ["replay", recording.as_str(), "--output", output];
        Program::start(&server, arguments)
    };
    let read = |name: &str| fs::read_to_string(path(name)).expect("a file");
    let mut dry = replay(&format!("transcript:{}", path("dry")));
    assert!(dry.wait_for_exit().success());
    assert_eq!(read("dry").lines().count(), 2, "{}", read("dry"));

    let mut last = Vec::new();
    for attempt in 0..ATTEMPTS {
        let name = format!("typed-{attempt}");
        let mut program = replay(&format!("desktop,transcript:{}", path(&name)));
        let keys = [x11_code("H")];
        let mut has_pressed = false;
        wait_for(|| {
            has_pressed |= server.pressed_keys() == keys;
            has_pressed || !program.is_running()
        });
        if has_pressed {
            let start = Instant::now();
            assert!(server.wait_for_keys(&[]));
            println!("released {:?} after the press", start.elapsed());
        }
        let status = program.wait_for_exit();
        let typed = read(&name);
        if has_pressed && status.success() && typed == read("dry") {
            return;
        }
        last = program.stderr_lines();
        last.push(format!("{status}: {typed}"));
    }
    panic!("{}: {last:#?}", read("dry"));
}

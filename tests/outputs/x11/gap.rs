//! A recording with a gap, replayed in real time.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use ademan::setup::Setup;
use ademan::time::Timestamp;

use crate::support::press::{Posture, Press, glove_format, reading, x11_code};
use crate::support::program::Program;
use crate::support::recording::{Readings, record_source};
use crate::support::x11::XServer;

/// The gap, during which a key is pressed.
const GAP: Duration = Duration::from_secs(2);

/// Records a press of H that lasts until after a gap.
fn record(path: &Path) {
    let press = Press::for_text("h");
    let mut time = Timestamp(0);
    let mut next = |posture: &Posture| {
        time = time + glove_format().packet_period();
        reading(time, posture)
    };
    let mut readings: Vec<_> = (0..80).map(|_| next(&press.clear())).collect();
    readings.extend(press.approach.iter().map(&mut next));
    let gap = readings.len();
    readings.extend(press.lift.iter().map(&mut next));
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
    let outputs = [
        format!("transcript:{}", path("dry")),
        format!("desktop,transcript:{}", path("typed")),
    ];
    for output in &outputs {
        let arguments = ["replay", recording.as_str(), "--output", output];
        let mut program = Program::start(&server, arguments);
        if output.starts_with("desktop") {
            let has_pressed = server.wait_for_keys(&[x11_code("H")]);
            assert!(has_pressed, "{:#?}", program.stderr_lines());
            let start = Instant::now();
            assert!(server.wait_for_keys(&[]));
            println!("released {:?} after the press", start.elapsed());
        }
        assert!(program.wait_for_exit().success());
    }
    let [dry, typed] = ["dry", "typed"].map(|name| fs::read_to_string(path(name)).expect("a file"));
    assert_eq!(typed, dry);
    assert_eq!(dry.lines().count(), 2, "{dry}");
}

//! A recording with a gap that is longer than the stall timeout.

use std::time::Duration;

use ademan::capture::recording::RecordedSetup;
use ademan::recorder::Recorder;
use ademan::setup::Setup;

use super::{assert_same, record_source, replay_by_program};
use crate::ademan;
use crate::support::press::{Press, readings};
use crate::support::recording::Readings;

/// The gap, during which a key is pressed.
const GAP: Duration = Duration::from_millis(1_500);

#[test]
fn a_recording_with_a_gap_gives_the_same_bytes_at_any_speed() {
    let press = Press::for_text("h");
    // The hand is clear of all keys for long enough to arm.
    let mut postures = vec![press.clear(); 80];
    postures.extend(&press.approach);
    let gap = postures.len();
    for _ in 0..2 {
        postures.extend(&press.lift);
        postures.extend([press.clear(); 80]);
        postures.extend(&press.approach);
    }
    let mut readings = readings(&postures);
    for reading in &mut readings[gap..] {
        reading.time = reading.time + GAP;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let setup = Setup::default().load_files().expect("the default setup");
    let source = Box::new(Readings::new(readings));
    let path = record_source(&folder, "gap", &setup, source);
    let first = replay_by_program(&path, None);
    let text = String::from_utf8(first.clone()).expect("UTF-8");
    assert_eq!(text.matches("down H").count(), 3, "{text}");
    for speed in ["20", "3", "1"] {
        let found = replay_by_program(&path, Some(speed));
        assert_same("gap", &format!("speed {speed}"), &found, &first);
    }
}

#[test]
fn a_run_of_a_recording_keeps_the_stall_limit_of_the_setup_whatever_period_the_recording_states() {
    let press = Press::for_text("h");
    let mut postures = vec![press.clear(); 80];
    postures.extend(&press.approach);
    let gap = postures.len();
    postures.extend(&press.lift);
    let mut readings = readings(&postures);
    let last = readings[gap - 1].time;
    for reading in &mut readings[gap..] {
        reading.time = reading.time + GAP;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("period.mcap");
    let setup = RecordedSetup::default().with_packet_period(Some(Duration::from_secs(1)));
    let mut recorder = Recorder::create(&path, &setup).expect("a file");
    for reading in &readings {
        recorder.write_reading(reading).expect("room on the disk");
    }
    recorder.finish().expect("room on the disk");
    let source = format!("recording:{}", path.display());
    let output = ademan([
        "run",
        "--source",
        &source,
        "--output",
        "transcript",
        "--control",
        "off",
    ])
    .output()
    .expect("the program starts");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let time_of = |event: &str| {
        let line = text.lines().find(|line| line.contains(event));
        let milliseconds = line.and_then(|line| line.split_whitespace().next());
        milliseconds
            .and_then(|milliseconds| milliseconds.parse::<f64>().ok())
            .unwrap_or_else(|| panic!("no {event}: {text}"))
    };
    let released_after = time_of("up   H") - last.0 as f64 / 1e3;
    assert!(
        (150.0..=250.0).contains(&released_after),
        "{released_after} ms: {text}"
    );
}

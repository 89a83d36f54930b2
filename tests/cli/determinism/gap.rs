//! A recording with a gap that is longer than the stall timeout.

use std::time::Duration;

use ademan::setup::Setup;
use ademan::time::Timestamp;

use super::{assert_same, record_source, replay_by_program};
use crate::support::press::{Posture, Press, glove_format, reading};
use crate::support::recording::Readings;

/// The gap, during which a key is pressed.
const GAP: Duration = Duration::from_millis(1_500);

#[test]
fn a_recording_with_a_gap_gives_the_same_bytes_at_any_speed() {
    let press = Press::for_text("h");
    let mut time = Timestamp(0);
    let mut next = |posture: &Posture| {
        time = time + glove_format().packet_period();
        reading(time, posture)
    };
    // The hand is clear of all keys for long enough to arm.
    let mut readings: Vec<_> = (0..80).map(|_| next(&press.clear())).collect();
    readings.extend(press.approach.iter().map(&mut next));
    let gap = readings.len();
    for _ in 0..2 {
        readings.extend(press.lift.iter().map(&mut next));
        readings.extend((0..80).map(|_| next(&press.clear())));
        readings.extend(press.approach.iter().map(&mut next));
    }
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

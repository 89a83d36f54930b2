//! Trackers that repeat the last positions, as with a camera that is stuck, and then measure the hand elsewhere.

use std::time::Duration;

use ademan::capture::{Reading, Sample, Source, SourceEvent, SourceUri};
use ademan::device::{EventKind, Events};
use ademan::hand::Side;
use ademan::pipeline::PipelineState;
use ademan::setup::{LoadedSetup, Setup};
use glam::DVec3;

use crate::camera::{Camera, hand, images};
use crate::support::checked::CheckedPipeline;
use crate::support::wearer::load_layout;

/// A key 40 mm below the index fingertip.
const KEY: &str = r#"Layout(name: "key", boards: [(
    pose: (anchor: world, right_mm: 100, forward_mm: 400, height_mm: -40),
    keys: [(code: "A", at_mm: (0, 0), size_mm: Box(30, 30), travel_mm: 10)],
)])"#;

const ABOVE: DVec3 = DVec3::new(0.1, 0.0, -0.4);
const ON_KEY: DVec3 = DVec3::new(0.1, -0.045, -0.4);

fn setup(source: &str) -> Setup {
    Setup {
        source: Some(source.parse().expect("a source")),
        ..Setup::default()
    }
}

/// A hand in front of a camera.
struct SeenHand {
    camera: Camera,
    tip: DVec3,
}

impl SeenHand {
    fn new() -> Self {
        let loaded = load_layout(KEY, setup("stdin:?protocol=openxr"));
        let mut seen = Self {
            camera: Camera::new(&loaded),
            tip: ABOVE,
        };
        seen.show(30);
        assert_eq!(seen.camera.pipeline.state(), PipelineState::Running);
        seen
    }

    /// Sends pictures of the hand where it is.
    fn show(&mut self, pictures: usize) {
        for _ in 0..pictures {
            self.camera.advance();
            let positions = hand(self.tip, 0.0);
            let is_accepted = self.camera.send(Side::Right, Sample::Joints { positions });
            assert!(is_accepted, "{} µs", self.camera.time_us);
        }
    }

    fn go(&mut self, to: DVec3) {
        let from = self.tip;
        for t in images(0.2) {
            self.tip = from.lerp(to, t);
            self.show(1);
        }
    }
}

#[test]
fn a_finger_that_appears_inside_a_key_has_to_leave_it_if_its_positions_were_repeated() {
    for (repeated, keys) in [(5, "A"), (6, "")] {
        let mut seen = SeenHand::new();
        seen.go(ABOVE + DVec3::Y * 0.01);
        seen.show(repeated - 1);
        seen.tip = ON_KEY;
        seen.show(20);
        assert_eq!(seen.camera.keys(), keys, "{repeated} equal pictures");
        seen.go(ABOVE);
        seen.camera.keys();
        seen.go(ON_KEY);
        assert_eq!(seen.camera.keys(), "A");
    }
}

#[test]
fn a_tap_after_a_rest_in_which_nothing_changes_is_typed() {
    let mut seen = SeenHand::new();
    for _ in 0..3 {
        seen.show(30);
        seen.go(ON_KEY);
        seen.go(ABOVE);
        assert_eq!(seen.camera.keys(), "A -A");
    }
}

/// Returns the readings of a hand that types.
fn typing(loaded: &LoadedSetup, text: &str, noise: f64) -> Vec<Reading> {
    let format = loaded.setup.source.as_ref().and_then(SourceUri::format);
    let typist = loaded.encoded_typist(text, format.expect("a protocol"), noise, 5);
    let mut typist = typist.expect("a hand that types");
    let mut readings = Vec::new();
    loop {
        match typist.next().expect("a hand has no errors") {
            SourceEvent::Reading(reading) => readings.push(reading),
            SourceEvent::Idle | SourceEvent::Command(_) => {}
            SourceEvent::End => return readings,
        }
    }
}

/// Returns the keys that readings press.
fn keys(loaded: &LoadedSetup, readings: &[Reading]) -> Vec<String> {
    let mut pipeline = CheckedPipeline::new(loaded);
    let mut keys = Vec::new();
    for reading in readings {
        let mut events = Events::new();
        let _ = pipeline.step(reading, &mut events);
        for event in &events {
            if let EventKind::KeyDown(key) = event.kind {
                keys.push(key.name().to_owned());
            }
        }
    }
    keys
}

/// Returns readings whose sample repeats from an index on, for 200 ms.
fn repeated(readings: &[Reading], start: usize) -> Vec<Reading> {
    let mut stuck = readings.to_vec();
    let end = readings[start].time + Duration::from_millis(200);
    for reading in &mut stuck[start..] {
        if reading.time <= end {
            reading.sample = readings[start].sample.clone();
        }
    }
    stuck
}

#[test]
fn a_hand_that_types_while_its_tracker_repeats_positions_presses_no_other_keys() {
    let loaded = setup("typist:hello?protocol=openxr").load_files();
    let loaded = loaded.expect("a shipped layout");
    let readings = typing(&loaded, "hello", 0.3);
    let typed = keys(&loaded, &readings);
    assert_eq!(typed, ["H", "E", "L", "L", "O"]);
    let mut missed = 0;
    for start in (30..readings.len() - 30).step_by(2) {
        let found = keys(&loaded, &repeated(&readings, start));
        let mut rest = typed.iter();
        let is_part = found.iter().all(|key| rest.any(|it| it == key));
        assert!(is_part, "from reading {start}: {found:?}");
        missed += typed.len() - found.len();
    }
    assert!(missed > 0, "no repetition hides a tap");
}

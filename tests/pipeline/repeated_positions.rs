//! Trackers that repeat the last positions, as with a camera that is stuck, while keys are held, and then measure the hand elsewhere.

use std::time::Duration;

use ademan::capture::{Reading, Sample, Source, SourceEvent, SourceUri};
use ademan::device::{EventKind, Events};
use ademan::hand::{Joint, JointPositions, Side};
use ademan::pipeline::{HandLoss, PipelineState};
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use glam::DVec3;

use crate::camera::{Camera, hand, images};
use crate::support::checked::CheckedPipeline;
use crate::support::wearer::load_layout;
use crate::wearer::{Wearer, boards_of_both_hands};

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

/// The bend of the fingers beside the index finger, in degrees, with which only the index fingertip reaches a board.
const RAISED: f64 = -40.0;

/// The pictures of a camera with 30 pictures per second that repeat a position for at most 5 s.
const REPEATED: usize = 150;

/// A hand in front of a camera.
struct SeenHand {
    camera: Camera,
    tip: DVec3,
    /// The bend of the fingers beside the index finger, in degrees.
    bend: f64,
    /// The position of the thumb tip from the index fingertip, if the thumb is not straight.
    thumb: Option<DVec3>,
}

impl SeenHand {
    fn new() -> Self {
        Self::with_layout(KEY, 0.0)
    }

    fn with_layout(layout: &str, bend: f64) -> Self {
        let loaded = load_layout(layout, setup("stdin:?protocol=openxr"));
        let mut seen = Self {
            camera: Camera::new(&loaded),
            tip: ABOVE,
            bend,
            thumb: None,
        };
        seen.show(30);
        assert_eq!(seen.camera.pipeline.state(), PipelineState::Running);
        seen
    }

    /// Creates a hand over a board at the place of the [`KEY`], with these controls and these fields of the layout.
    fn over(controls: &str, fields: &str, bend: f64) -> Self {
        let layout = format!(
            r#"Layout(name: "board", boards: [(
                pose: (anchor: world, right_mm: 100, forward_mm: 400, height_mm: -40),
                gaps: Dead, travel_mm: 10, size_mm: Box(20, 30), {controls}
            )], {fields})"#
        );
        Self::with_layout(&layout, bend)
    }

    fn positions(&self) -> JointPositions {
        let mut positions = hand(self.tip, self.bend);
        if let Some(thumb) = self.thumb {
            positions.set(Joint::ThumbTip, self.tip + thumb);
        }
        positions
    }

    /// Sends pictures of the hand where it is.
    fn show(&mut self, pictures: usize) {
        for _ in 0..pictures {
            self.camera.advance();
            let positions = self.positions();
            let is_accepted = self.camera.send(Side::Right, Sample::Joints { positions });
            assert!(is_accepted, "{} µs", self.camera.time_us);
        }
    }

    /// Returns the events since the last call, equal ones in a row once.
    fn events(&mut self) -> String {
        let events = std::mem::take(&mut self.camera.events);
        let events = events.iter().map(|event| match event {
            EventKind::KeyDown(key) => key.to_string(),
            EventKind::KeyUp(key) => format!("-{key}"),
            EventKind::MoveBy(..) | EventKind::MoveTo(..) => "move".to_owned(),
            EventKind::Axis(axis, value) => format!("{axis}={value:.1}"),
            EventKind::Value(..) => "value".to_owned(),
            other => panic!("{other:?} comes of no control"),
        });
        let mut events: Vec<_> = events.collect();
        events.dedup();
        events.join(" ")
    }

    fn losses(&self) -> [Option<HandLoss>; Side::COUNT] {
        self.camera.pipeline.hand_losses()
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

#[test]
fn a_key_is_released_after_its_tracker_has_repeated_all_positions_for_5_s() {
    let mut seen = SeenHand::new();
    seen.go(ON_KEY);
    assert_eq!(seen.camera.keys(), "A");
    seen.show(REPEATED);
    assert_eq!(seen.camera.keys(), "");
    assert_eq!(seen.losses(), [None; Side::COUNT]);
    seen.show(1);
    assert_eq!(seen.camera.keys(), "-A");
    assert_eq!(seen.losses(), [None, Some(HandLoss::Stuck)]);
    seen.show(300);
    assert_eq!(seen.camera.keys(), "", "the positions repeat on");
    // The finger is still inside the key, and has to leave it.
    seen.tip = ON_KEY + DVec3::X * 0.005;
    seen.show(20);
    assert_eq!(seen.losses(), [None; Side::COUNT]);
    assert_eq!(seen.camera.keys(), "");
    seen.go(ABOVE);
    seen.go(ON_KEY);
    assert_eq!(seen.camera.keys(), "A");
    assert_eq!(seen.camera.pipeline.state(), PipelineState::Running);
}

#[test]
fn a_key_is_released_after_5_s_at_60_pictures_per_second() {
    let mut seen = SeenHand::new();
    seen.go(ON_KEY);
    assert_eq!(seen.camera.keys(), "A");
    let start = seen.camera.time_us;
    while seen.camera.keys().is_empty() {
        seen.camera.time_us += 16_667;
        let positions = seen.positions();
        assert!(seen.camera.send(Side::Right, Sample::Joints { positions }));
        let repeated = seen.camera.time_us - start;
        assert!(repeated < 5_017_000, "{repeated} µs");
    }
    assert!(seen.camera.time_us - start > 5_000_000);
}

#[test]
fn a_hand_that_trembles_keeps_its_key() {
    let mut seen = SeenHand::new();
    seen.go(ON_KEY);
    for number in 0..2 * REPEATED {
        seen.tip = ON_KEY + DVec3::Z * 1e-6 * (number % 2) as f64;
        seen.show(1);
    }
    assert_eq!(seen.camera.keys(), "A");
}

#[test]
fn a_glove_with_constant_counts_keeps_its_key() {
    let keys = r#"keys: [(code: "A", name: "SIDE", at_mm: (0, 0))]"#;
    let boards = format!(
        r#"Layout(name: "boards", boards: [{}])"#,
        boards_of_both_hands(keys)
    );
    let mut wearer = Wearer::with_layout(
        &boards,
        Setup {
            other_hand: Some(OtherHand::default()),
            ..Setup::default()
        },
    );
    wearer.go(Side::Left, "left", false);
    wearer.go(Side::Right, "right", false);
    wearer.hold_still(400);
    wearer.press(Side::Right, "right");
    assert_eq!(wearer.transcript(), "+A");
    wearer.hold_still(10_000);
    assert_eq!(wearer.transcript(), "");
}

#[test]
fn only_the_keys_of_the_hand_that_is_stuck_are_released() {
    let boards = [("left", -100, "F"), ("right", 100, "J")].map(|(side, right_mm, key)| {
        format!(
            r#"(
                hand: "{side}",
                pose: (anchor: world, right_mm: {right_mm}, forward_mm: 400, height_mm: -40),
                keys: [(code: "{key}", at_mm: (0, 0), size_mm: Box(30, 30), travel_mm: 10)],
            )"#
        )
    });
    let layout = format!(r#"Layout(name: "two", boards: [{}])"#, boards.join(","));
    let both = Setup {
        other_hand: Some(OtherHand::default()),
        ..setup("stdin:?protocol=openxr")
    };
    let mut camera = Camera::new(&load_layout(&layout, both));
    let mut show = |pictures: usize, left_height: f64, noise: f64, right_height: f64| {
        for number in 0..pictures {
            camera.advance();
            let noise = noise * (number % 2) as f64;
            for (side, x, height) in [
                (Side::Left, -0.1, left_height + noise),
                (Side::Right, 0.1, right_height),
            ] {
                let positions = hand(DVec3::new(x, height, -0.4), 0.0);
                camera.send(side, Sample::Joints { positions });
            }
        }
        (camera.keys(), camera.pipeline.hand_losses())
    };
    let (above, on_key) = (ABOVE.y, ON_KEY.y);
    show(30, above, 1e-6, above);
    let heights = images(0.2).map(|t| above + (on_key - above) * t);
    let pressed: Vec<_> = heights.map(|y| show(1, y, 0.0, y).0).collect();
    assert_eq!(pressed.concat(), "F J");
    let mut expect = |pictures, [left, noise, right]: [f64; 3], keys: &str, right_loss| {
        let shown = show(pictures, left, noise, right);
        assert_eq!(shown, (keys.to_owned(), [None, right_loss]));
    };
    let stuck = Some(HandLoss::Stuck);
    expect(REPEATED, [on_key, 1e-6, on_key], "", None);
    expect(1, [on_key, 0.0, on_key], "-J", stuck);
    expect(300, [on_key, 1e-6, on_key], "", stuck);
    expect(20, [above, 1e-6, on_key], "-F", stuck);
    expect(20, [on_key, 1e-6, on_key], "F", stuck);
    // The right hand moves again, and leaves its key before it presses it.
    expect(20, [on_key, 1e-6, above], "", None);
    expect(1, [on_key, 1e-6, above.midpoint(on_key)], "", None);
    expect(20, [on_key, 1e-6, on_key], "J", None);
}

/// A control under the index finger or the index and the middle finger, and what happens while the hand goes down, while it stays
/// there for 5 s, and then.
struct Held {
    controls: &'static str,
    fields: &'static str,
    bend: f64,
    pressed: &'static str,
    held: &'static str,
    released: &'static str,
}

const HELD: [Held; 7] = [
    Held {
        controls: r#"keys: [(code: "ShiftLeft", at_mm: (0, 0)), (code: "J", at_mm: (24, 0))]"#,
        fields: "",
        bend: 0.0,
        pressed: "ShiftLeft J",
        held: "",
        released: "-ShiftLeft -J",
    },
    Held {
        controls: r#"keys: [(code: "ShiftLeft", latch: Lock, at_mm: (0, 0))]"#,
        fields: "",
        bend: RAISED,
        pressed: "ShiftLeft",
        held: "",
        released: "-ShiftLeft",
    },
    Held {
        controls: r#"keys: [(code: "J", at_mm: (0, 0)), (code: "K", at_mm: (24, 0))]"#,
        fields: r#"chords: [(keys: "J K", action: Key("Escape"))]"#,
        bend: 0.0,
        pressed: "Escape",
        held: "",
        released: "-Escape",
    },
    Held {
        controls: r#"keys: [(code: "A", at_mm: (0, 0), dwell_ms: 300)]"#,
        fields: "",
        bend: RAISED,
        pressed: "",
        held: "A -A",
        released: "",
    },
    Held {
        controls: r#"keys: [(code: "A", at_mm: (0, 0), hold: (code: "ControlLeft"))]"#,
        fields: "",
        bend: RAISED,
        pressed: "",
        held: "ControlLeft",
        released: "-ControlLeft",
    },
    Held {
        controls: r#"toggles: [(name: "On", at_mm: (0, 0), hold: Key("W"))]"#,
        fields: "",
        bend: RAISED,
        pressed: "W value",
        held: "",
        released: "-W value",
    },
    Held {
        controls: r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 60)]"#,
        fields: "",
        bend: RAISED,
        pressed: "value",
        held: "",
        released: "",
    },
];

#[test]
fn a_hand_that_is_stuck_releases_all_that_it_holds_and_presses_nothing_until_it_has_left() {
    for case in HELD {
        let mut seen = SeenHand::over(case.controls, case.fields, case.bend);
        seen.go(ON_KEY);
        let mut events = vec![seen.events()];
        seen.show(REPEATED);
        events.push(seen.events());
        seen.show(REPEATED);
        events.push(seen.events());
        let expected = [case.pressed, case.held, case.released];
        assert_eq!(events, expected, "{}", case.controls);
        seen.go(ON_KEY + DVec3::X * 0.005);
        seen.show(REPEATED);
        assert_eq!(seen.events(), "", "{}", case.controls);
    }
}

#[test]
fn a_joystick_that_a_hand_deflects_returns_to_0_when_its_tracker_is_stuck() {
    for (output, held, released) in [
        (r#"axes: ("LeftX", "LeftY")"#, "LeftX=0.5", "LeftX=0.0"),
        ("pointer_px_per_s: 1000", "move", ""),
    ] {
        let controls = format!(
            r#"joysticks: [(name: "Stick", at_mm: (0, 0), diameter_mm: 40, dead_zone: 0, {output})]"#
        );
        let mut seen = SeenHand::over(&controls, "", RAISED);
        seen.go(ON_KEY);
        assert_eq!(seen.events(), "", "{output}");
        seen.tip += DVec3::X * 0.01;
        seen.show(1 + REPEATED);
        assert!(seen.events().ends_with(held), "{output}");
        seen.show(1);
        assert_eq!(seen.events(), released, "{output}");
        seen.show(REPEATED);
        assert_eq!(seen.events(), "", "{output}");
    }
}

#[test]
fn a_pinch_that_drags_is_released_and_moves_nothing_when_its_tracker_is_stuck() {
    let layout = r#"Layout(name: "Point", pointer: Pointer(
        mode: Direct(
            pose: (anchor: world, right_mm: 100, forward_mm: 400),
            size_mm: (300, 300, 300),
        ),
        clicks: [(gesture: Pinch("index"), action: Key("MouseLeft"))],
    ))"#;
    let mut seen = SeenHand::with_layout(layout, 0.0);
    let apart = DVec3::new(-0.024, 0.0, 0.03);
    for t in images(0.2) {
        seen.thumb = Some(apart.lerp(DVec3::X * -0.015, t));
        seen.show(1);
    }
    let pinched = seen.events();
    assert!(pinched.contains("MouseLeft"), "{pinched}");
    seen.show(2 * REPEATED);
    assert_eq!(seen.events(), "-MouseLeft");
    // The hand moves, and the pinch has to open first.
    seen.go(ABOVE + DVec3::X * 0.05);
    assert!(!seen.events().contains("MouseLeft"));
    seen.thumb = None;
    seen.show(10);
    for t in images(0.2) {
        seen.thumb = Some(apart.lerp(DVec3::X * -0.015, t));
        seen.show(1);
    }
    assert!(seen.events().contains("MouseLeft"));
}

#[test]
fn a_finger_that_appears_inside_a_key_near_where_its_tracker_was_stuck_has_to_leave_it() {
    for (repeated, keys) in [(5, "A"), (REPEATED, "A"), (REPEATED + 1, "")] {
        let mut seen = SeenHand::new();
        seen.go(ABOVE + DVec3::NEG_Y * 0.015);
        seen.show(repeated);
        seen.tip = ON_KEY;
        seen.show(20);
        assert_eq!(seen.camera.keys(), keys, "{repeated} equal pictures");
    }
}

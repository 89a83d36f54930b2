//! Tours: scripts that use each control of a layout once.

use std::collections::{BTreeMap, BTreeSet};

use crate::support::checked::CheckedPipeline;
use crate::support::press::glove_format_at;
use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::contact::{Phase, TargetId};
use ademan::device::{EventKind, Events};
use ademan::document::shipped_layouts;
use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::pipeline::PipelineState;
use ademan::setup::{ArmSetup, LoadedSetup, OtherHand, Setup};
use ademan::sim::{self, HandTask, SimulatedTypist, UsTextField};

const MIXER: &str = r#"Layout(name: "My mixer", boards: [(
    pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
    sliders: [(name: "Fader 1", at_mm: (0, 0), length_mm: 60, width_mm: 20)],
    knobs: [(name: "Pan", at_mm: (60, 0), diameter_mm: 40)],
    toggles: [(name: "Mute", at_mm: (-60, 0), size_mm: Box(20, 20))],
)])"#;

fn load(name: &str) -> LoadedSetup {
    let layout = Layout::load(name).unwrap_or_else(|error| panic!("{error}"));
    let setup = Setup {
        layout: name.into(),
        other_hand: layout.uses_hand(Side::Left).then(OtherHand::default),
        allow_system_keys: true,
        ..Setup::default()
    };
    setup.load_files().expect("the layout is valid")
}

#[test]
fn every_shipped_layout_has_a_tour_that_can_be_played() {
    for name in shipped_layouts() {
        let setup = load(name);
        let tour = setup.tour();
        let hand = setup.scripted(&tour, &Hc11Format::default(), 0.0, 0);
        assert!(hand.is_ok(), "{name}: {}\n{tour}", hand.err().unwrap());
        assert!(tour.lines().count() > 1, "{name}: {tour}");
    }
}

#[test]
fn a_tour_touches_each_control_and_moves_it_along_its_travel() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mixer.ron");
    std::fs::write(&path, MIXER).unwrap();
    let setup = load(path.to_str().unwrap());
    let tour = setup.tour();
    let mut hand = setup
        .scripted(&tour, &Hc11Format::default(), 0.0, 0)
        .unwrap_or_else(|error| panic!("{error}\n{tour}"));
    let mut pipeline = CheckedPipeline::new(&setup);
    let names = setup.layout.target_names();
    let mut events = Events::new();
    let mut touched = BTreeMap::new();
    let mut values: BTreeMap<String, (f32, f32)> = BTreeMap::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        events.clear();
        let step = pipeline.step(&reading, &mut events);
        for touch in &step.expect("an accepted reading").touches {
            if touch.phase == Phase::Pressed {
                *touched
                    .entry(names.get(touch.target).to_string())
                    .or_insert(0) += 1;
            }
        }
        for event in &events {
            if let EventKind::Value(target, value) = event.kind {
                let range = values.entry(names.get(target).to_string());
                let range = range.or_insert((value, value));
                *range = (range.0.min(value), range.1.max(value));
            }
        }
    }
    let expected = ["Fader 1", "Mute", "Pan"].map(|name| (name.to_owned(), 1));
    assert_eq!(touched, BTreeMap::from(expected), "{tour}");
    let (low, high) = values["Fader 1"];
    assert!(low < 0.2 && high > 0.8, "{values:?}");
    let (pan_low, pan_high) = values["Pan"];
    assert!(pan_high - pan_low > 0.1, "{values:?}");
}

/// A row of keys of which one is far above the others.
const RAISED: &str = r#"Layout(name: "Raised", boards: [(
    pose: (anchor: elbow, bearing_deg: 32, forward_mm: 324, height_mm: -43),
    keys: [
        (code: "A", at_mm: (-60, 30)),
        (code: "B", at_mm: (-30, 30), lift_mm: 50),
        (code: "C", at_mm: (0, 30)),
        (code: "D", at_mm: (30, 30)),
    ],
)])"#;

#[test]
fn a_tour_leaves_out_a_key_that_can_be_pressed_only_on_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("raised.ron");
    std::fs::write(&path, RAISED).unwrap();
    let setup = load(path.to_str().unwrap());
    let tour = setup.tour();
    let hand = setup.scripted(&tour, &Hc11Format::default(), 0.0, 0);
    assert!(hand.is_ok(), "{}\n{tour}", hand.err().unwrap());
    assert!(
        tour.contains("tap D;") && tour.ends_with("the simulated hand cannot use it: C\n"),
        "{tour}"
    );
}

#[test]
fn the_readings_of_a_live_hand_are_accepted_from_the_first_one() {
    let format = glove_format_at(115_200);
    for name in shipped_layouts() {
        let setup = load(name);
        for task in [
            HandTask::Fitting(HandTask::tour),
            HandTask::text("Hello, World".to_owned()),
        ] {
            let hand = setup.live_hand(task, &format);
            let mut hand = hand.unwrap_or_else(|error| panic!("{error}"));
            let mut pipeline = CheckedPipeline::new(&setup);
            let mut events = Events::new();
            for _ in 0..1500 {
                let Ok(SourceEvent::Reading(reading)) = hand.next() else {
                    panic!("{name}: a live hand has no end");
                };
                events.clear();
                let step = pipeline.step(&reading, &mut events).map(|_| ());
                assert_eq!(step, Ok(()), "{name} at {:?}", reading.time);
            }
        }
    }
}

const SHELF: &str = r#"Layout(name: "Shelf", spaces: [(
    pose: (anchor: elbow),
    targets: [
        (name: "Lamp", at_mm: (120, 0, -300), shape: Ball(50)),
        (name: "Door", at_mm: (200, 30, -270), shape: Box(60, 40, 30)),
    ],
)])"#;

const MOUSE: &str = r#"Layout(name: "Mouse", pointer: Pointer(
    mode: Joint(
        x: (dof: "wrist-deviation", from_deg: -12, to_deg: 20),
        y: (dof: "wrist-flexion", from_deg: 30, to_deg: -30),
    ),
    output: Relative,
    clutch: Flexion("ring-mcp-flexion", 50),
))"#;

/// Returns the events of the tour of a layout.
fn toured(layout: &str, arm: ArmSetup) -> (LoadedSetup, Vec<EventKind>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("own.ron");
    std::fs::write(&path, layout).unwrap();
    let setup = Setup {
        layout: path.to_str().unwrap().into(),
        arm,
        ..Setup::default()
    };
    let setup = setup.load_files().expect("the layout is valid");
    let tour = setup.tour();
    let mut hand = setup
        .scripted(&tour, &Hc11Format::default(), 0.0, 0)
        .unwrap_or_else(|error| panic!("{error}\n{tour}"));
    let mut pipeline = CheckedPipeline::new(&setup);
    let mut events = Events::new();
    let mut kinds = Vec::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        events.clear();
        assert!(pipeline.step(&reading, &mut events).is_ok());
        kinds.extend(events.iter().map(|event| event.kind));
    }
    (setup, kinds)
}

#[test]
fn a_tour_points_at_each_target_in_space_with_any_hand() {
    let small = ArmSetup::Measured {
        hand_length_mm: 160.0,
        forearm_length_mm: 220.0,
    };
    for arm in [ArmSetup::default(), small] {
        let (setup, kinds) = toured(SHELF, arm);
        let names = setup.layout.target_names();
        let selected = kinds.iter().filter_map(|kind| match kind {
            EventKind::Select(target) => Some(names.get(*target).to_string()),
            _ => None,
        });
        assert_eq!(selected.collect::<Vec<_>>(), ["Lamp", "Door"]);
    }
}

#[test]
fn a_tour_of_a_pointer_with_a_clutch_moves_the_cursor() {
    let (_, kinds) = toured(MOUSE, ArmSetup::default());
    let is_motion = |kind: &EventKind| matches!(kind, EventKind::MoveBy(..));
    assert!(kinds.iter().any(is_motion), "{kinds:?}");
}

/// The longest tour of a layout with a pause, in readings of a slow line.
const MAX_READINGS: usize = 40_000;

/// A live hand, and its effects so far.
struct Played {
    hand: SimulatedTypist,
    pipeline: CheckedPipeline,
    /// The number of presses of each target.
    presses: BTreeMap<TargetId, usize>,
    events: usize,
}

impl Played {
    fn new(setup: &LoadedSetup, task: HandTask) -> Self {
        let hand = setup.live_hand(task, &Hc11Format::default());
        let mut pipeline = CheckedPipeline::new(setup);
        pipeline.tolerate_packet_period(Hc11Format::default().packet_period());
        Self {
            hand: hand.unwrap_or_else(|error| panic!("{error}")),
            pipeline,
            presses: BTreeMap::new(),
            events: 0,
        }
    }

    /// Plays one reading, and returns what was emitted.
    fn step(&mut self, events: &mut Events) {
        let Ok(SourceEvent::Reading(reading)) = self.hand.next() else {
            panic!("a live hand has no end");
        };
        events.clear();
        let step = self.pipeline.step(&reading, events);
        for touch in &step.expect("an accepted reading").touches {
            if touch.phase == Phase::Pressed {
                *self.presses.entry(touch.target).or_default() += 1;
            }
        }
        self.events += events.len();
    }
}

/// Returns the targets on the boards that a tour presses and that the hand can use.
fn usable(setup: &LoadedSetup) -> BTreeSet<TargetId> {
    let names = setup.layout.target_names();
    let stops = sim::tour(&setup.layout).into_iter().filter(|stop| {
        let format = Hc11Format::default();
        setup.scripted(&stop.actions, &format, 0.0, 0).is_ok()
    });
    let targets = stops.filter_map(|stop| names.find(&stop.name));
    targets
        .filter(|&target| setup.layout.scene.target(target).is_some())
        .collect()
}

#[test]
fn a_live_tour_uses_every_shipped_layout_again_and_again_and_pauses_none() {
    for name in shipped_layouts() {
        let setup = load(name);
        let expected = usable(&setup);
        let mut played = Played::new(&setup, HandTask::Fitting(HandTask::tour));
        let mut events = Events::new();
        let has_repeated = |hand: &Played| {
            let mut counts = expected.iter().map(|target| hand.presses.get(target));
            let is_pressed = |count: &Option<&usize>| count.is_some();
            let first = expected.first().and_then(|it| hand.presses.get(it));
            counts.all(|count| is_pressed(&count)) && first.is_none_or(|&count| count > 1)
        };
        let mut readings = 0;
        while readings < MAX_READINGS && (readings < 1000 || !has_repeated(&played)) {
            played.step(&mut events);
            assert_eq!(played.pipeline.paused_by(), None, "{name}");
            readings += 1;
        }
        let names = setup.layout.target_names();
        let missed = expected
            .iter()
            .filter(|it| !played.presses.contains_key(it));
        let missed: Vec<String> = missed.map(|it| names.get(*it).to_string()).collect();
        assert!(has_repeated(&played), "{name}: not pressed: {missed:?}");
        assert!(expected.is_empty() || played.events > 0, "{name}");
        assert_eq!(played.pipeline.state(), PipelineState::Running, "{name}");
    }
}

/// A layout whose controls pause the session, except the key A and the toggle Mute.
const PAUSING: &str = r#"Layout(name: "Pausing", boards: [(
    pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
    pitch_mm: 24, size_mm: Box(22, 20),
    keys: [
        (code: "A", at_mm: (-24, 0)),
        (action: Command("toggle-pause"), name: "key", at_mm: (0, 0)),
    ],
    toggles: [
        (name: "Mute", at_mm: (-24, 30)),
        (name: "toggle", at_mm: (0, 30), tap: Command("toggle-pause")),
    ],
    radios: [(name: "group", initial: "one", options: [
        (name: "one", at_mm: (24, 30)),
        (name: "two", at_mm: (48, 30), tap: Command("resume")),
    ])],
)])"#;

#[test]
fn what_pauses_or_resumes_the_session_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pausing.ron");
    std::fs::write(&path, PAUSING).unwrap();
    let setup = load(path.to_str().unwrap());
    let names: Vec<String> = sim::tour(&setup.layout)
        .into_iter()
        .map(|stop| stop.name)
        .collect();
    assert_eq!(names, ["A", "Mute"]);
    let script = "tap A; tap key; tap toggle; tap two; tap Mute";
    let task = HandTask::script(script, &setup.layout).expect("a script for the layout");
    let mut played = Played::new(&setup, task);
    let mut events = Events::new();
    for _ in 0..800 {
        played.step(&mut events);
    }
    let target_names = setup.layout.target_names();
    let pressed = played
        .presses
        .keys()
        .map(|it| target_names.get(*it).to_string());
    assert_eq!(pressed.collect::<Vec<_>>(), ["A", "Mute"]);
    assert!(played.presses.values().all(|&count| count > 1));
    assert!(HandTask::script("tap key", &setup.layout).is_none());
    assert!(HandTask::script("tap Q", &setup.layout).is_none());
}

#[test]
fn a_live_hand_uses_the_keys_of_the_text_decoder() {
    let setup = load("phone-words");
    let stops = sim::tour(&setup.layout);
    let keys = [
        "candidate-1",
        "candidate-2",
        "candidate-3",
        "words",
        "letters",
    ];
    for key in keys {
        assert!(stops.iter().any(|stop| stop.name == key), "{key}");
    }
    let script = include_str!("../../examples/scripts/phone-words.txt");
    let task = HandTask::script(script, &setup.layout).expect("a script for the layout");
    let mut played = Played::new(&setup, task);
    let (mut events, mut field) = (Events::new(), UsTextField::new());
    for _ in 0..MAX_READINGS {
        if field.text().ends_with("na ") {
            break;
        }
        played.step(&mut events);
        events.iter().for_each(|event| field.handle(event));
    }
    assert_eq!(field.text(), "hello world gone na ");
}

#[test]
fn a_hand_becomes_another_person_again_and_again_and_types_without_an_error() {
    let mut setup = load("qwerty-flat");
    let text = "hola";
    let mut played = Played::new(&setup, HandTask::text(text.to_owned()));
    let mut events = Events::new();
    let mut field = UsTextField::new();
    for reading in 0..3000 {
        // At every phase of a press.
        if reading % 17 == 0 {
            setup.simulated_person.motion.speed = 0.5 + f64::from(reading / 17 % 5);
            let changed = setup.change_live_hand(&mut played.hand, 0.0);
            changed.expect("the same hands");
        }
        played.step(&mut events);
        events.iter().for_each(|event| field.handle(event));
    }
    let typed = field.text();
    let whole = text.repeat(typed.len() / text.len() + 1);
    assert!(typed.len() > 3 * text.len(), "{typed:?}");
    assert!(whole.starts_with(typed), "{typed:?}");
}

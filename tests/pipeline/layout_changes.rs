//! A simulated hand while the layout changes under it, at every moment of its task, through the whole pipeline.

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use crate::support::checked::CheckedPipeline;
use ademan::capture::{Hc11Format, Reading, Source, SourceEvent};
use ademan::device::{EventKind, Events};
use ademan::layout::Layout;
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::{LayoutChange, SimulatedTypist, UsTextField};

/// The longest wait for another thread: 60 s of pauses of 0.1 ms.
const MAX_PAUSES: u32 = 600_000;

/// Changes of the layout: each moves the board by 15 to 42 mm.
const CHANGES: [(&str, &str); 4] = [
    ("bearing_deg: 35", "bearing_deg: 43"),
    ("bearing_deg: 35", "bearing_deg: 27"),
    ("height_mm: -45", "height_mm: -5"),
    ("height_mm: -45", "height_mm: -60"),
];

fn load() -> LoadedSetup {
    Setup::default().load_files().expect("the default setup")
}

fn changed(layout: &Layout, (from, to): (&str, &str)) -> Layout {
    let text = layout.text.replace(from, to);
    assert_ne!(text, layout.text);
    layout.with_text(&text).expect("a valid layout")
}

/// A hand, its pipeline, and the text field that it types into.
struct Rig<'a> {
    setup: &'a LoadedSetup,
    hand: SimulatedTypist,
    pipeline: CheckedPipeline,
    field: UsTextField,
    presses: usize,
    events: Events,
}

impl<'a> Rig<'a> {
    fn new(setup: &'a LoadedSetup, hand: SimulatedTypist) -> Self {
        Self {
            pipeline: CheckedPipeline::new(setup),
            setup,
            hand,
            field: UsTextField::new(),
            presses: 0,
            events: Events::new(),
        }
    }

    /// Plays one reading. Returns `false` at the end.
    fn play(&mut self) -> bool {
        let Ok(SourceEvent::Reading(reading)) = self.hand.next() else {
            return false;
        };
        self.step(&reading);
        true
    }

    fn step(&mut self, reading: &Reading) {
        self.events.clear();
        let stepped = self.pipeline.step(reading, &mut self.events);
        stepped.unwrap_or_else(|reason| panic!("{reason} at {:?}", reading.time));
        self.take_events();
    }

    fn take_events(&mut self) {
        for event in &self.events {
            self.field.handle(event);
            self.presses += usize::from(matches!(event.kind, EventKind::KeyDown(_)));
        }
    }

    /// Announces a change as the layout manager does, and plays until the hand has lifted.
    fn announce(&mut self) -> LayoutChange {
        let feed = self.setup.layout_feed.clone();
        let announcing = feed.clone();
        let announcement = thread::spawn(move || announcing.begin_change());
        let mut pauses = 0;
        while !feed.is_changing() {
            pauses += 1;
            assert!(pauses < MAX_PAUSES, "the change is not announced");
            thread::sleep(Duration::from_micros(100));
        }
        while !announcement.is_finished() && self.play() {}
        announcement.join().expect("the announcement ends")
    }

    fn activate(&mut self, change: LayoutChange, layout: Layout) {
        let mut instance = self
            .setup
            .layout_instance(&layout)
            .expect("a usable layout");
        self.events.clear();
        self.pipeline
            .replace_profile(0, &mut instance, &layout, &mut self.events);
        self.take_events();
        change.activate(Arc::new(layout));
    }
}

/// Types a text and changes the layout after a number of readings.
fn type_across(text: &str, change: (&str, &str), readings: usize) -> (String, usize) {
    let setup = load();
    let hand = setup.typist(text, &Hc11Format::default(), 0.0, 0).unwrap();
    let mut rig = Rig::new(&setup, hand);
    for _ in 0..readings {
        rig.play();
    }
    let announced = rig.announce();
    rig.activate(announced, changed(&setup.layout, change));
    while rig.play() {}
    assert!(rig.field.pressed().is_empty());
    (rig.field.text().to_owned(), rig.presses)
}

#[test]
fn a_text_is_right_whenever_the_board_moves() {
    let text = "jH2";
    let setup = load();
    let hand = setup.typist(text, &Hc11Format::default(), 0.0, 0).unwrap();
    let count = hand.count_packets() as usize;
    drop(hand);
    for readings in (0..count).step_by(2) {
        let change = CHANGES[readings / 2 % CHANGES.len()];
        let (typed, presses) = type_across(text, change, readings);
        assert_eq!(typed, text, "{change:?} after {readings} readings");
        // One more for Shift, and another one if it was tapped again.
        assert!(
            (4..=5).contains(&presses),
            "{presses} presses after {readings} readings"
        );
    }
}

#[test]
fn a_character_that_the_new_layout_lacks_is_left_out() {
    let setup = load();
    let hand = setup.typist("jkl", &Hc11Format::default(), 0.0, 0).unwrap();
    let mut rig = Rig::new(&setup, hand);
    let announced = rig.announce();
    rig.activate(announced, changed(&setup.layout, ("H J K L", "H J L")));
    while rig.play() {}
    assert_eq!(rig.field.text(), "jl");
}

#[test]
fn a_key_that_is_held_when_the_board_moves_is_released_and_the_script_goes_on() {
    let setup = load();
    let script = "press H; wait 20000; lift; tap J";
    let hand = setup
        .scripted(script, &Hc11Format::default(), 0.0, 0)
        .unwrap();
    let mut rig = Rig::new(&setup, hand);
    while rig.presses == 0 {
        assert!(rig.play());
    }
    for _ in 0..40 {
        rig.play();
    }
    // The hand does not lift, so that the change comes unexpectedly.
    let announced = setup.layout_feed.begin_change();
    rig.activate(announced, changed(&setup.layout, CHANGES[0]));
    assert!(rig.field.pressed().is_empty());
    while rig.play() {}
    assert_eq!(rig.field.text(), "hj");
    assert_eq!(rig.presses, 2);
}

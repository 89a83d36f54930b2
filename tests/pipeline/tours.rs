//! Tours: scripts that use each control of a layout once.

use std::collections::BTreeMap;
use std::num::NonZeroU32;

use crate::support::checked::CheckedPipeline;
use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::contact::Phase;
use ademan::device::{EventKind, Events};
use ademan::document::shipped_layouts;
use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use ademan::sim::HandTask;

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
        other_hand: layout.has_board_for(Side::Left).then(OtherHand::default),
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
    let (low, high) = values["Pan"];
    assert!(high - low > 0.1, "{values:?}");
}

#[test]
fn the_readings_of_a_live_hand_are_accepted_from_the_first_one() {
    let format = Hc11Format {
        baud: NonZeroU32::new(115_200).unwrap(),
        ..Hc11Format::default()
    };
    for name in shipped_layouts() {
        let setup = load(name);
        for task in [
            HandTask::Fitting(HandTask::tour),
            HandTask::Text("Hello, World".to_owned()),
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

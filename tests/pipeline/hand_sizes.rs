//! Hands of all sizes on all shipped layouts: the simulated hand types or plays the script of the demo through the whole
//! pipeline.

use std::collections::BTreeSet;
use std::path::Path;

use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::device::{EventKind, Events, OutputEvent};
use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::setup::{ArmSetup, LoadedSetup, OtherHand, Setup};
use ademan::sim::{SimulatedTypist, UsTextField, taps_for_text};

use crate::support::press::glove_format_at;

/// Hand and forearm lengths in mm at the 5th, 25th, 50th, 75th and 95th percentile.
///
/// The ends are the 5th percentile of women (166 ± 8 mm) and the 95th of men (183 ± 10 mm) of Buryanov & Kotiuk 2010, with a
/// normal distribution between them; the forearm is 0.146/0.108 of the hand (Drillis & Contini 1966).
const PERCENTILES: [(f64, f64); 5] = [
    (153.0, 207.0),
    (167.0, 226.0),
    (176.0, 238.0),
    (186.0, 251.0),
    (199.0, 269.0),
];

/// The measured hand in the README.
const README_HAND: (f64, f64) = (189.0, 262.0);

/// A line with 58 packets per second: a third of the work of the fastest one.
fn line() -> Hc11Format {
    glove_format_at(38_400)
}

fn measured((hand_length_mm, forearm_length_mm): (f64, f64)) -> ArmSetup {
    ArmSetup::Measured {
        hand_length_mm,
        forearm_length_mm,
    }
}

fn load(layout: &str, arm: ArmSetup) -> LoadedSetup {
    let needs_left = Layout::load(layout).unwrap().uses_hand(Side::Left);
    let other_hand = needs_left.then(|| OtherHand {
        arm: arm.clone(),
        ..OtherHand::default()
    });
    let setup = Setup {
        arm,
        layout: layout.into(),
        other_hand,
        ..Setup::default()
    };
    setup.load_files().unwrap()
}

fn play(setup: &LoadedSetup, mut hand: SimulatedTypist) -> Vec<OutputEvent> {
    let mut pipeline = setup.pipeline();
    let (mut events, mut all) = (Events::new(), Vec::new());
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        events.clear();
        let output = pipeline.step(&reading, &mut events);
        output.unwrap_or_else(|reason| panic!("{reason} at {:?}", reading.time));
        all.extend(events.iter().copied());
    }
    all
}

fn typed(events: &[OutputEvent]) -> String {
    let mut field = UsTextField::new();
    events.iter().for_each(|event| field.handle(event));
    field.text().to_owned()
}

/// Returns the presses, releases and selections in order, each series of equal ones once, and the kinds of all other
/// events. A path of the same length on a larger control has fewer steps.
fn outline(events: &[OutputEvent]) -> (Vec<EventKind>, BTreeSet<String>) {
    let is_step = |kind: &EventKind| {
        matches!(
            kind,
            EventKind::KeyDown(_)
                | EventKind::KeyUp(_)
                | EventKind::Character(_)
                | EventKind::Select(_)
                | EventKind::Unselect(_)
        )
    };
    let kinds = events.iter().map(|event| event.kind);
    let (steps, others): (Vec<_>, Vec<_>) = kinds.partition(is_step);
    let mut series: Vec<EventKind> = Vec::new();
    for step in steps {
        if !series.contains(&step) {
            series.push(step);
        }
    }
    let name = |kind: EventKind| {
        let text = format!("{kind:?}");
        let end = text.find('(').unwrap_or(text.len());
        text[..end].to_owned()
    };
    (series, others.into_iter().map(name).collect())
}

/// Plays the demo of a layout and returns what came of it: the typed text, or the outline of the events.
fn demonstrate(name: &str, setup: &LoadedSetup) -> String {
    let line = line();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/scripts/{name}.txt"));
    if script.is_file() {
        let hand = setup.scripted(script.to_str().unwrap(), &line, 0.0, 0);
        let events = play(
            setup,
            hand.unwrap_or_else(|error| panic!("{name}: {error}")),
        );
        return format!("{:?}", outline(&events));
    }
    let mut texts = ["Hola 1p?", "3.14*2", "Hasta"].into_iter();
    let text = texts.find(|text| taps_for_text(text, &setup.layout, false).is_ok());
    let text = text.expect("a layout without a script types one of the texts");
    let hand = setup.typist(text, &line, 0.0, 0).unwrap();
    let typed = typed(&play(setup, hand));
    assert_eq!(typed, text, "{name}");
    typed
}

/// Demonstrates every shipped layout with a hand, and compares it with the design hand.
fn check_hand(size: (f64, f64)) {
    let mut failures = Vec::new();
    for (name, _) in Layout::shipped().unwrap() {
        let setup = load(name, measured(size));
        let out_of_reach = setup.out_of_reach();
        if !out_of_reach.is_empty() {
            failures.push(format!("{name}: out of reach: {out_of_reach:?}"));
            continue;
        }
        let (found, expected) = (
            demonstrate(name, &setup),
            demonstrate(name, &load(name, ArmSetup::default())),
        );
        if found != expected {
            failures.push(format!("{name}: {found}\n{expected}"));
        }
    }
    assert!(failures.is_empty(), "{size:?}\n{}", failures.join("\n"));
}

#[test]
fn a_hand_of_the_5th_percentile_uses_every_shipped_layout() {
    check_hand(PERCENTILES[0]);
}

#[test]
fn a_hand_of_the_25th_percentile_uses_every_shipped_layout() {
    check_hand(PERCENTILES[1]);
}

#[test]
fn a_hand_of_the_50th_percentile_uses_every_shipped_layout() {
    check_hand(PERCENTILES[2]);
}

#[test]
fn a_hand_of_the_75th_percentile_uses_every_shipped_layout() {
    check_hand(PERCENTILES[3]);
}

#[test]
fn a_hand_of_the_95th_percentile_uses_every_shipped_layout() {
    check_hand(PERCENTILES[4]);
}

#[test]
fn the_measured_hand_of_the_readme_types_the_text_of_the_demo_on_the_default_layout() {
    let text = "Hola! Typed by a hand, 1 tap each.";
    let setup = load("qwerty-flat", measured(README_HAND));
    assert!(
        setup.out_of_reach().is_empty(),
        "{:?}",
        setup.out_of_reach()
    );
    let hand = setup.typist(text, &line(), 0.0, 0).unwrap();
    assert_eq!(typed(&play(&setup, hand)), text);
}

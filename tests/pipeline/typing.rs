//! The simulated hand types on every keyboard, through the pipeline, in no time at all.

use std::num::NonZeroU32;

use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::contact::{Phase, TargetId};
use ademan::device::Events;
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::setup::{ArmSetup, LoadedSetup, OtherHand, Setup, SmoothingSetup};
use ademan::sim::{HandAction, SimulatedTypist, TypistSettings, UsTextField};

const ALL_OF_ASCII: &str = "The quick brown fox, jumps over\nthe lazy dog! 0123456789\n\
    @#$%^&*()-_=+[]{}\\|;:'\"/?.,<>`~\tend";

fn line(baud: u32) -> Hc11Format {
    Hc11Format {
        baud: NonZeroU32::new(baud).expect("a baud"),
        ..Hc11Format::default()
    }
}

fn assembly(layout: &str) -> LoadedSetup {
    with(layout, SmoothingSetup::Default)
}

fn with(layout: &str, smoothing: SmoothingSetup) -> LoadedSetup {
    let setup = Setup {
        layout: layout.into(),
        smoothing,
        ..Setup::default()
    };
    setup.load_files().expect("a shipped layout")
}

fn assembly_for_two_hands(layout: &str) -> LoadedSetup {
    let setup = Setup {
        layout: layout.into(),
        other_hand: Some(OtherHand::default()),
        ..Setup::default()
    };
    setup.load_files().expect("a shipped layout")
}

/// What comes out when the hand plays, and the keys it pressed in order.
fn play(assembly: &LoadedSetup, mut hand: SimulatedTypist) -> (String, Vec<TargetId>) {
    let mut pipeline = assembly.pipeline();
    let mut field = UsTextField::new();
    let mut pressed = Vec::new();
    let mut events = Events::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        events.clear();
        let frame = pipeline.step(&reading, &mut events);
        let frame = frame.unwrap_or_else(|reason| panic!("{reason} at {:?}", reading.time));
        events.iter().for_each(|event| field.handle(event));
        let new = frame
            .touches
            .iter()
            .filter(|touch| touch.phase == Phase::Pressed);
        pressed.extend(new.map(|touch| touch.target));
    }
    events.clear();
    pipeline.stop(&mut events);
    assert!(events.is_empty(), "nothing is down at the end: {events:?}");
    assert!(field.pressed().is_empty());
    (field.text().to_owned(), pressed)
}

fn type_text(assembly: &LoadedSetup, text: &str, baud: u32, noise_counts: f64) -> String {
    let hand = assembly.typist(text, &line(baud), noise_counts, 11);
    play(
        assembly,
        hand.unwrap_or_else(|error| panic!("{text:?}: {error}")),
    )
    .0
}

#[test]
fn every_character_of_ascii_comes_out_on_the_flat_boards_at_both_speeds_of_the_line() {
    for layout in [
        "qwerty-flat",
        "qwerty-flat-22",
        "dvorak-flat",
        "colemak-flat",
    ] {
        let assembly = assembly(layout);
        for baud in [9_600, 115_200] {
            let typed = type_text(&assembly, ALL_OF_ASCII, baud, 0.0);
            assert_eq!(typed, ALL_OF_ASCII, "{layout} at {baud} baud");
        }
    }
}

#[test]
fn every_character_of_ascii_comes_out_on_the_arcs_with_their_layer() {
    let assembly = assembly("qwerty-arc");
    for baud in [9_600, 115_200] {
        assert_eq!(
            type_text(&assembly, ALL_OF_ASCII, baud, 0.0),
            ALL_OF_ASCII,
            "{baud} baud"
        );
    }
}

#[test]
fn two_hands_type_every_character_of_ascii_on_their_halves() {
    for layout in ["qwerty-two-flat", "qwerty-two-arc"] {
        let assembly = assembly_for_two_hands(layout);
        let typed = type_text(&assembly, ALL_OF_ASCII, 115_200, 0.0);
        assert_eq!(typed, ALL_OF_ASCII, "{layout}");
    }
}

#[test]
fn every_key_of_every_shipped_keyboard_can_be_tapped_and_no_other_key_is_hit() {
    let shipped = Layout::shipped().expect("shipped layouts are right");
    // The simulated hand has one finger, and keys of chords have one each.
    let for_one_finger = shipped
        .into_iter()
        .filter(|(_, layout)| layout.chords.is_empty());
    for (name, layout) in for_one_finger {
        let assembly = match layout.has_board_for(Side::Left) {
            true => assembly_for_two_hands(name),
            false => assembly(name),
        };
        // There and back, so that every key is reached from more than one side.
        let keys = layout.keys.iter().map(|key| key.face.target);
        let wanted: Vec<TargetId> = keys.clone().chain(keys.rev()).collect();
        let taps: Vec<HandAction> = wanted.iter().copied().map(HandAction::tap).collect();
        let settings = TypistSettings {
            name: name.into(),
            packet_period: line(115_200).packet_period(),
            noise_counts: 0.0,
            seed: 0,
        };
        let mut hands = vec![(&assembly.arm, &assembly.glove.map)];
        hands.extend(
            assembly
                .other_hand
                .iter()
                .map(|other| (&other.arm, &other.glove.map)),
        );
        let hand = SimulatedTypist::with_hands(&settings, &taps, &layout.scene, &hands);
        let (_, pressed) = play(
            &assembly,
            hand.unwrap_or_else(|error| panic!("{name}: {error}")),
        );
        assert_eq!(pressed, wanted, "{name}");
    }
}

#[test]
fn the_filters_of_the_thesis_and_none_at_all_do_as_well() {
    let text = "Filters of the thesis.";
    // At 14.5 frames a second its filters take half a second to follow a stroke.
    let cases = [
        (SmoothingSetup::Thesis, 115_200),
        (SmoothingSetup::Off, 115_200),
        (SmoothingSetup::Off, 9_600),
    ];
    for (smoothing, baud) in cases {
        let assembly = with("qwerty-flat", smoothing);
        assert_eq!(
            type_text(&assembly, text, baud, 0.0),
            text,
            "{smoothing:?} at {baud} baud"
        );
    }
}

#[test]
fn a_count_of_noise_on_every_channel_does_not_change_the_text() {
    let text = "Noise of one count: still right.";
    let assembly = assembly("qwerty-flat-22");
    assert_eq!(type_text(&assembly, text, 115_200, 1.0), text);
}

#[test]
fn a_hand_with_other_measures_types_as_well() {
    let setup = Setup {
        arm: ArmSetup::Measured {
            hand_length_mm: 175.0,
            forearm_length_mm: 225.0,
        },
        layout: "qwerty-flat".into(),
        ..Setup::default()
    };
    let assembly = setup.load_files().expect("a person of these measures");
    let text = "Other measures.";
    assert_eq!(type_text(&assembly, text, 115_200, 0.0), text);
}

#[test]
fn what_cannot_be_typed_is_said_before_the_hand_moves() {
    let assembly = assembly("arrows");
    let error = assembly
        .typist("q", &line(9_600), 0.0, 0)
        .err()
        .expect("no letters there");
    assert!(error.to_string().contains("no key Q"), "{error}");
}

#[test]
fn a_key_out_of_reach_is_named_with_how_far_it_is() {
    let shipped = Layout::load("qwerty-flat").expect("a shipped layout");
    let far = shipped.text.replace("forward_mm: 300", "forward_mm: 350");
    assert_ne!(far, shipped.text);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("far.ron");
    std::fs::write(&path, far).expect("a file");
    let assembly = assembly(path.to_str().expect("a path in UTF-8"));
    let error = assembly
        .typist("h1", &line(9_600), 0.0, 0)
        .err()
        .expect("too far")
        .to_string();
    assert!(
        error.contains("key `1` is") && error.contains("mm out of reach"),
        "{error}"
    );
    let names: Vec<&str> = assembly
        .out_of_reach()
        .iter()
        .map(|(name, _)| *name)
        .collect();
    assert!(
        names.contains(&"1") && !names.contains(&"Space"),
        "{names:?}"
    );
}

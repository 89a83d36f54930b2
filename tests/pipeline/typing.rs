//! Typing on all shipped keyboards: the simulated hand through the whole pipeline.

use ademan::capture::{Source, SourceEvent};
use ademan::contact::{Phase, TargetId};
use ademan::device::Events;
use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::{Glove, Layout, Person};
use ademan::setup::{ArmSetup, LoadedSetup, OtherHand, Setup, SmoothingSetup};
use ademan::sim::{
    HandAction, JointSensor, Sensor, SimulatedTypist, TypingKeys, TypistSettings, UsTextField,
};

use crate::support::press::glove_format_at;

const ALL_OF_ASCII: &str = "The quick brown fox, jumps over\nthe lazy dog! 0123456789\n\
    @#$%^&*()-_=+[]{}\\|;:'\"/?.,<>`~\tend";

fn load(layout: &str) -> LoadedSetup {
    load_with(layout, SmoothingSetup::Default)
}

fn load_with(layout: &str, smoothing: SmoothingSetup) -> LoadedSetup {
    let setup = Setup {
        layout: layout.into(),
        smoothing,
        ..Setup::default()
    };
    setup.load_files().expect("the layout is shipped")
}

fn load_for_two_hands(layout: &str) -> LoadedSetup {
    let setup = Setup {
        layout: layout.into(),
        other_hand: Some(OtherHand::default()),
        ..Setup::default()
    };
    setup.load_files().expect("the layout is shipped")
}

/// Returns the text that the hand types, and the keys that it presses in order.
fn play(setup: &LoadedSetup, mut hand: SimulatedTypist) -> (String, Vec<TargetId>) {
    let mut pipeline = setup.pipeline();
    let mut field = UsTextField::new();
    let mut pressed = Vec::new();
    let mut events = Events::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        events.clear();
        let output = pipeline.step(&reading, &mut events);
        let output = output.unwrap_or_else(|reason| panic!("{reason} at {:?}", reading.time));
        events.iter().for_each(|event| field.handle(event));
        let new = output
            .touches
            .iter()
            .filter(|touch| touch.phase == Phase::Pressed);
        pressed.extend(new.map(|touch| touch.target));
    }
    events.clear();
    pipeline.stop(&mut events);
    assert!(events.is_empty(), "keys are pressed at the end: {events:?}");
    assert!(field.pressed().is_empty());
    (field.text().to_owned(), pressed)
}

fn type_text(setup: &LoadedSetup, text: &str, baud: u32, noise: f64) -> String {
    let hand = setup.typist(text, &glove_format_at(baud), noise, 11);
    play(
        setup,
        hand.unwrap_or_else(|error| panic!("{text:?}: {error}")),
    )
    .0
}

#[test]
fn flat_boards_type_all_of_ascii_at_both_baud_rates() {
    for layout in [
        "qwerty-flat",
        "qwerty-flat-22",
        "dvorak-flat",
        "colemak-flat",
    ] {
        let setup = load(layout);
        for baud in [9_600, 115_200] {
            let typed = type_text(&setup, ALL_OF_ASCII, baud, 0.0);
            assert_eq!(typed, ALL_OF_ASCII, "{layout} at {baud} baud");
        }
    }
}

#[test]
fn arc_boards_type_all_of_ascii_with_their_layer() {
    let setup = load("qwerty-arc");
    for baud in [9_600, 115_200] {
        assert_eq!(
            type_text(&setup, ALL_OF_ASCII, baud, 0.0),
            ALL_OF_ASCII,
            "{baud} baud"
        );
    }
}

#[test]
fn bending_fingers_type_all_of_ascii_in_chords() {
    let setup = load("chords-bend");
    for baud in [9_600, 115_200] {
        let typed = type_text(&setup, ALL_OF_ASCII, baud, 0.0);
        assert_eq!(typed, ALL_OF_ASCII, "{baud} baud");
    }
}

#[test]
fn a_phone_pad_types_letters_by_taps_in_a_row() {
    let setup = load("phone-pad");
    let text = "Hello, moon; a cab\n0123456789;=[]\\`'-./";
    // Taps at 9600 baud take longer than the time-out.
    assert_eq!(type_text(&setup, text, 115_200, 0.0), text);
}

#[test]
fn a_key_that_dwelling_activates_is_typed_by_a_rest() {
    let setup = load("switches");
    assert_eq!(type_text(&setup, "afza", 115_200, 0.0), "afza");
}

#[test]
fn two_hands_type_all_of_ascii_on_split_boards() {
    for layout in ["qwerty-two-flat", "qwerty-two-arc"] {
        let setup = load_for_two_hands(layout);
        let typed = type_text(&setup, ALL_OF_ASCII, 115_200, 0.0);
        assert_eq!(typed, ALL_OF_ASCII, "{layout}");
    }
}

#[test]
fn a_tap_presses_only_its_key_on_every_shipped_keyboard() {
    let shipped = Layout::shipped().expect("shipped layouts are valid");
    // The simulated hand taps with one finger; chords need several.
    let for_one_finger = shipped
        .into_iter()
        .filter(|(_, layout)| layout.chords.is_empty());
    for (name, layout) in for_one_finger {
        let setup = if layout.uses_hand(Side::Left) {
            load_for_two_hands(name)
        } else {
            load(name)
        };
        // Forwards and backwards, so that each key is reached from two sides.
        let keys = layout.keys.iter().map(|key| key.face.target);
        let wanted: Vec<TargetId> = keys.clone().chain(keys.rev()).collect();
        let taps: Vec<HandAction> = wanted.iter().copied().map(HandAction::tap).collect();
        let settings = TypistSettings {
            name: name.into(),
            packet_period: glove_format_at(115_200).packet_period(),
            noise: 0.0,
            seed: 0,
            person: Person::default(),
            keys: TypingKeys::default(),
        };
        let is_seen = layout.follows_other_hand();
        let sensor = |glove| {
            if is_seen {
                // Gloves do not know where the other hand is.
                Sensor::Joints(JointSensor::Positions)
            } else {
                sensor(glove)
            }
        };
        let mut hands = vec![(&setup.arm, sensor(&setup.glove))];
        let other = setup.other_hand.iter();
        hands.extend(other.map(|other| (&other.arm, sensor(&other.glove))));
        let hand = SimulatedTypist::with_hands(&settings, &taps, &layout.scene, &hands);
        let (_, pressed) = play(
            &setup,
            hand.unwrap_or_else(|error| panic!("{name}: {error}")),
        );
        assert_eq!(pressed, wanted, "{name}");
    }
}

fn sensor(glove: &Option<Glove>) -> Sensor<'_> {
    Sensor::Glove(&glove.as_ref().expect("a glove").map)
}

#[test]
fn typing_works_with_recursive_averages_and_without_smoothing() {
    let text = "Recursive averages.";
    // At 14.5 packets per second, recursive averages follow a tap only after half a second.
    let cases = [
        (SmoothingSetup::RecursiveAverage, 115_200),
        (SmoothingSetup::Off, 115_200),
        (SmoothingSetup::Off, 9_600),
    ];
    for (smoothing, baud) in cases {
        let setup = load_with("qwerty-flat", smoothing);
        assert_eq!(
            type_text(&setup, text, baud, 0.0),
            text,
            "{smoothing:?} at {baud} baud"
        );
    }
}

#[test]
fn one_count_of_noise_does_not_change_the_text() {
    let text = "Noise of one count: still right.";
    let setup = load("qwerty-flat-22");
    assert_eq!(type_text(&setup, text, 115_200, 1.0), text);
}

#[test]
fn a_hand_of_other_size_types_the_same_text() {
    let setup = Setup {
        arm: ArmSetup::Measured {
            hand_length_mm: 175.0,
            forearm_length_mm: 225.0,
        },
        layout: "qwerty-flat".into(),
        ..Setup::default()
    };
    let setup = setup.load_files().expect("a person of this size");
    let text = "Another size.";
    assert_eq!(type_text(&setup, text, 115_200, 0.0), text);
}

#[test]
fn a_text_that_the_layout_cannot_type_is_refused() {
    let setup = load("arrows");
    let error = setup
        .typist("q", &glove_format_at(9_600), 0.0, 0)
        .err()
        .expect("the layout has no letters");
    assert!(error.to_string().contains("has the key Q"), "{error}");
}

#[test]
fn a_key_out_of_reach_is_named_with_its_distance() {
    let shipped = Layout::load("qwerty-flat").expect("the layout is shipped");
    let far = shipped.text.replace("forward_mm: 300", "forward_mm: 350");
    assert_ne!(far, shipped.text);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("far.ron");
    std::fs::write(&path, far).expect("the file is written");
    let setup = load(path.to_str().expect("a path in UTF-8"));
    let error = setup
        .typist("h1", &glove_format_at(9_600), 0.0, 0)
        .err()
        .expect("the key is too far away")
        .to_string();
    let reach = setup.out_of_reach();
    let found = reach.iter().find(|(name, _)| *name == "1");
    let (_, metres) = found.expect("the key is too far away");
    let said = format!("key `1` is {:.0} mm out of reach", metres * 1e3);
    assert!(error.contains(&said), "{said}: {error}");
    let names: Vec<&str> = reach.iter().map(|(name, _)| *name).collect();
    assert!(
        names.contains(&"1") && !names.contains(&"Space"),
        "{names:?}"
    );
}

#[test]
fn a_key_is_named_whose_press_would_press_another_one() {
    let pad: String = (0..12)
        .map(|index| {
            let (x, y) = (index % 3 * 27 - 27, 33 - index / 3 * 22);
            format!(
                "(code: \"F{}\", at_mm: ({x}, {y}), size_mm: Box(24, 17)),",
                index + 1
            )
        })
        .collect();
    let text = format!(
        "Layout(name: \"a\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45), \
         keys: [{pad}]), (pose: (anchor: elbow, bearing_deg: 35, forward_mm: 190, height_mm: -45, right_mm: -10), \
         shape: Arc(radius_mm: 90), keys: [(code: \"Space\", at_mm: (0, 0)), (code: \"Enter\", at_mm: (19, 0))])])"
    );
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("pad.ron");
    std::fs::write(&path, text).expect("the file is written");
    let setup = load(path.to_str().expect("a path in UTF-8"));
    let refused = [("Space", " "), ("Enter", "\n")].map(|(key, typed)| {
        let typist = setup.typist(typed, &glove_format_at(9_600), 0.0, 0);
        (key, typist.err().map_or(String::new(), |it| it.to_string()))
    });
    let errors = refused
        .iter()
        .filter(|(_, error)| error.contains("would press"));
    let errors: Vec<_> = errors.collect();
    assert!(!errors.is_empty());
    for (key, error) in errors {
        let start = format!("pad.ron: key `{key}` cannot be pressed: the ");
        assert!(error.contains(&start), "{error}");
        let end = " of the simulated hand would press `F";
        assert!(error.contains(end), "{error}");
    }
}

#[test]
fn a_source_of_joint_angles_needs_no_glove() {
    let setup = Setup {
        source: Some("file:angles?protocol=text-line".parse().expect("a source")),
        ..Setup::default()
    };
    let loaded = setup.load_files().expect("a setup without a glove");
    assert!(loaded.glove.is_none());
    assert_eq!(loaded.arm.side(), ademan::hand::Side::Right);
    assert!(loaded.recorded_setup().get("glove").is_none());
}

//! Persons of other sizes, sides and habits than the default: what they type, and how they move.

use ademan::capture::{Hc11Format, Reading, Sample, SampleKind, Source, SourceEvent};
use ademan::contact::Phase;
use ademan::device::{EventKind, Events};
use ademan::document::Document;
use ademan::files::Load;
use ademan::hand::{Dof, Finger, Joint, Side};
use ademan::kinematics::ArmModel;
use ademan::layout::{Layout, Person, mirror_layout};
use ademan::setup::{ArmSetup, LoadedSetup, OtherHand, Setup};
use ademan::sim::{
    SimulatedTypist, TypingHand, TypingKeys, TypistSettings, UsTextField, taps_for_text,
};
use parry3d::math::Vec3;

use crate::key_reach::KeyReach;

/// The persons of the tests, none of which is the default one.
const PERSONS: [&str; 5] = [
    "Person(side: \"left\")",
    "Person(hand_length_mm: 160)",
    "Person(hand_length_mm: 210, forearm_length_mm: 280)",
    "Person(side: \"left\", hand_length_mm: 160, hands: One)",
    "Person(hand_length_mm: 175, tremor: (amplitude_mm: 1.5, frequency_hz: 5))",
];

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.path().join(name);
        std::fs::write(&path, text).expect("a file");
        path.to_str().expect("UTF-8").to_owned()
    }
}

fn parse(text: &str) -> Person {
    Person::parse(&Document::new("person.ron", text)).expect("a person")
}

/// Loads a layout for a person, who uses the other hand too if the layout needs it.
fn load(layout: &str, person: &str) -> LoadedSetup {
    let first = parse(person).side.unwrap_or(Side::Right);
    let has_other = Layout::load(layout)
        .expect("a layout")
        .uses_hand(first.opposite());
    let uses_both = !person.contains("One");
    let folder = Folder::new();
    let setup = Setup {
        layout: layout.into(),
        person: Some(folder.file("person.ron", person)),
        other_hand: (has_other && uses_both).then(OtherHand::default),
        ..Setup::default()
    };
    setup.load_files().expect("a setup")
}

fn readings(hand: SimulatedTypist) -> Vec<Reading> {
    let mut hand = hand;
    let mut readings = Vec::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        readings.push(reading);
    }
    readings
}

/// Returns the text that the pipeline of a setup types from readings, and the fingers of its presses.
fn play(setup: &LoadedSetup, readings: &[Reading]) -> (String, Vec<Finger>) {
    let mut pipeline = setup.pipeline();
    let (mut events, mut field, mut fingers) = (Events::new(), UsTextField::new(), Vec::new());
    for reading in readings {
        events.clear();
        let output = pipeline
            .step(reading, &mut events)
            .expect("a valid reading");
        let presses = output.touches.iter();
        let presses = presses.filter(|touch| touch.phase == Phase::Pressed);
        fingers.extend(presses.map(|touch| touch.finger));
        events.iter().for_each(|event| field.handle(event));
    }
    (field.text().to_owned(), fingers)
}

fn type_text(setup: &LoadedSetup, text: &str) -> (String, Vec<Finger>) {
    let hand = setup.typist(text, &Hc11Format::default(), 0.0, 7);
    play(setup, &readings(hand.expect("a typist")))
}

#[test]
fn a_left_handed_person_reaches_everything_on_the_mirror_image_of_every_shipped_layout() {
    let folder = Folder::new();
    for (name, layout) in Layout::shipped().expect("shipped layouts") {
        // This board is where the hand is shown, which may be nearer.
        if name.ends_with("webcam-qwerty") {
            continue;
        }
        let document = Document::new(layout.file.as_str(), layout.text.as_str());
        // A layout with boards for both hands has no mirror image, and needs none.
        let path = match mirror_layout(&document) {
            Ok(mirrored) => folder.file(&format!("{name}.ron"), &mirrored),
            Err(_) => name.to_owned(),
        };
        for person in PERSONS.iter().filter(|person| person.contains("left")) {
            let setup = load(&path, person);
            assert_eq!(setup.arm.side(), Side::Left, "{name}");
            let missed = setup.out_of_reach();
            assert!(missed.is_empty(), "{name} {person}: {missed:?}");
        }
    }
}

#[test]
fn each_shipped_layout_can_be_used_by_a_left_hand_or_says_how_it_is_mirrored() {
    let (mut usable, mut mirrored) = (Vec::new(), Vec::new());
    for (name, _) in Layout::shipped().expect("shipped layouts") {
        // This board is where the hand is shown.
        if name.ends_with("webcam-qwerty") {
            continue;
        }
        let setup = load(name, "Person(side: \"left\")");
        match setup.reach_report(&setup.layout) {
            None => usable.push(name),
            Some(report) => {
                let file = name.rsplit('/').next().expect("a name");
                let advice = format!("`ademan layout new NAME --from {file} --mirror`");
                assert!(report.advice.contains(&advice), "{name}: {}", report.advice);
                mirrored.push(name);
            }
        }
    }
    println!("as they are: {usable:?}\nmirrored: {mirrored:?}");
    for (name, is_usable) in [
        ("qwerty-flat", false),
        ("chords-bend", true),
        ("qwerty-two-flat", true),
    ] {
        let found = usable.iter().any(|usable| usable.ends_with(name));
        assert_eq!(found, is_usable, "{name}");
    }
}

#[test]
fn a_left_handed_person_types_hello_on_every_keyboard() {
    let folder = Folder::new();
    let mut typed = Vec::new();
    for (name, layout) in Layout::shipped().expect("shipped layouts") {
        let is_keyboard = taps_for_text("hello", &layout, false).is_ok();
        if !is_keyboard || name.ends_with("webcam-qwerty") {
            continue;
        }
        let left = "Person(side: \"left\")";
        let as_it_is = load(name, left);
        let setup = match as_it_is.reach_report(&as_it_is.layout) {
            None => as_it_is,
            Some(_) => {
                let document = Document::new(layout.file.as_str(), layout.text.as_str());
                let mirrored = mirror_layout(&document).expect("a mirrored layout");
                load(&folder.file("mirrored.ron", &mirrored), left)
            }
        };
        assert_eq!(type_text(&setup, "hello").0, "hello", "{name}");
        typed.push(name);
    }
    println!("{typed:?}");
    assert!(typed.len() >= 8, "{typed:?}");
}

#[test]
fn every_person_types_on_the_layout_for_their_hand() {
    let folder = Folder::new();
    let text = "Persons, 1 2.";
    for name in ["qwerty-flat", "qwerty-arc"] {
        let layout = Layout::load(name).expect("a layout");
        let document = Document::new(layout.file.as_str(), layout.text.as_str());
        let mirrored = mirror_layout(&document).expect("a mirrored layout");
        let left = folder.file(&format!("{name}.ron"), &mirrored);
        for person in PERSONS {
            let is_left = person.contains("left");
            let setup = load(if is_left { &left } else { name }, person);
            assert_eq!(type_text(&setup, text).0, text, "{name} {person}");
        }
    }
}

#[test]
fn a_person_has_the_arm_of_the_same_measured_lengths_unless_the_setup_names_an_arm() {
    let length = |arm: &ArmModel| arm.reach().expect("a reach").from_elbow;
    let person = "Person(hand_length_mm: 160, forearm_length_mm: 220)";
    let folder = Folder::new();
    let setup = Setup {
        layout: "qwerty-flat".into(),
        person: Some(folder.file("person.ron", person)),
        ..Setup::default()
    };
    let setup = setup.load_files().expect("a setup");
    let measured = Setup {
        arm: ArmSetup::Measured {
            hand_length_mm: 160.0,
            forearm_length_mm: 220.0,
        },
        ..Setup::default()
    };
    let measured = measured.load_files().expect("a setup");
    assert_eq!(length(&setup.arm), length(&measured.arm));
    assert_eq!(setup.person_note(), None);
    let explicit = Setup {
        arm: ArmSetup::Model("unam".into()),
        ..setup.setup.clone()
    };
    let explicit = explicit.load_files().expect("a setup");
    let unam = Setup::default().load_files().expect("a setup");
    assert_eq!(length(&explicit.arm), length(&unam.arm));
    let note = explicit.person_note().expect("a note");
    assert!(note.contains("arm model `unam`"), "{note}");
}

#[test]
fn a_recording_of_a_person_is_replayed_without_the_file() {
    let setup = load("qwerty-flat", PERSONS[2]);
    let recorded = setup.recorded_setup();
    let path = setup.setup.person.clone().expect("a person");
    assert!(
        !std::path::Path::new(&path).exists(),
        "its folder was temporary"
    );
    let again = LoadedSetup::from_recording(&recorded, &Default::default()).expect("a setup");
    assert_eq!(again.person, setup.person);
    assert_eq!(again.arm.reach(), setup.arm.reach());
}

#[test]
fn a_person_and_a_glove_of_different_sides_are_refused() {
    let refused = |person: &str, change: &dyn Fn(&mut Setup)| {
        let folder = Folder::new();
        let mut setup = Setup {
            person: Some(folder.file("person.ron", person)),
            ..Setup::default()
        };
        change(&mut setup);
        let error = setup.load_files().expect_err("a contradiction");
        error.to_string()
    };
    let glove = refused(PERSONS[0], &|setup| setup.glove = Some("unam-hc11".into()));
    assert!(
        glove.contains("choose a glove for the left hand"),
        "{glove}"
    );
    let source = refused(PERSONS[0], &|setup| {
        let uri = "udp:127.0.0.1:9000?protocol=body-landmarks";
        setup.source = Some(uri.parse().expect("a source"));
    });
    assert!(source.contains("`hand=left`"), "{source}");
    let hands = refused("Person(hands: One)", &|setup| {
        setup.other_hand = Some(OtherHand::default());
    });
    assert!(hands.contains("remove `other_hand`"), "{hands}");
}

/// The joint positions of a person who types on `qwerty-flat` without a glove.
struct Motion {
    setup: LoadedSetup,
    samples: Vec<Sample>,
    period: f64,
}

impl Motion {
    fn new(person: &str, text: &str, seed: u64) -> Self {
        Self::on("qwerty-flat", person, text, seed)
    }

    fn on(layout: &str, person: &str, text: &str, seed: u64) -> Self {
        let setup = load(layout, person);
        let packet_period = Hc11Format::default().packet_period();
        let settings = TypistSettings {
            name: "person".into(),
            packet_period,
            noise: 0.0,
            seed,
            person: setup.person.clone(),
            keys: TypingKeys::new(&setup.layout),
        };
        let taps = taps_for_text(text, &setup.layout, false).expect("keys");
        let sensor = ademan::sim::Sensor::for_kind(SampleKind::Angles, None).expect("a sensor");
        let hands = [(&setup.arm, sensor)];
        let scene = &setup.layout.scene;
        let typist = SimulatedTypist::with_hands(&settings, &taps, scene, &hands);
        let mut typist = typist.expect("keys in reach");
        let samples = std::iter::from_fn(|| typist.next_samples());
        let samples = samples.map(|mut moved| moved.swap_remove(0).1).collect();
        Self {
            samples,
            setup,
            period: packet_period.as_secs_f64(),
        }
    }

    fn angles(&self) -> impl Iterator<Item = ademan::hand::JointAngles> {
        self.samples.iter().map(|sample| match sample {
            Sample::Angles { angles } => *angles,
            other => panic!("{other:?}"),
        })
    }

    fn tips(&self, finger: Finger) -> Vec<Vec3> {
        let hand = TypingHand::without_glove(&self.setup.arm);
        let pose = |angles: ademan::hand::JointAngles| {
            let estimate = ademan::estimate::Estimate::new(ademan::time::Timestamp(0), angles);
            let pose = self.setup.arm.forward(&estimate);
            pose.position(Joint::tip(finger)).expect("a fingertip")
        };
        assert_eq!(hand.side(), self.setup.arm.side());
        self.angles().map(pose).collect()
    }

    /// Returns the errors of the end points of taps on a key, in the frame of the world in millimetres.
    fn errors(&self, key: &str) -> Vec<Vec3> {
        let layout = &self.setup.layout;
        let key = layout.keys.iter().find(|other| other.face.name == key);
        let hand = TypingHand::without_glove(&self.setup.arm);
        let target = key.expect("a key").face.target;
        let reach = KeyReach::new(&hand, &layout.scene, target).expect("a place");
        let out = (reach.hover() - reach.bottom()).normalize();
        let mut errors = Vec::new();
        let mut lowest: Option<(f32, Vec3)> = None;
        for tip in self.tips(Finger::Index) {
            let error = tip - reach.bottom();
            let height = error.dot(out);
            match lowest {
                // Half of the way to the height of the hovering finger.
                _ if height > 0.010 => {
                    errors.extend(lowest.take().map(|(_, deepest)| deepest * 1e3));
                }
                Some((least, _)) if least <= height => {}
                _ => lowest = Some((height, error)),
            }
        }
        errors
    }
}

fn root_mean_square(lengths: impl Iterator<Item = f32> + Clone) -> f32 {
    let count = lengths.clone().count() as f32;
    (lengths.map(|length| length * length).sum::<f32>() / count).sqrt()
}

#[test]
fn end_points_scatter_as_the_person_says() {
    let taps = "j".repeat(150);
    let spread = |person: &str| {
        let errors = Motion::new(person, &taps, 1).errors("J");
        assert_eq!(errors.len(), taps.len(), "{person}");
        root_mean_square(errors.iter().map(|error| error.length()))
    };
    let exact = spread("Person(hand_length_mm: 180)");
    assert!(exact < 0.3, "{exact}");
    // √(2.4² + 3.2²) = 4, and √(0.01 × 17²) = 1.7 along one axis; 150 samples have a standard error of 5 %.
    let constant = spread("Person(hand_length_mm: 180, scatter: (x_mm: 2.4, y_mm: 3.2))");
    assert!((3.4..4.6).contains(&constant), "{constant}");
    let by_size = spread("Person(hand_length_mm: 180, scatter: (x_part: 0.01))");
    assert!((1.4..2.0).contains(&by_size), "{by_size}");
}

#[test]
fn a_finger_misses_by_its_constant_offset() {
    let person = "Person(hand_length_mm: 180, offsets_mm: {\"index\": (3, -4)})";
    let errors = Motion::new(person, "jjjj", 1).errors("J");
    assert_eq!(errors.len(), 4);
    for error in errors {
        assert!((error.length() - 5.0).abs() < 0.3, "{error}");
    }
}

#[test]
fn a_tremor_has_its_amplitude_and_frequency() {
    let calm = Motion::new("Person(hand_length_mm: 180)", "jjjjjjjj", 1);
    let person = "Person(hand_length_mm: 180, tremor: (amplitude_mm: 3, frequency_hz: 5))";
    let shaking = Motion::new(person, "jjjjjjjj", 1);
    let pairs = calm.tips(Finger::Index).into_iter();
    let offsets: Vec<Vec3> = pairs
        .zip(shaking.tips(Finger::Index))
        .map(|(still, trembling)| (trembling - still) * 1e3)
        .collect();
    let largest = offsets.iter().map(|offset| offset.length());
    let largest = largest.fold(0.0, f32::max);
    // Bent fingers are nearer to the wrist, which trembles, than the fingers of the amplitude.
    assert!((2.0..=3.0).contains(&largest), "{largest}");
    let seconds = offsets.len() as f64 * shaking.period;
    // The size of the offset has two peaks in each period.
    let peaks = offsets.windows(3).filter(|three| {
        let [before, at, after] = [0, 1, 2].map(|index| three[index].length());
        before < at && at >= after
    });
    let frequency = peaks.count() as f64 / 2.0 / seconds;
    assert!((4.5..5.5).contains(&frequency), "{frequency}");
}

#[test]
fn neighbors_follow_a_pressing_finger_in_part() {
    let bends = |person: &str, dof: Dof| {
        let motion = Motion::new(person, "jjj", 1);
        let angles = motion.angles().map(|angles| angles.get(dof));
        let (low, high) = angles.fold((f64::MAX, f64::MIN), |(low, high), angle| {
            (low.min(angle), high.max(angle))
        });
        high - low
    };
    let free = "Person(hand_length_mm: 180)";
    let enslaved = "Person(hand_length_mm: 180, enslaving: 1)";
    assert_eq!(bends(free, Dof::MiddleMcpFlexion), 0.0);
    let master = bends(enslaved, Dof::IndexMcpFlexion);
    let (middle, ring) = (
        bends(enslaved, Dof::MiddleMcpFlexion),
        bends(enslaved, Dof::RingMcpFlexion),
    );
    assert!(middle > ring && ring > 0.0, "{middle} {ring}");
    // A fifth of the flexion, in either direction from the posture before a press.
    assert!(middle <= 0.4 * master, "{middle} of {master}");
}

#[test]
fn the_errors_of_a_person_follow_from_the_seed() {
    let person = "Person(hand_length_mm: 180, scatter: (x_mm: 2), tremor: (amplitude_mm: 1))";
    let samples = |seed| Motion::new(person, "jkl", seed).samples;
    assert_eq!(samples(3), samples(3));
    assert_ne!(samples(3), samples(4));
}

#[test]
fn a_slow_person_needs_more_time() {
    let count = |speed: &str| {
        let person = format!("Person(hand_length_mm: 180, speed: {speed})");
        Motion::new(&person, "jkl", 1).samples.len()
    };
    let (slow, usual, fast) = (count("0.5"), count("1"), count("2"));
    assert!(slow > usual && usual > fast, "{slow} {usual} {fast}");
}

#[test]
fn ten_fingers_type_a_text_with_a_thumb_on_the_space() {
    let person = "Person(hand_length_mm: 183, fingers: [\"thumb\", \"index\", \"middle\", \"ring\", \"little\"])";
    let setup = load("qwerty-two-flat", person);
    let (typed, fingers) = type_text(&setup, "faj;ru ");
    assert_eq!(typed, "faj;ru ");
    let (space, letters) = fingers.split_last().expect("seven presses");
    assert_eq!((*space, letters.len()), (Finger::Thumb, 6));
    assert!(!letters.contains(&Finger::Thumb), "{letters:?}");
}

/// A person who types with all fingers.
const TEN_FINGERS: &str = "Person(hand_length_mm: 183, fingers: [\"thumb\", \"index\", \"middle\", \"ring\", \"little\"])";

/// Returns the text that is typed, and each press of a key: the hand, the finger, and the name of the key.
fn type_by_fingers(setup: &LoadedSetup, text: &str) -> (String, Vec<(Side, Finger, String)>) {
    let hand = setup.typist(text, &Hc11Format::default(), 0.0, 7);
    let names = setup.layout.target_names();
    let mut pipeline = setup.pipeline();
    let (mut events, mut field, mut presses) = (Events::new(), UsTextField::new(), Vec::new());
    for reading in readings(hand.expect("a typist")) {
        events.clear();
        let output = pipeline
            .step(&reading, &mut events)
            .expect("a valid reading");
        for touch in output.touches.iter() {
            if touch.phase == Phase::Pressed {
                let name = names.get(touch.target).to_string();
                presses.push((touch.side, touch.finger, name));
            }
        }
        events.iter().for_each(|event| field.handle(event));
    }
    (field.text().to_owned(), presses)
}

#[test]
fn each_of_eight_fingers_presses_its_columns_in_a_pangram() {
    let text = "sphinx of black quartz, judge my vow";
    let setup = load("qwerty-two-flat", TEN_FINGERS);
    let (typed, presses) = type_by_fingers(&setup, text);
    assert_eq!(typed, text);
    // As touch typing is taught.
    let columns = [
        (Side::Left, Finger::Little, "QAZ"),
        (Side::Left, Finger::Ring, "WSX"),
        (Side::Left, Finger::Middle, "EDC"),
        (Side::Left, Finger::Index, "RFVTGB"),
        (Side::Right, Finger::Index, "YHNUJM"),
        (Side::Right, Finger::Middle, "IK"),
        (Side::Right, Finger::Ring, "OL"),
        (Side::Right, Finger::Little, "P"),
    ];
    for (side, finger, _) in columns {
        let is_own = |press: &&(Side, Finger, String)| (press.0, press.1) == (side, finger);
        let own: Vec<&str> = presses
            .iter()
            .filter(is_own)
            .map(|press| press.2.as_str())
            .collect();
        println!("{side} {finger}: {own:?}");
    }
    let mut letters_pressed = 0;
    for (side, finger, letters) in columns {
        for (by_side, by_finger, key) in &presses {
            if key.len() == 1 && letters.contains(key.as_str()) {
                assert_eq!((*by_side, *by_finger), (side, finger), "{key}");
                letters_pressed += 1;
            }
        }
    }
    assert_eq!(letters_pressed, text.matches(char::is_alphabetic).count());
}

#[test]
fn four_fingers_of_one_hand_share_the_columns_of_a_board() {
    let text = "sphinx of black quartz judge my vow";
    let setup = load("qwerty-flat", TEN_FINGERS);
    let (typed, presses) = type_by_fingers(&setup, text);
    assert_eq!(typed, text);
    let count = |finger| presses.iter().filter(|press| press.1 == finger).count();
    let counts: Vec<usize> = Finger::ALL.iter().map(|&finger| count(finger)).collect();
    println!("{counts:?}");
    assert!(counts.iter().all(|&pressed| pressed >= 2), "{counts:?}");
}

#[test]
fn a_simulated_person_moves_their_own_hand_whatever_the_setup_assumes() {
    let text = "hand";
    let mut setup = Setup::default().load_files().expect("a setup");
    let assumed = type_text(&setup, text);
    assert_eq!(assumed.0, text);
    let usual = readings(
        setup
            .typist(text, &Hc11Format::default(), 0.0, 0)
            .expect("a typist"),
    );
    setup.simulated_person = parse("Person(hand_length_mm: 160)");
    let small = readings(
        setup
            .typist(text, &Hc11Format::default(), 0.0, 0)
            .expect("a typist"),
    );
    assert_ne!(usual.len(), 0);
    assert_ne!(
        usual[..],
        small[..],
        "the joints of a smaller hand bend otherwise"
    );
    assert_eq!(
        setup.arm.reach(),
        Setup::default().load_files().expect("a setup").arm.reach()
    );
}

#[test]
fn a_person_without_errors_moves_as_the_default_one() {
    let setup = load("qwerty-flat", "Person(name: \"nobody\")");
    let other = Setup::default().load_files().expect("a setup");
    let format = Hc11Format::default();
    let of =
        |loaded: &LoadedSetup| readings(loaded.typist("Same!", &format, 0.0, 0).expect("typist"));
    assert_eq!(of(&setup), of(&other));
}

#[test]
fn narrow_joint_limits_put_keys_out_of_reach() {
    let stiff = "Person(joint_limits_deg: {\"elbow-flexion\": (30, 40)})";
    let setup = load("qwerty-flat", stiff);
    assert!(!setup.out_of_reach().is_empty());
    assert!(load("qwerty-flat", "Person()").out_of_reach().is_empty());
}

#[test]
fn a_person_whose_presses_scatter_makes_errors_that_a_calm_one_does_not() {
    let text = "the quick brown fox jumps over the lazy dog";
    let count = |person: &str| {
        let setup = load("qwerty-flat", person);
        let (typed, _) = type_text(&setup, text);
        ademan::sim::error_rate(text, &typed)
    };
    assert_eq!(count("Person(hand_length_mm: 180)"), 0.0);
    let scattered = count("Person(hand_length_mm: 180, scatter: (x_mm: 8, y_mm: 8))");
    assert!(scattered > 0.05, "{scattered}");
}

/// Returns the names of the controls of a layout that are out of reach.
fn missed(text: &str, person: &str) -> Vec<String> {
    let folder = Folder::new();
    let path = folder.file("layout.ron", text);
    let setup = load(&path, person);
    let missed = setup.out_of_reach().into_iter();
    missed.map(|(name, _)| name.to_owned()).collect()
}

/// Returns a layout at the wrist with keys around the tip of a half bent index finger of the default hand.
fn below_the_index_finger(keys: &str) -> String {
    let arm = Setup::default().load_files().expect("a setup").arm;
    let tip = arm.reach().expect("a reach").half_bent[Finger::Index.index()] * 1e3;
    format!(
        "Layout(name: \"wrist\", boards: [(pose: (anchor: wrist, right_mm: {}, forward_mm: {}, height_mm: {}), {keys})])",
        tip.x,
        -tip.z,
        tip.y - 5.0
    )
}

#[test]
fn the_finger_that_the_layout_names_has_to_reach_its_key() {
    let layout = |finger: &str| {
        below_the_index_finger(&format!("keys: [(code: \"A\", {finger}at_mm: (0, 0))]"))
    };
    assert_eq!(missed(&layout(""), "Person()"), [""; 0]);
    assert_eq!(missed(&layout("finger: \"index\", "), "Person()"), [""; 0]);
    assert_eq!(missed(&layout("finger: \"little\", "), "Person()"), ["A"]);
    let other = "Person(fingers: [\"little\"])";
    assert_eq!(missed(&layout(""), other), ["A"]);
}

#[test]
fn a_board_at_the_wrist_has_a_shaded_area_of_reach() {
    let folder = Folder::new();
    let layout = below_the_index_finger("rows: [(at_mm: (-38, 0), keys: \"A S D F G\")]");
    let path = folder.file("wrist.ron", &layout);
    let area = |person: &str| {
        let wearer = load(&path, person).wearer();
        let outlines = wearer.areas.into_iter().flat_map(|area| area.outlines);
        let doubled = outlines.map(|outline| {
            let next = outline.iter().cycle().skip(1);
            let pairs = outline.iter().zip(next);
            pairs.map(|(a, b)| a.perp_dot(*b)).sum::<f32>()
        });
        doubled.sum::<f32>().abs() / 2.0
    };
    let (all, little) = (area("Person()"), area("Person(fingers: [\"little\"])"));
    assert!(all > 0.0 && little < all, "{all} {little}");
}

#[test]
fn a_board_too_near_the_wrist_is_said_to_be_too_near() {
    let folder = Folder::new();
    let text = "Layout(name: \"near\", boards: [(pose: (anchor: wrist, forward_mm: 20, height_mm: -5), keys: [(code: \"A\", finger: \"middle\", at_mm: (0, 0))])])";
    let setup = load(&folder.file("near.ron", text), "Person()");
    let report = setup.reach_report(&setup.layout).expect("out of reach");
    let advice = report.advice;
    assert!(advice.contains("too near: move it away"), "{advice}");
}

#[test]
fn keys_are_down_only_while_they_are_pressed_by_a_shaking_hand() {
    let person = "Person(hand_length_mm: 175, tremor: (amplitude_mm: 3, frequency_hz: 5))";
    let setup = load("qwerty-flat", person);
    let hand = setup.typist("shaking", &Hc11Format::default(), 0.0, 1);
    let mut pipeline = setup.pipeline();
    let mut events = Events::new();
    let mut down = 0_i32;
    for reading in readings(hand.expect("a typist")) {
        events.clear();
        pipeline
            .step(&reading, &mut events)
            .expect("a valid reading");
        for event in &events {
            match event.kind {
                EventKind::KeyDown(_) => down += 1,
                EventKind::KeyUp(_) => down -= 1,
                _ => {}
            }
        }
        assert!(down >= 0);
    }
    assert_eq!(down, 0);
}

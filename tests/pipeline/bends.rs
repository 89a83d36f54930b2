//! Chords of bent fingers from the curls of a glove. The curls follow a rule of this test, not the simulated hand: the fingers
//! of a chord bend one after the other, at their own speeds and to their own ends, over a hand that is relaxed.

use std::time::Duration;

use ademan::capture::protocol::Decoder;
use ademan::capture::protocol::lucidgloves::{FULL_SCALE, decoder};
use ademan::capture::{Reading, Sample, SourceUri};
use ademan::device::{EventKind, Events, KeyAction, KeyCode};
use ademan::files::Load;
use ademan::hand::{Finger, HandPart, Joint, JointPositions, Side};
use ademan::layout::Layout;
use ademan::pipeline::{PipelineState, SourceRole};
use ademan::setup::Setup;
use ademan::sim::UsTextField;
use ademan::time::Timestamp;
use glam::DVec3;

use crate::support::checked::CheckedPipeline;
use crate::support::lucidgloves::{RATE_HZ, curls, with_noise};

/// Largest noise of a curl, in counts: 1 % of the range.
const NOISE: i64 = 40;

/// A glove on a board, and the field that receives what it types.
struct Glove {
    pipeline: CheckedPipeline,
    decoder: Box<dyn Decoder>,
    lines: u64,
    field: UsTextField,
    /// The characters of texts.
    written: String,
    /// The curls of the last line.
    last: [f64; Finger::COUNT],
    /// `true` if another source shows the arm after each line.
    is_arm_seen: bool,
    random: fastrand::Rng,
}

impl Glove {
    fn new(seed: u64) -> Self {
        Self::with_layout("chords-bend", seed)
    }

    fn with_layout(layout: &str, seed: u64) -> Self {
        let setup = Setup {
            source: Some("file:glove?protocol=lucidgloves".parse().expect("a source")),
            layout: layout.to_owned(),
            ..Setup::default()
        };
        Self::with_setup(setup, seed)
    }

    fn with_setup(setup: Setup, seed: u64) -> Self {
        let setup = setup.load_files().expect("a valid setup");
        Self {
            pipeline: CheckedPipeline::new(&setup),
            decoder: Box::new(decoder(FULL_SCALE)),
            lines: 0,
            field: UsTextField::new(),
            written: String::new(),
            last: [0.2; Finger::COUNT],
            is_arm_seen: false,
            random: fastrand::Rng::with_seed(seed),
        }
    }

    /// Sends a line with these curls and noise.
    fn send(&mut self, fractions: [f64; Finger::COUNT]) {
        self.last = fractions;
        let fields = with_noise(curls(fractions), NOISE, &mut self.random);
        self.lines += 1;
        let time = Timestamp::from_seconds(self.lines as f64 / RATE_HZ);
        let mut events = Events::new();
        let pipeline = &mut self.pipeline;
        self.decoder
            .push(fields.encode().as_bytes(), &mut |packet| {
                let reading = Reading::new(time, packet.side, packet.sample);
                pipeline
                    .step(&reading, &mut events)
                    .expect("an accepted reading");
            });
        self.handle(&events);
        if self.is_arm_seen {
            self.show_arm();
        }
    }

    /// Sends a reading of the arm, just after the last line.
    fn show_arm(&mut self) {
        let mut positions = JointPositions::default();
        positions.set(Joint::Elbow, DVec3::ZERO);
        positions.set(Joint::Wrist, DVec3::NEG_Z * 0.25);
        let line = Timestamp::from_seconds(self.lines as f64 / RATE_HZ);
        let time = line + Duration::from_micros(1);
        let mut reading = Reading::new(time, Some(Side::Right), Sample::Joints { positions });
        reading.part = Some(HandPart::Arm);
        let mut events = Events::new();
        self.pipeline
            .step(&reading, &mut events)
            .expect("an accepted reading");
        self.handle(&events);
    }

    fn handle(&mut self, events: &Events) {
        for event in events {
            self.field.handle(event);
            if let EventKind::Character(character) = event.kind {
                self.written.push(character);
            }
        }
    }

    /// Moves the fingers to these curls within 80 ms, and keeps them there until `milliseconds` are over.
    fn hold(&mut self, fractions: [f64; Finger::COUNT], milliseconds: u64) {
        let from = self.last;
        for step in 1..=milliseconds / 10 {
            let part = smooth(step as f64 / 8.0);
            self.send(std::array::from_fn(|finger| {
                from[finger] + (fractions[finger] - from[finger]) * part
            }));
        }
    }

    /// Bends fingers and straightens them.
    fn stroke(&mut self, fingers: &[Finger]) {
        let between =
            |random: &mut fastrand::Rng, (low, high): (f64, f64)| low + (high - low) * random.f64();
        let random = &mut self.random;
        let moves = fingers.iter().map(|&finger| Move {
            finger,
            bend: between(random, (0.6, 1.0)),
            down_at: between(random, (0.0, 60.0)),
            down_for: between(random, (90.0, 140.0)),
            up_at: between(random, (0.0, 60.0)),
            up_for: between(random, (90.0, 140.0)),
        });
        let moves: Vec<Move> = moves.collect();
        let relaxed = between(random, (0.0, 0.25));
        let held_for = between(random, (60.0, 120.0));
        let gap = between(random, (60.0, 150.0));
        let all_down = moves.iter().map(|it| it.down_at + it.down_for);
        let up_from = all_down.fold(0.0, f64::max) + held_for;
        let all_up = moves.iter().map(|it| it.up_at + it.up_for);
        let end = up_from + all_up.fold(0.0, f64::max) + gap;
        self.hold([relaxed; Finger::COUNT], 80);
        for step in 0..(end / 10.0) as u64 {
            let now = 10.0 * step as f64;
            let mut fractions = [relaxed; Finger::COUNT];
            for it in &moves {
                let down = smooth((now - it.down_at) / it.down_for);
                let up = smooth((now - up_from - it.up_at) / it.up_for);
                fractions[it.finger.index()] += (it.bend - relaxed) * (down - up);
            }
            self.send(fractions);
        }
    }
}

/// The movement of one finger of a chord: times in milliseconds, `up_at` after all fingers are down.
struct Move {
    finger: Finger,
    bend: f64,
    down_at: f64,
    down_for: f64,
    up_at: f64,
    up_for: f64,
}

fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Returns the fingers of each stroke of a character, as a reader of the legend finds them: in the letters, or after the stroke
/// of the layer in that layer.
fn strokes(layout: &Layout, character: char) -> Option<Vec<Vec<Finger>>> {
    let finger = |target| {
        let (surface, _) = layout.scene.target(target).expect("a target");
        surface.bent_by(target).expect("a finger")
    };
    let single = layout.keys.iter().map(|key| {
        let fingers = vec![finger(key.face.target)];
        (fingers, key.actions.as_slice())
    });
    let together = layout.chords.iter().map(|chord| {
        let fingers = chord.keys.iter().map(|&key| finger(key)).collect();
        (fingers, chord.actions.as_slice())
    });
    let legend: Vec<(Vec<Finger>, &[Option<KeyAction>])> = single.chain(together).collect();
    let find = |layer: usize, is_wanted: &dyn Fn(KeyAction) -> bool| {
        let mut legend = legend.iter();
        let found = legend.find(|(_, actions)| {
            let own = actions.get(layer).copied().flatten();
            own.is_some_and(is_wanted)
        });
        found.map(|(fingers, _)| fingers.clone())
    };
    for (code, is_shifted) in KeyCode::for_us_character(character) {
        let is_shift = |action| matches!(action, KeyAction::Modifier(KeyCode::SHIFT_LEFT, _));
        let is_layer = |action| matches!(action, KeyAction::Layer(1, _));
        let mut strokes = Vec::new();
        if is_shifted {
            strokes.push(find(0, &is_shift)?);
        }
        if let Some(letter) = find(0, &|action| action == KeyAction::Key(code)) {
            strokes.push(letter);
            return Some(strokes);
        }
        if let Some(symbol) = find(1, &|action| action == KeyAction::Key(code)) {
            strokes.extend([find(0, &is_layer)?, symbol]);
            return Some(strokes);
        }
    }
    None
}

fn bent(fingers: &[Finger], bend: f64) -> [f64; Finger::COUNT] {
    let mut fractions = [0.1; Finger::COUNT];
    for finger in fingers {
        fractions[finger.index()] = bend;
    }
    fractions
}

#[test]
fn all_of_us_ascii_is_typed_by_fingers_that_bend_one_after_the_other() {
    let layout = Layout::load("chords-bend").expect("a shipped layout");
    let text: String = (' '..='~').chain("hello, World! (42)".chars()).collect();
    for seed in 0..3 {
        let mut glove = Glove::new(seed);
        glove.hold([0.2; Finger::COUNT], 600);
        for character in text.chars() {
            let strokes = strokes(&layout, character);
            let strokes = strokes.unwrap_or_else(|| panic!("no stroke for {character:?}"));
            strokes.iter().for_each(|stroke| glove.stroke(stroke));
        }
        assert_eq!(glove.field.text(), text, "seed {seed}");
        assert!(glove.field.pressed().is_empty());
    }
}

#[test]
fn a_finger_that_is_bent_at_the_start_types_nothing_until_it_was_straight_and_is_named() {
    let mut glove = Glove::new(1);
    let index = [Finger::Index];
    glove.hold(bent(&index, 0.55), 1000);
    assert_eq!(glove.pipeline.state(), PipelineState::Paused);
    let named = glove.pipeline.bent_fingers();
    assert!(
        Finger::ALL
            .iter()
            .all(|&finger| { named.contains(finger) == (finger == Finger::Index) })
    );
    glove.hold(bent(&index, 0.1), 600);
    assert_eq!(glove.pipeline.state(), PipelineState::Running);
    assert!(glove.pipeline.bent_fingers().is_empty());
    assert_eq!(glove.field.text(), "");
    glove.hold(bent(&index, 0.9), 400);
    glove.hold(bent(&index, 0.1), 400);
    assert_eq!(glove.field.text(), "e");
}

#[test]
fn a_relaxed_hand_is_armed_and_a_finger_is_released_only_below_the_release_point() {
    let mut glove = Glove::new(2);
    glove.hold([0.33; Finger::COUNT], 800);
    assert_eq!(glove.pipeline.state(), PipelineState::Running);
    for bend in [0.6, 1.0, 0.45, 0.6] {
        glove.hold(bent(&[Finger::Ring], bend), 400);
        assert_eq!(glove.field.pressed().count(), 1, "{bend}");
    }
    assert_eq!(glove.field.text(), "a");
    glove.hold(bent(&[Finger::Ring], 0.3), 300);
    assert!(glove.field.pressed().is_empty());
}

const EVERY_ACTION: &str = r#"Layout(
    name: "Every action",
    boards: [(contact: Bend, pose: (anchor: wrist), press_at: 0.7, release_at: 0.3, keys: [
        (name: "T", action: NoOp, finger: "thumb", at_mm: (0, 0)),
        (name: "I", code: "A", finger: "index", at_mm: (20, 0), press_at: 0.5),
        (name: "M", code: "B", finger: "middle", at_mm: (40, 0)),
    ])],
    chord_timeout_ms: 100,
    chords: [
        (keys: "T I", action: Key("X"), hold: (code: "Y"), hold_after_ms: 400),
        (keys: "T M", action: Key("Z"), activate_on: Release),
        (keys: "I M", action: Text("ñ")),
        (keys: "T I M", action: Layer("more"), latch: Lock),
    ],
    layers: [(name: "more", keys: {"I": "1"}, chords: [(keys: "T M", action: Key("2"))])],
)"#;

#[test]
fn chords_are_tapped_held_act_on_release_type_texts_and_lock_layers() {
    use Finger::{Index, Middle, Thumb};
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("every.ron");
    std::fs::write(&path, EVERY_ACTION).expect("room on the disk");
    let mut glove = Glove::with_layout(&path.display().to_string(), 3);
    glove.hold([0.1; Finger::COUNT], 600);
    let typed = |worn: &mut Glove, fingers: &[Finger], milliseconds| {
        let before = worn.field.text().chars().count();
        worn.hold(bent(fingers, 0.9), milliseconds);
        let while_down: String = worn.field.text().chars().skip(before).collect();
        worn.hold(bent(fingers, 0.1), 200);
        let all: String = worn.field.text().chars().skip(before).collect();
        (while_down, all)
    };
    let both = |a: &str, b: &str| (a.to_owned(), b.to_owned());
    assert_eq!(typed(&mut glove, &[Thumb, Index], 250), both("", "x"));
    assert_eq!(typed(&mut glove, &[Thumb, Index], 700), both("y", "y"));
    assert_eq!(typed(&mut glove, &[Thumb, Middle], 400), both("", "z"));
    assert_eq!(typed(&mut glove, &[Index, Middle], 300), both("ñ", "ñ"));
    assert_eq!(glove.written, "ñ");
    assert_eq!(typed(&mut glove, &[Thumb], 300), both("", ""));
    assert_eq!(
        typed(&mut glove, &[Thumb, Index, Middle], 200),
        both("", "")
    );
    assert_eq!(typed(&mut glove, &[Index], 300), both("1", "1"));
    assert_eq!(typed(&mut glove, &[Thumb, Middle], 200), both("", "2"));
    typed(&mut glove, &[Thumb, Index, Middle], 200);
    assert_eq!(typed(&mut glove, &[Middle], 300), both("b", "b"));
    // Each key has its own thresholds.
    glove.hold(bent(&[Middle], 0.6), 300);
    assert!(glove.field.pressed().is_empty());
    glove.hold(bent(&[Index], 0.6), 300);
    assert_eq!(glove.field.pressed().count(), 1);
}

#[test]
fn a_finger_that_bends_in_a_gap_types_nothing_because_others_of_its_chord_may_be_straight_again() {
    for (missing, typed) in [(10, "a"), (17, "")] {
        let mut glove = Glove::new(7);
        glove.hold([0.1; Finger::COUNT], 600);
        glove.lines += missing;
        glove.last = bent(&[Finger::Ring], 0.9);
        glove.hold(glove.last, 300);
        glove.hold([0.1; Finger::COUNT], 300);
        assert_eq!(glove.field.text(), typed, "{missing} lines");
    }
}

#[test]
fn a_chord_of_bent_fingers_does_not_depend_on_an_arm_that_is_late() {
    let source = |uri: &str| -> Option<SourceUri> { Some(uri.parse().expect("a source")) };
    let setup = Setup {
        source: source("serial:/dev/x?protocol=lucidgloves"),
        arm_source: source("udp:127.0.0.1:9000?protocol=markers"),
        arm_role: Some(SourceRole::Both),
        layout: "chords-bend".to_owned(),
        ..Setup::default()
    };
    let mut glove = Glove::with_setup(setup, 7);
    let chord = bent(&[Finger::Ring, Finger::Little], 0.9);
    for (is_arm_seen, fractions, milliseconds) in [
        (true, [0.1; Finger::COUNT], 600),
        (true, chord, 60),
        (false, chord, 100),
        (true, chord, 20),
        (true, [0.1; Finger::COUNT], 400),
    ] {
        glove.is_arm_seen = is_arm_seen;
        glove.hold(fractions, milliseconds);
    }
    assert_eq!(glove.field.text(), "d");
}

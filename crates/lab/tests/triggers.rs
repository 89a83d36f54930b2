//! Shapes and motions of a hand as triggers: none while people type, tap and gesticulate, and all of them when people make them.

mod support;

use std::collections::BTreeMap;
use std::time::Duration;

use ademan_core::capture::protocol::lucidgloves;
use ademan_core::capture::{Reading, Sample};
use ademan_core::device::trigger::HandShape;
use ademan_core::device::{EventKind, Events};
use ademan_core::document::Document;
use ademan_core::estimate::{
    BendRanges, Estimate, Estimator, EstimatorSettings, JointAngles, LANDMARK_SMOOTHING,
    hand_angles,
};
use ademan_core::hand::{Dof, Finger, Joint, JointPositions, Side};
use ademan_core::kinematics::{ArmModel, half_bent_fingers};
use ademan_core::layout::{Glove, Layout};
use ademan_core::pipeline::{LayoutInstance, Pipeline, PipelineSettings};
use ademan_core::time::Timestamp;
use ademan_lab::people::{Draw, Participant, People, population};
use ademan_lab::phrases::{Corpus, PhraseSet};
use ademan_lab::sim::fluent::SourceKind;
use ademan_lab::trials::{Observed, Station, Watch};
use glam::DVec3;
use serde_json::Value;
use support::shared;

/// The layout whose triggers are tested.
const LAYOUT: &str = "gestures";

/// Most false triggers in an hour, of each trigger.
const MAX_PER_HOUR: f64 = 1.0;

/// Phrases that each person types on each layout with each kind of sensor.
const PHRASES: usize = 7;

/// The triggers of the layout for shapes.
const SHAPES: [(HandShape, &str); 4] = [
    (HandShape::Fist, "Play or pause"),
    (HandShape::OpenHand, "Full screen"),
    (HandShape::Point, "Leave"),
    (HandShape::ThumbsUp, "Confirm"),
];

/// A pipeline with the layout, and the times at which its triggers turned on.
struct Rig {
    pipeline: Pipeline,
    names: Vec<String>,
    on: BTreeMap<String, Vec<Timestamp>>,
    rejected: u64,
}

/// The kinds of triggers that the layout lacks, with the defaults of the format.
const OTHER_KINDS: &str = r#"
    (name: "Pinch index", when: Pinch(finger: "index")),
    (name: "Pinch middle", when: Pinch(finger: "middle")),
    (name: "Pinch ring", when: Pinch(finger: "ring")),
    (name: "Pinch little", when: Pinch(finger: "little")),
"#;

/// A shake, and circles of the palm and of a fingertip.
const MOTIONS: &str = r#"
    (name: "Shake", when: Shake()),
    (name: "Circle", when: Circle(direction: "clockwise")),
    (name: "Circle back", when: Circle(direction: "counter-clockwise")),
    (name: "Fingertip circle", when: Circle(point: "index")),
"#;

/// Sequences, and the steps that the layout lacks.
const SEQUENCES: &str = r#"
    (name: "Short fist", when: HandShape(name: "fist"), hold_ms: 100),
    (name: "Short open hand", when: HandShape(name: "open-hand"), hold_ms: 100),
    (name: "Fist, open hand", when: Sequence(steps: ["Short fist", "Short open hand"])),
    (name: "To the left and up", when: Sequence(steps: ["Next", "Louder"], within_ms: 2000)),
"#;

/// Returns the shipped layout with more triggers.
fn layout(more: &[&str]) -> Layout {
    let mut document = Document::shipped(LAYOUT).expect("a shipped layout");
    let end = document.text.rfind("],").expect("the end of the triggers");
    document.text.insert_str(end, &more.concat());
    Layout::from_document(document).expect("a valid layout")
}

impl Rig {
    /// Creates a pipeline with every kind of trigger.
    fn with_all(arms: &[ArmModel], glove: &[&str], is_camera: bool) -> Self {
        let layout = layout(&[OTHER_KINDS, MOTIONS, SEQUENCES]);
        Self::of(&layout, arms, glove, is_camera)
    }

    fn new(arms: &[ArmModel], glove: &[&str], is_camera: bool) -> Self {
        Self::of(&layout(&[MOTIONS]), arms, glove, is_camera)
    }

    fn of(layout: &Layout, arms: &[ArmModel], glove: &[&str], is_camera: bool) -> Self {
        let estimator = |index: usize| {
            let settings = EstimatorSettings {
                position_smoothing: is_camera.then_some(LANDMARK_SMOOTHING),
                rest_pose: half_bent_fingers(),
                ..EstimatorSettings::default()
            };
            let estimator = Estimator::new(settings);
            match glove.get(index) {
                Some(name) => {
                    let document = Document::shipped(name).expect("a shipped glove");
                    estimator.with_channels(&Glove::parse(&document).expect("a glove").map)
                }
                None => estimator,
            }
        };
        let settings = PipelineSettings {
            arm_immediately: true,
            ..PipelineSettings::default()
        };
        let instance = LayoutInstance::from_layout(layout);
        let pipeline = Pipeline::new(estimator(0), arms[0].clone(), instance, settings);
        let pipeline = match arms.get(1) {
            Some(arm) => pipeline.with_second_hand(estimator(1), arm.clone()),
            None => pipeline,
        };
        let names = layout.triggers.iter().map(|(name, _)| name.clone());
        Self {
            names: names.collect(),
            pipeline,
            on: BTreeMap::new(),
            rejected: 0,
        }
    }

    fn see(&mut self, reading: &Reading) {
        let mut events = Events::new();
        if self.pipeline.step(reading, &mut events).is_err() {
            self.rejected += 1;
        }
        let names = self.pipeline.target_names();
        for event in &events {
            if let EventKind::Value(target, 1.0) = event.kind {
                let name = names.get(target).to_string();
                self.on.entry(name).or_default().push(event.time);
            }
        }
    }

    fn count(&self, name: &str) -> usize {
        self.on.get(name).map_or(0, Vec::len)
    }
}

/// The false triggers of one kind of motion.
#[derive(Default)]
struct Tally {
    hours: f64,
    counts: BTreeMap<String, usize>,
}

impl Tally {
    fn add(&mut self, rig: &Rig, hours: f64) {
        self.hours += hours;
        for name in &rig.names {
            *self.counts.entry(name.clone()).or_default() += rig.count(name);
        }
    }

    fn print(&self, kind: &str) {
        println!("{kind}: {:.2} h of hands", self.hours);
        for (name, count) in &self.counts {
            let rate = *count as f64 / self.hours;
            println!("  {name:18} {count:4}  {rate:6.1} an hour");
        }
    }
}

/// Lets people type on a layout and returns the false triggers.
fn typing(layout: &str, source: SourceKind, people: &[Participant], phrases: usize) -> Tally {
    let document = Document::shipped(layout).expect("a shipped layout");
    let corpus = Corpus::shipped(PhraseSet::En);
    let mut tally = Tally::default();
    for (number, person) in people.iter().enumerate() {
        let mut station = Station::new(&document, person, source).expect("a person");
        let texts = corpus.phrases.iter().skip(number * phrases).take(phrases);
        let texts: Vec<&str> = texts.map(String::as_str).collect();
        let strokes = station.strokes_for(texts.iter().copied());
        let gloves: &[&str] = match source {
            SourceKind::Glove => &["unam-hc11", "unam-hc11-left"],
            _ => &[],
        };
        let arms = station.assumed_arms().to_vec();
        for (seed, text) in texts.into_iter().enumerate() {
            let mut rig = Rig::with_all(&arms, gloves, source == SourceKind::Camera);
            let mut watch = Watch::default();
            let mut observed = Observed::default();
            station.type_watched(text, &strokes, seed as u64, &mut observed, Some(&mut watch));
            for reading in &watch.readings {
                rig.see(reading);
            }
            assert!(
                rig.rejected * 20 < watch.readings.len() as u64,
                "{layout} {source}"
            );
            tally.add(&rig, observed.simulated_seconds / 3600.0);
        }
    }
    tally
}

#[test]
fn a_typing_hand_shows_no_shape_and_no_motion_more_than_once_an_hour() {
    let mut total = Tally::default();
    for source in SourceKind::ALL {
        for layout in [
            "qwerty-flat",
            "qwerty-two-flat",
            "qwerty-arc",
            "dvorak-flat",
        ] {
            let people = population(&People::Drawn(6), None, 97);
            let tally = typing(layout, *source, &people, PHRASES);
            tally.print(&format!("{layout} {source}"));
            total.hours += tally.hours;
            for (name, count) in tally.counts {
                *total.counts.entry(name).or_default() += count;
            }
        }
    }
    total.print("all");
    for (name, count) in &total.counts {
        let rate = *count as f64 / total.hours;
        assert!(rate <= MAX_PER_HOUR, "{name}: {rate} an hour");
    }
}

/// Returns the positions of 21 landmarks of MediaPipe, in metres: a palm of 90 mm, +X to the right, +Y up.
fn positions(points: &Value) -> JointPositions {
    let point = |index: usize| {
        let number = |axis: usize| points[index][axis].as_f64().expect("a coordinate");
        DVec3::new(number(0), -number(1), -number(2))
    };
    let scale = 0.09 / point(0).distance(point(9)).max(1e-9);
    let mut positions = JointPositions::default();
    positions.set(Joint::Wrist, DVec3::ZERO);
    for (&finger, first) in Finger::ALL.iter().zip([1, 5, 9, 13, 17]) {
        let joints = finger.joints();
        let joints = &joints[joints.len() - 4..];
        for (index, &joint) in joints.iter().enumerate() {
            positions.set(joint, (point(first + index) - point(0)) * scale);
        }
    }
    positions
}

/// Returns the side for which the knuckles of most pictures bend to the palm.
fn side_of(pictures: &[JointPositions]) -> Side {
    let knuckles = [
        Dof::IndexMcpFlexion,
        Dof::MiddleMcpFlexion,
        Dof::RingMcpFlexion,
    ];
    let bend = |side: Side| -> f64 {
        let angles = pictures.iter().map(|it| hand_angles(it, side));
        angles
            .map(|angles| knuckles.map(|dof| angles.get(dof)).iter().sum::<f64>())
            .sum()
    };
    match bend(Side::Right) >= bend(Side::Left) {
        true => Side::Right,
        false => Side::Left,
    }
}

fn arm(side: Side) -> ArmModel {
    let person = population(&People::Drawn(1), None, 1).remove(0);
    ArmModel::anthropometric(side, &person.assumed).expect("an arm")
}

#[test]
fn recorded_hands_that_tap_a_table_show_no_shape_and_no_motion() {
    let mut clips: Vec<Value> = Vec::new();
    for name in ["train", "validate"] {
        let Some(path) = shared(&format!("data/finger-taps/{name}.json")) else {
            return;
        };
        let text = std::fs::read_to_string(path).expect("a file");
        let read: Vec<Value> = serde_json::from_str(&text).expect("JSON");
        clips.extend(read);
    }
    let mut rigs = [Side::Left, Side::Right].map(|side| Rig::with_all(&[arm(side)], &[], true));
    // One clip after the other, as if they were one film of each side.
    let mut times = [0_u64; 2];
    for clip in &clips {
        let pictures = clip["x"].as_array().expect("pictures");
        let pictures: Vec<JointPositions> = pictures.iter().map(positions).collect();
        let side = side_of(&pictures);
        for positions in pictures {
            let time = &mut times[side.index()];
            *time += 33_333;
            let sample = Sample::Joints { positions };
            rigs[side.index()].see(&Reading::new(Timestamp(*time), Some(side), sample));
        }
    }
    let mut tally = Tally::default();
    for (rig, time) in rigs.iter().zip(times) {
        println!("{} rejected", rig.rejected);
        tally.add(rig, time as f64 / 3.6e9);
    }
    tally.print("finger taps");
    assert!(tally.counts.values().all(|count| *count == 0));
}

#[test]
fn shapes_of_recorded_hands_are_recognised() {
    let Some(path) = shared("peers/landmarks/mediapipe_tasks_hands.json") else {
        return;
    };
    let text = std::fs::read_to_string(path).expect("a file");
    let recorded: Value = serde_json::from_str(&text).expect("JSON");
    let samples = recorded["samples"].as_array().expect("samples");
    let victory = samples.iter().find(|it| it["name"] == "victory");
    let victory = positions(&victory.expect("a sample")["world"]);
    for sample in samples {
        let name = sample["name"].as_str().expect("a name");
        let expected = match name {
            "fist" => Some("Play or pause"),
            "pointing_up" | "pointing_up_rotated" => Some("Leave"),
            "thumb_up" | "thumb_up_rotated" => Some("Confirm"),
            _ => None,
        };
        let shown = positions(&sample["world"]);
        let bends = BendRanges::human().bends(&hand_angles(&shown, Side::Right));
        println!("{name}: {bends:?}");
        let mut rig = Rig::new(&[arm(Side::Right)], &[], true);
        for number in 0..120_u64 {
            let positions = if number < 30 { victory } else { shown };
            let sample = Sample::Joints { positions };
            rig.see(&Reading::new(
                Timestamp(number * 33_333),
                Some(Side::Right),
                sample,
            ));
        }
        let on: Vec<&str> = rig.on.keys().map(String::as_str).collect();
        assert_eq!(on, expected.into_iter().collect::<Vec<_>>(), "{name}");
    }
}

/// The bends of a hand at rest, and of its fingers as a person makes a shape: not exactly as others do.
fn shape_bends(shape: HandShape, draw: &mut Draw) -> [f64; Finger::COUNT] {
    std::array::from_fn(|index| match shape.bend(Finger::ALL[index]) {
        Some(bend) if bend > 0.5 => draw.between(0.75, 0.95),
        Some(_) => draw.between(0.0, 0.1),
        None => draw.between(0.2, 0.7),
    })
}

/// The readings of a source in a second, another for each person.
fn rate(person: &Participant) -> f64 {
    [30.0, 45.0, 60.0, 90.0, 120.0][person.number as usize % 5]
}

/// The time of a movement to a shape, and until the shape is left.
const MOVE: f64 = 0.3;
const SHOWN: f64 = 2.5;

/// The bend of a finger before the shape: an open hand follows a closed one.
fn bend_before(shape: HandShape) -> f64 {
    if shape == HandShape::OpenHand {
        0.75
    } else {
        0.4
    }
}

/// Returns the bend of each finger at a time, from a relaxed hand to a shape.
fn bends_at(seconds: f64, before: f64, shape: &[f64; Finger::COUNT]) -> [f64; Finger::COUNT] {
    let fraction = ((seconds - 1.0) / MOVE).clamp(0.0, 1.0);
    shape.map(|bend| before + fraction * (bend - before))
}

/// Checks that a shape turned on its trigger once, in time, and no other one.
fn check_detection(rig: &Rig, name: &str, hold: Duration, what: &str) {
    let is_later = |times: &Vec<Timestamp>| times.iter().any(|time| time.seconds() > 1.0);
    let later = rig.on.iter().filter(|(_, times)| is_later(times));
    assert_eq!(
        later.map(|(name, _)| name).collect::<Vec<_>>(),
        [name],
        "{what}"
    );
    assert_eq!(rig.count(name), 1, "{what}");
    let seconds = rig.on[name][0].seconds() - 1.0 - hold.as_secs_f64();
    // The trigger may see the shape before its end, sensors are late, and noise may restart the hold time.
    assert!(
        (0.0..=MOVE + 0.3).contains(&seconds),
        "{what}: {seconds} s late"
    );
}

fn hold(name: &str) -> Duration {
    let layout = layout(&[]);
    let trigger = layout.triggers.iter().find(|(own, _)| own == name);
    trigger.expect("a trigger").1.hold
}

#[test]
fn people_with_other_bones_in_front_of_a_noisy_camera_make_every_shape() {
    for person in population(&People::Drawn(6), None, 98) {
        for &side in Side::ALL {
            for (shape, name) in SHAPES {
                let assumed = ArmModel::anthropometric(side, &person.assumed).expect("an arm");
                let own = ArmModel::anthropometric(side, &person.own).expect("an arm");
                let mut draw = Draw::new(person.seed, shape.index() as u64);
                let shown = shape_bends(shape, &mut draw);
                let mut rig = Rig::new(&[assumed], &[], true);
                for number in 0..(rate(&person) * SHOWN) as u64 {
                    let seconds = number as f64 / rate(&person);
                    let angles = angles_of(&bends_at(seconds, bend_before(shape), &shown));
                    let time = Timestamp::from_seconds(seconds);
                    let mut positions = own.forward(&Estimate::new(time, angles)).positions();
                    for (joint, position) in positions.clone().known() {
                        let noise = DVec3::new(draw.normal(), draw.normal(), 3.0 * draw.normal());
                        positions.set(joint, position + noise * 1e-3);
                    }
                    let sample = Sample::Joints { positions };
                    rig.see(&Reading::new(time, Some(side), sample));
                }
                let what = format!("{shape} of person {} {side}", person.number);
                check_detection(&rig, name, hold(name), &what);
            }
        }
    }
}

/// The positions of a hand whose palm makes a motion in front of a noisy camera, and what its triggers do.
fn moved(arm: &ArmModel, hertz: f64, draw: &mut Draw, way: impl Fn(f64) -> DVec3) -> Rig {
    let mut rig = Rig::new(std::slice::from_ref(arm), &[], true);
    let bends = |_: f64| [0.3; Finger::COUNT];
    let times = (0..(hertz * SHOWN) as u64).map(|number| number as f64 / hertz);
    show(&mut rig, arm, times, draw, bends, way);
    rig
}

/// Shows the positions of a hand to a pipeline, as a noisy camera sees them. `bends` returns the bends of the fingers and `way` the
/// position of the palm, at a time in seconds.
fn show(
    rig: &mut Rig,
    arm: &ArmModel,
    times: impl Iterator<Item = f64>,
    draw: &mut Draw,
    bends: impl Fn(f64) -> [f64; Finger::COUNT],
    way: impl Fn(f64) -> DVec3,
) {
    for seconds in times {
        let time = Timestamp::from_seconds(seconds);
        let angles = angles_of(&bends(seconds));
        let mut positions = arm.forward(&Estimate::new(time, angles)).positions();
        for (joint, position) in positions.clone().known() {
            let noise = DVec3::new(draw.normal(), draw.normal(), 3.0 * draw.normal());
            positions.set(joint, position + noise * 1e-3 + way(seconds - 1.0));
        }
        let sample = Sample::Joints { positions };
        rig.see(&Reading::new(time, Some(arm.side()), sample));
    }
}

/// Returns the fraction of a motion that is done at a fraction of its time: the jerk of it is least.
fn minimum_jerk(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
}

#[test]
fn people_in_front_of_a_noisy_camera_swipe_in_every_direction_and_shake() {
    for person in population(&People::Drawn(6), None, 98) {
        for &side in Side::ALL {
            let arm = ArmModel::anthropometric(side, &person.own).expect("an arm");
            let mut draw = Draw::new(person.seed, 17);
            for (direction, name) in [
                (DVec3::NEG_X, "Next"),
                (DVec3::X, "Back"),
                (DVec3::Y, "Louder"),
                (DVec3::NEG_Y, "Quieter"),
            ] {
                let (far, time) = (draw.between(0.3, 0.4), draw.between(0.25, 0.4));
                let rig = moved(&arm, rate(&person), &mut draw, |seconds| {
                    direction * far * minimum_jerk(seconds / time)
                });
                let what = format!("{name} of person {} {side}", person.number);
                check_detection(&rig, name, Duration::ZERO, &what);
            }
            let (half, hertz) = (draw.between(0.07, 0.1), draw.between(2.5, 3.2));
            let rig = moved(&arm, rate(&person), &mut draw, |seconds| {
                let phase = seconds.max(0.0) * hertz * std::f64::consts::TAU;
                DVec3::X * half * phase.sin()
            });
            assert_eq!(rig.count("Shake"), 1, "person {} {side}", person.number);
        }
    }
}

#[test]
fn people_in_front_of_a_noisy_camera_draw_circles_upright_and_flat() {
    for person in population(&People::Drawn(20), None, 99) {
        for &side in Side::ALL {
            let arm = ArmModel::anthropometric(side, &person.own).expect("an arm");
            let mut draw = Draw::new(person.seed, 18);
            for (name, other, sense) in [
                ("Circle", "Circle back", 1.0),
                ("Circle back", "Circle", -1.0),
            ] {
                // Wide or high by a fifth, tilted backwards by up to a quarter turn, and begun anywhere.
                let (radius, time) = (draw.between(0.05, 0.14), draw.between(0.6, 1.3));
                let (wide, begin) = (draw.between(0.8, 1.2), draw.between(0.0, 6.2));
                let tilt = draw.between(0.0, std::f64::consts::FRAC_PI_2);
                let at = |angle: f64| {
                    let (right, up) = (wide * angle.sin() * sense, angle.cos());
                    radius * DVec3::new(right, up * tilt.cos(), -up * tilt.sin())
                };
                let rig = moved(&arm, rate(&person), &mut draw, |seconds| {
                    let done = minimum_jerk(seconds / time);
                    at(begin + done * std::f64::consts::TAU) - at(begin)
                });
                let what = format!("{name} of person {} {side}: {:?}", person.number, rig.on);
                assert_eq!(rig.count(name), 1, "{what}");
                assert_eq!(rig.count("Fingertip circle"), 1, "{what}");
                assert_eq!(rig.count(other), 0, "{what}");
            }
        }
    }
}

#[test]
fn a_hand_that_goes_half_round_or_draws_a_square_makes_no_circle() {
    for person in population(&People::Drawn(6), None, 99) {
        let arm = ArmModel::anthropometric(Side::Right, &person.own).expect("an arm");
        let mut draw = Draw::new(person.seed, 19);
        let radius = draw.between(0.06, 0.12);
        let half = moved(&arm, rate(&person), &mut draw, |seconds| {
            let (sine, cosine) = (minimum_jerk(seconds / 0.6) * 3.1).sin_cos();
            radius * DVec3::new(sine, cosine, 0.0)
        });
        let corners = [DVec3::ZERO, DVec3::X, DVec3::ONE - DVec3::Z, DVec3::Y];
        let square = moved(&arm, rate(&person), &mut draw, |seconds| {
            let side = (seconds / 0.3).clamp(0.0, 3.999);
            let [from, to] = [side as usize, (side as usize + 1) % 4].map(|it| corners[it]);
            2.0 * radius * from.lerp(to, minimum_jerk(side.fract()))
        });
        for rig in [half, square] {
            let circles = ["Circle", "Circle back", "Fingertip circle"].map(|it| rig.count(it));
            assert_eq!(circles, [0; 3], "person {}: {:?}", person.number, rig.on);
        }
    }
}

#[test]
fn a_fist_that_opens_in_time_is_a_sequence() {
    let layout = layout(&[SEQUENCES]);
    let name = "Fist, open hand";
    for person in population(&People::Drawn(10), None, 98) {
        for &side in Side::ALL {
            let assumed = ArmModel::anthropometric(side, &person.assumed).expect("an arm");
            let own = ArmModel::anthropometric(side, &person.own).expect("an arm");
            let mut draw = Draw::new(person.seed, 20);
            let [fist, open] =
                [HandShape::Fist, HandShape::OpenHand].map(|shape| shape_bends(shape, &mut draw));
            let (closing, opening) = (draw.between(0.15, 0.4), draw.between(0.15, 0.4));
            let held = draw.between(0.3, 1.2);
            // A hand that rests half open for longer than a second between the two makes no sequence.
            for (rest, expected) in [(0.0, 1), (1.6, 0)] {
                let bends = |seconds: f64| {
                    let close = minimum_jerk((seconds - 1.0) / closing);
                    let since = seconds - 1.0 - closing - held;
                    let relax = if rest > 0.0 {
                        minimum_jerk(since / opening)
                    } else {
                        0.0
                    };
                    let spread = minimum_jerk((since - rest) / opening);
                    std::array::from_fn(|it| {
                        let bend = 0.4 + close * (fist[it] - 0.4);
                        let bend = bend + relax * (0.35 - bend);
                        bend + spread * (open[it] - bend)
                    })
                };
                let mut rig = Rig::of(&layout, std::slice::from_ref(&assumed), &[], true);
                let times = (0..(rate(&person) * 6.0) as u64).map(|it| it as f64 / rate(&person));
                show(&mut rig, &own, times, &mut draw, bends, |_| DVec3::ZERO);
                let what = format!("person {} {side}, {rest} s: {:?}", person.number, rig.on);
                assert_eq!(rig.count(name), expected, "{what}");
                assert_eq!(rig.count("Short fist"), 1, "{what}");
            }
        }
    }
}

/// A part of the ordinary motion of a hand: it goes to a place, and rests there or beats time to what its person says.
struct Reach {
    begin: f64,
    from: DVec3,
    to: DVec3,
    seconds: f64,
    bends: [[f64; Finger::COUNT]; 2],
    /// Half of the way of a beat, and beats in a second.
    beat: (DVec3, f64),
}

impl Reach {
    /// Draws reaches for a time in seconds: over 50 cm to the side, 40 cm up and ahead, as fast as people reach for a cup and not faster than needed.
    fn draw(seconds: f64, draw: &mut Draw) -> Vec<Self> {
        let mut reaches: Vec<Self> = Vec::new();
        let (mut begin, mut from, mut bends) = (0.0, DVec3::ZERO, [0.35; Finger::COUNT]);
        while begin < seconds {
            let [right, up, ahead] = [0.25, 0.2, 0.2].map(|half| draw.between(-half, half));
            let to = DVec3::new(right, up, ahead);
            let time = (0.4 + 1.2 * from.distance(to)) * draw.between(0.9, 1.5);
            // Relaxed, flat on something, or around something.
            let kind = [(0.2, 0.5), (0.05, 0.2), (0.4, 0.58)][draw.between(0.0, 3.0) as usize];
            let next = std::array::from_fn(|finger| match finger {
                0 => draw.between(0.15, 0.5),
                _ => draw.between(kind.0, kind.1),
            });
            let up = draw.between(0.015, 0.04);
            let beat = DVec3::new(
                draw.between(-0.5, 0.5) * up,
                up,
                draw.between(-0.5, 0.5) * up,
            );
            let beats = draw.between(0.0, 1.0) < 0.4;
            let beat = if beats { beat } else { DVec3::ZERO };
            reaches.push(Self {
                begin,
                from,
                to,
                seconds: time,
                bends: [bends, next],
                beat: (beat, draw.between(1.0, 2.5)),
            });
            begin += time + draw.between(0.3, 3.0);
            (from, bends) = (to, next);
        }
        reaches
    }

    fn at(reaches: &[Self], seconds: f64) -> (&Self, f64) {
        let index = reaches.partition_point(|it| it.begin <= seconds);
        let reach = &reaches[index.saturating_sub(1)];
        (reach, minimum_jerk((seconds - reach.begin) / reach.seconds))
    }
}

#[test]
fn hands_that_reach_hold_rest_and_talk_show_no_shape_and_no_motion_more_than_once_an_hour() {
    let mut tally = Tally::default();
    for person in population(&People::Drawn(10), None, 95) {
        for &side in Side::ALL {
            let assumed = ArmModel::anthropometric(side, &person.assumed).expect("an arm");
            let own = ArmModel::anthropometric(side, &person.own).expect("an arm");
            let mut draw = Draw::new(person.seed, 21 + side.index() as u64);
            let seconds = 360.0;
            let reaches = Reach::draw(seconds, &mut draw);
            let bends = |seconds: f64| {
                let (reach, done) = Reach::at(&reaches, seconds);
                let [from, to] = reach.bends;
                std::array::from_fn(|it| from[it] + done * (to[it] - from[it]))
            };
            let way = |since_begin: f64| {
                let seconds = since_begin + 1.0;
                let (reach, done) = Reach::at(&reaches, seconds);
                let (beat, hertz) = reach.beat;
                let phase = (seconds - reach.begin) * hertz * std::f64::consts::TAU;
                reach.from.lerp(reach.to, done) + beat * done * phase.sin()
            };
            let mut rig = Rig::with_all(std::slice::from_ref(&assumed), &[], true);
            let times = (0..(rate(&person) * seconds) as u64).map(|it| it as f64 / rate(&person));
            show(&mut rig, &own, times, &mut draw, bends, way);
            tally.add(&rig, seconds / 3600.0);
        }
    }
    tally.print("reaches");
    // The thumb of this hand does not know what is between it and a finger.
    let counts = tally.counts.iter();
    for (name, count) in counts.filter(|(name, _)| !name.starts_with("Pinch")) {
        let rate = *count as f64 / tally.hours;
        assert!(rate <= MAX_PER_HOUR, "{name}: {rate} an hour");
    }
}

fn angles_of(bends: &[f64; Finger::COUNT]) -> JointAngles {
    let mut angles = JointAngles::default();
    for &dof in Dof::ALL {
        angles.set(dof, 0.0);
    }
    angles.set(Dof::ElbowFlexion, 1.0);
    for (&finger, &bend) in Finger::ALL.iter().zip(bends) {
        for (dof, radians) in BendRanges::human().angles_at(finger, bend) {
            angles.set(dof, radians);
        }
    }
    angles
}

#[test]
fn a_glove_with_five_curls_makes_every_shape_on_either_hand() {
    for (side, glove) in [
        (Side::Right, "lucidgloves"),
        (Side::Left, "lucidgloves-left"),
    ] {
        for (shape, name) in SHAPES {
            let mut draw = Draw::new(7, shape.index() as u64);
            let shown = shape_bends(shape, &mut draw);
            let mut rig = Rig::new(&[arm(side)], &[glove], false);
            let mut decoder = (lucidgloves::PROTOCOL.decoder)(&Default::default());
            for number in 0..(100.0 * SHOWN) as u64 {
                let seconds = number as f64 / 100.0;
                let counts = bends_at(seconds, bend_before(shape), &shown).map(|bend| {
                    let noise = 20.0 * draw.normal();
                    (bend * 4095.0 + noise).clamp(0.0, 4095.0).round()
                });
                let [thumb, index, middle, ring, little] = counts;
                let line = format!("A{thumb}B{index}C{middle}D{ring}E{little}\n");
                decoder.push(line.as_bytes(), &mut |packet| {
                    let time = Timestamp::from_seconds(seconds);
                    rig.see(&Reading::new(time, Some(side), packet.sample));
                });
            }
            check_detection(&rig, name, hold(name), &format!("{shape} {side}"));
        }
    }
}

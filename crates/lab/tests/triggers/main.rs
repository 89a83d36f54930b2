//! Shapes and motions of a hand as triggers: none while people type, tap and gesticulate, and all of them when people make them.

mod made;
#[path = "../support/mod.rs"]
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
        let gloves: &[&str] = if source.is_glove() {
            &["unam-hc11", "unam-hc11-left"]
        } else {
            &[]
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
    if bend(Side::Right) >= bend(Side::Left) {
        Side::Right
    } else {
        Side::Left
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
fn shapes_of_recorded_hands_are_recognized() {
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
            let joints = Sample::Joints { positions };
            rig.see(&Reading::new(
                Timestamp(number * 33_333),
                Some(Side::Right),
                joints,
            ));
        }
        let on: Vec<&str> = rig.on.keys().map(String::as_str).collect();
        assert_eq!(on, expected.into_iter().collect::<Vec<_>>(), "{name}");
    }
}

/// The readings of a source in a second, another for each person.
fn rate(person: &Participant) -> f64 {
    [30.0, 45.0, 60.0, 90.0, 120.0][person.number as usize % 5]
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
    /// Draws reaches for a time in seconds: over 50 cm to the side, 40 cm up and ahead, as fast as people reach for a cup and not
    /// faster than needed.
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
            let beat_height = draw.between(0.015, 0.04);
            let beat = DVec3::new(
                draw.between(-0.5, 0.5) * beat_height,
                beat_height,
                draw.between(-0.5, 0.5) * beat_height,
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
            let bends = |elapsed: f64| {
                let (reach, done) = Reach::at(&reaches, elapsed);
                let [from, to] = reach.bends;
                std::array::from_fn(|it| from[it] + done * (to[it] - from[it]))
            };
            let way = |since_begin: f64| {
                let since_start = since_begin + 1.0;
                let (reach, done) = Reach::at(&reaches, since_start);
                let (beat, hertz) = reach.beat;
                let phase = (since_start - reach.begin) * hertz * std::f64::consts::TAU;
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

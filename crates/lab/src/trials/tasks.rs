//! Tasks on controls: touch every key and switch, and move sliders and knobs to values.

use std::time::Duration;

use parry3d::math::Vec2;

use super::station::Station;
use crate::capture::Reading;
use crate::contact::{Phase, TargetId};
use crate::device::{EventKind, Events};
use crate::document::Document;
use crate::layout::{Handle, Motion, Person, Scatter, Tremor};
use crate::people::{Draw, mix};
use crate::sim::fluent::SourceKind;
use crate::sim::script::Script;
use crate::sim::{
    JointSensor, Sensor, SimulatedTypist, TourStop, TypingKeys, TypistSettings, tour,
};
use crate::time::Timestamp;

/// The values to which each slider and knob is moved.
const GOALS: usize = 3;
/// The part of a track that is used.
const INNER: f32 = 0.8;
/// Deviation of the noise of the sensors: millimetres for a camera, counts for a glove ?.
const CAMERA_NOISE: f64 = 1.0;
const GLOVE_NOISE: f64 = 0.5;

/// The kind of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TaskKind {
    /// Use a control once.
    Touch,
    /// Move a control to a value.
    Value,
}

/// The result of a person in a task.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskResult {
    /// The name of the control.
    pub name: String,
    /// The kind.
    pub kind: TaskKind,
    /// The control was within reach and did what it should.
    pub is_done: bool,
    /// Presses of other controls.
    pub wrong: usize,
    /// The time from the start of the movement to the end of the task, in seconds.
    pub seconds: f64,
    /// The difference from the value that was to be set, as a part of the range or in turns; `None` unless a value was to be set.
    pub error: Option<f64>,
}

/// The observations of a script that was played.
#[derive(Default)]
struct Played {
    pressed: Vec<TargetId>,
    values: Vec<(TargetId, f32)>,
    has_events: bool,
    seconds: f64,
}

impl Station {
    /// Does all tasks of the layout once. `has_pointed` leaves out movements that only show that a cursor moves.
    pub fn do_tasks(&self, seed: u64, has_pointed: bool) -> Vec<TaskResult> {
        let mut draw = Draw::new(seed, 0x7a5c);
        // Each task has errors of its own.
        let mut tries = 0;
        let mut next_seed = || {
            tries += 1;
            mix(seed.wrapping_add(tries))
        };
        let stops = tour(&self.layout).into_iter();
        let mut results: Vec<TaskResult> = stops
            .filter(|stop| !(has_pointed && stop.moves_cursor()))
            .map(|stop| self.touch(&stop, next_seed()))
            .collect();
        for control in &self.layout.controls {
            let Some(face) = control.faces.first() else {
                continue;
            };
            let name = format!("\"{}\"", face.name);
            for _ in 0..GOALS {
                let handle = control.kind.handle();
                let (from, by) = match handle {
                    Handle::Line { half_length } => {
                        let end = half_length * INNER * 1e3;
                        (-end, 2.0 * end * draw.between(0.1, 1.0) as f32)
                    }
                    Handle::Turn { radius, .. } => {
                        let rim = radius * 1e3;
                        (rim, -(draw.between(20.0, 150.0) as f32))
                    }
                    Handle::Switch | Handle::Stick { .. } | Handle::Area | Handle::Pad { .. } => {
                        break;
                    }
                };
                let is_turned = matches!(handle, Handle::Turn { .. });
                let script = if is_turned { turn } else { slide };
                let scatter = self.person.scatter[0] as f32 * draw.normal() as f32;
                // Millimetres along a track, degrees at a rim.
                let error = if is_turned {
                    (scatter / from).to_degrees()
                } else {
                    scatter
                };
                let wanted = self.play(&script(&name, from, by), None);
                let done = self.play(&script(&name, from, by + error), Some(next_seed()));
                results.push(value_result(&face.name, face.target, wanted, done));
            }
        }
        results
    }

    fn touch(&self, stop: &TourStop, seed: u64) -> TaskResult {
        let target = self.layout.target_names().find(&stop.name);
        let played = self.play(&stop.actions, Some(seed));
        let mut result = TaskResult {
            name: stop.name.clone(),
            kind: TaskKind::Touch,
            is_done: false,
            wrong: 0,
            seconds: 0.0,
            error: None,
        };
        let Some(played) = played else { return result };
        let is_own = |pressed: &TargetId| Some(*pressed) == target;
        let is_board = target.is_some_and(|target| self.layout.face(target).is_some());
        result.is_done = if is_board {
            played.pressed.iter().any(is_own)
        } else {
            played.has_events
        };
        result.wrong = if is_board {
            played.pressed.iter().filter(|it| !is_own(it)).count()
        } else {
            0
        };
        result.seconds = played.seconds;
        result
    }

    /// Plays a script with the errors of the person, or without any for `None`; `None` if the hand cannot play it.
    fn play(&self, script: &str, seed: Option<u64>) -> Option<Played> {
        let document = Document::new("task", script);
        let parsed = Script::parse(document, &self.layout.target_names()).ok()?;
        let settings = TypistSettings {
            name: "task".to_owned(),
            packet_period: Duration::from_secs_f64(1.0 / self.source.rate_hz()),
            noise: match (seed, self.source) {
                (None, _) | (_, SourceKind::Ideal) => 0.0,
                (_, SourceKind::Camera) => CAMERA_NOISE,
                (_, SourceKind::Glove) => GLOVE_NOISE,
            },
            seed: seed.unwrap_or_default(),
            person: match seed {
                Some(_) => self.motion_of_person(),
                None => Person::default(),
            },
            keys: TypingKeys::new(&self.layout),
        };
        let hands = self.arms().map(|(own, map)| {
            let sensor = match (map, self.source) {
                (Some(map), _) => Sensor::Glove(map),
                (None, SourceKind::Camera) => Sensor::Joints(JointSensor::Positions),
                (None, _) => Sensor::Joints(JointSensor::Angles),
            };
            (own, sensor)
        });
        let hands: Vec<_> = hands.collect();
        let actions: Vec<_> = parsed.actions().to_vec();
        let actions: Vec<_> = actions
            .into_iter()
            .map(|action| action.placed(&self.layout.fit))
            .collect();
        let typist =
            SimulatedTypist::with_hands(&settings, &actions, &self.layout.scene, &hands).ok()?;
        Some(self.watch(typist))
    }

    /// Passes all readings of a hand through a pipeline.
    fn watch(&self, mut typist: SimulatedTypist) -> Played {
        let mut pipeline = self.pipeline();
        let (mut events, mut played) = (Events::new(), Played::default());
        let (mut time, mut first) = (0_u64, None);
        let period = typist.packet_period();
        while let Some(samples) = typist.next_samples() {
            time += period.as_micros() as u64;
            for (side, sample) in samples {
                let reading = Reading::new(Timestamp(time), Some(side), sample);
                events.clear();
                let Ok(output) = pipeline.step(&reading, &mut events) else {
                    continue;
                };
                let pressed = output.touches.iter();
                let pressed = pressed.filter(|touch| touch.phase == Phase::Pressed);
                played.pressed.extend(pressed.map(|touch| touch.target));
                played.has_events |= !events.is_empty() || !output.commands.is_empty();
                for event in &events {
                    if let EventKind::Value(target, value) = event.kind {
                        played.values.push((target, value));
                    }
                }
                if !output.touches.is_empty() || !events.is_empty() {
                    let start = *first.get_or_insert(time);
                    played.seconds = (time - start) as f64 * 1e-6;
                }
            }
        }
        played
    }

    /// Returns the person as the planner of scripts knows people.
    fn motion_of_person(&self) -> Person {
        let person = &self.person;
        let metres = |millimetres: f64| (millimetres * 1e-3) as f32;
        let [x, y] = person.scatter;
        Person {
            fingers: person.finger_set(),
            motion: Motion {
                // The planner moves as a person of 60 ms + 85 ms a bit.
                speed: 85.0 / person.fitts_b_ms,
                scatter: Scatter {
                    deviation: Vec2::new(metres(x), metres(y)).extend(metres(person.depth_scatter)),
                    parts: Vec2::new(
                        person.scatter_parts[0] as f32,
                        person.scatter_parts[1] as f32,
                    ),
                },
                offsets: person
                    .offsets
                    .map(|[across, along]| Vec2::new(metres(across), metres(along))),
                tremor: Tremor {
                    amplitude: person.tremor * 1e-3,
                    frequency_hz: person.tremor_hz,
                },
                enslaving: person.enslaving,
            },
            ..Person::default()
        }
    }
}

fn slide(name: &str, from: f32, by: f32) -> String {
    format!("press {name} {from:.2} 0; slide {by:.2} 0; lift")
}

fn turn(name: &str, rim: f32, degrees: f32) -> String {
    format!("press {name} {rim:.2} 0; arc {degrees:.2}; lift")
}

fn value_result(
    name: &str,
    target: TargetId,
    wanted: Option<Played>,
    done: Option<Played>,
) -> TaskResult {
    let last = |played: &Played| {
        let mut values = played.values.iter().rev();
        values
            .find(|(own, _)| *own == target)
            .map(|(_, value)| *value)
    };
    let is_other = |pressed: &&TargetId| **pressed != target;
    let values = wanted
        .as_ref()
        .and_then(last)
        .zip(done.as_ref().and_then(last));
    TaskResult {
        name: name.to_owned(),
        kind: TaskKind::Value,
        is_done: values.is_some(),
        wrong: done
            .as_ref()
            .map_or(0, |it| it.pressed.iter().filter(is_other).count()),
        seconds: done.as_ref().map_or(0.0, |it| it.seconds),
        error: values.map(|(goal, reached)| f64::from((goal - reached).abs())),
    }
}

//! Tasks on controls: touch every key and switch, and move sliders and knobs to values.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use parry3d::math::Vec2;

use super::jobs::Cancelled;
use super::station::Station;
use crate::capture::Reading;
use crate::contact::{Phase, TargetId};
use crate::device::{EventKind, Events};
use crate::document::Document;
use crate::layout::{Control, ControlKind, Face, Handle, Motion, Person, Scatter, Tremor};
use crate::people::{Draw, mix};
use crate::sim::fluent::SourceKind;
use crate::sim::script::Script;
use crate::sim::{
    JointSensor, Sensor, SimulatedTypist, TourStop, TypingKeys, TypistError, TypistSettings, tour,
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
    /// `true` if the control was within reach and did what it should.
    pub is_done: bool,
    /// Presses of other controls.
    pub wrong: usize,
    /// The time from the first to the last touch or event, in seconds; 0 without any.
    pub seconds: f64,
    /// The difference from the value that was to be set, as a part of the range or in turns; `None` unless a value was to be set.
    pub error: Option<f64>,
}

/// The results of a person in all tasks of a layout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TasksDone {
    /// The results that count.
    pub results: Vec<TaskResult>,
    /// The names of the controls that even a hand without errors cannot use, each once.
    pub untried: Vec<String>,
}

impl TasksDone {
    fn leave_out(&mut self, name: &str) {
        if !self.untried.iter().any(|it| it == name) {
            self.untried.push(name.to_owned());
        }
    }
}

/// The end of a script.
enum Play {
    Played(Played),
    /// The arm does not reach a control, or another control is in the way.
    OutOfReach,
    /// The hand or its sensor has no such movement.
    Impossible,
}

impl Play {
    /// Returns the observations; `None` if the script was not played.
    fn played(&self) -> Option<&Played> {
        match self {
            Self::Played(played) => Some(played),
            Self::OutOfReach | Self::Impossible => None,
        }
    }
}

/// The observations of a script that was played.
#[derive(Default)]
struct Played {
    pressed: Vec<TargetId>,
    values: Vec<(TargetId, f32)>,
    has_events: bool,
    seconds: f64,
}

impl Played {
    /// Returns the last value of a control.
    fn last_value(&self, target: TargetId) -> Option<f32> {
        let mut values = self.values.iter().rev();
        let last = values.find(|(own, _)| *own == target);
        last.map(|(_, value)| *value)
    }
}

impl Station {
    /// Does all tasks of the layout once. `has_pointed` leaves out movements that only show that a cursor moves. A control does not count
    /// if a hand without errors fails, although it reaches the control: then the lab cannot try it.
    ///
    /// # Errors
    /// If it is cancelled, between two tasks.
    pub fn do_tasks(
        &self,
        seed: u64,
        has_pointed: bool,
        cancel: &AtomicBool,
    ) -> Result<TasksDone, Cancelled> {
        let mut draw = Draw::new(seed, 0x7a5c);
        // Each task has errors of its own.
        let mut tries = 0;
        let mut next_seed = || {
            tries += 1;
            mix(seed.wrapping_add(tries))
        };
        let check = || {
            if cancel.load(Ordering::Relaxed) {
                Err(Cancelled)
            } else {
                Ok(())
            }
        };
        let mut tasks = TasksDone::default();
        let stops = tour(&self.layout).into_iter();
        for stop in stops.filter(|stop| !(has_pointed && stop.moves_cursor())) {
            check()?;
            let own_seed = Some(next_seed());
            if self.can_try(&stop) {
                let play = self.play(&stop.actions, own_seed);
                tasks.results.push(self.touch(&stop, &play));
            } else {
                tasks.leave_out(&stop.name);
            }
        }
        for control in &self.layout.controls {
            let Some(face) = control.faces.first() else {
                continue;
            };
            let name = format!("\"{}\"", face.name);
            for _ in 0..GOALS {
                check()?;
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
                let goal = wanted.played().map(|it| it.last_value(face.target));
                // A control that is out of reach is tried in vain.
                if matches!(wanted, Play::Impossible) || goal == Some(None) {
                    tasks.leave_out(&face.name);
                    continue;
                }
                let result = value_result(control, face, goal.flatten(), &done);
                tasks.results.push(result);
            }
        }
        Ok(tasks)
    }

    /// Returns `true` if a hand without errors uses a control, or does not reach it.
    fn can_try(&self, stop: &TourStop) -> bool {
        match self.play(&stop.actions, None) {
            Play::OutOfReach => true,
            Play::Impossible => false,
            play @ Play::Played(_) => self.touch(stop, &play).is_done,
        }
    }

    /// Returns the result of a control that was to be used once.
    fn touch(&self, stop: &TourStop, play: &Play) -> TaskResult {
        let target = self.layout.target_names().find(&stop.name);
        let mut result = TaskResult {
            name: stop.name.clone(),
            kind: TaskKind::Touch,
            is_done: false,
            wrong: 0,
            seconds: 0.0,
            error: None,
        };
        let Some(played) = play.played() else {
            return result;
        };
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

    /// Plays a script with the errors of the person, or without any for `None`.
    fn play(&self, script: &str, seed: Option<u64>) -> Play {
        let document = Document::new("task", script);
        let Ok(parsed) = Script::parse(document, &self.layout.target_names()) else {
            return Play::Impossible;
        };
        let settings = TypistSettings {
            name: "task".to_owned(),
            packet_period: Duration::from_secs_f64(1.0 / self.source.rate_hz()),
            noise: match (seed, self.source) {
                (None, _) | (_, SourceKind::Ideal) => 0.0,
                (_, SourceKind::Camera) => CAMERA_NOISE,
                (_, SourceKind::Glove | SourceKind::MeasuredGlove) => GLOVE_NOISE,
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
        let actions = parsed.actions().iter().cloned();
        let actions: Vec<_> = actions.map(|it| it.placed(&self.layout.fit)).collect();
        match SimulatedTypist::with_hands(&settings, &actions, &self.layout.scene, &hands) {
            Ok(typist) => Play::Played(self.watch(typist)),
            Err(TypistError::Action(error)) if error.kind.is_out_of_reach() => Play::OutOfReach,
            Err(_) => Play::Impossible,
        }
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

fn value_result(control: &Control, face: &Face, goal: Option<f32>, done: &Play) -> TaskResult {
    let (target, done) = (face.target, done.played());
    let is_other = |pressed: &&TargetId| **pressed != target;
    let values = goal.zip(done.and_then(|it| it.last_value(target)));
    TaskResult {
        name: face.name.clone(),
        kind: TaskKind::Value,
        is_done: values.is_some(),
        wrong: done.map_or(0, |it| it.pressed.iter().filter(is_other).count()),
        seconds: done.map_or(0.0, |it| it.seconds),
        error: values.map(|values| difference(&control.kind, values)),
    }
}

/// Returns the difference of two values of a control, as a part of the range or in turns.
fn difference(kind: &ControlKind, (goal, reached): (f32, f32)) -> f64 {
    let apart = f64::from((goal - reached).abs());
    match kind {
        // The value 1 is the value 0 of the next turn.
        ControlKind::ScrollRing(_) => apart.min(1.0 - apart),
        _ => apart,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Layout;

    #[test]
    fn values_of_a_scroll_ring_are_neighbors_across_its_start_and_of_a_slider_are_not() {
        let apart = |name: &str, values: (f32, f32)| {
            let document = Document::shipped(name).expect("a shipped layout");
            let layout = Layout::from_document(document).expect("a layout");
            let mut kinds = layout.controls.iter().map(|control| &control.kind);
            let kind = kinds
                .find(|kind| matches!(kind, ControlKind::ScrollRing(_) | ControlKind::Slider(_)));
            difference(kind.expect("a control"), values)
        };
        let across = (0.98, 0.01);
        assert!((apart("scroll-rings", across) - 0.03).abs() < 1e-6);
        assert!((apart("scroll-rings", (0.2, 0.5)) - 0.3).abs() < 1e-6);
        assert!((apart("mixer", across) - 0.97).abs() < 1e-6);
    }
}

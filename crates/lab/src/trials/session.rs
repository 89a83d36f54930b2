//! A phrase that is being typed: the pipeline, the strokes so far, and the text that they type.

use std::ops::Range;

use parry3d::math::Vec3;

use super::nearest::shown_point;
use super::observed::{Observed, Stroke, StrokeKind};
use super::phrase::Step;
use super::station::Station;
use crate::capture::{Reading, Sample};
use crate::contact::surface::Scene;
use crate::contact::{Phase, TargetId};
use crate::device::{EventKind, Events, KeyCode};
use crate::estimate::JointAngles;
use crate::kinematics::HandPose;
use crate::layout::Layout;
use crate::people::Draw;
use crate::pipeline::{Pipeline, StepOutput};
use crate::readings::{PlaneCrossing, SharedRecorder};
use crate::sim::UsTextField;
use crate::sim::fluent::StrokePlan;
use crate::time::Timestamp;

/// The longest time between the lowest point of a stroke and a press that it causes, in seconds.
const MAX_PRESS_DELAY_S: f64 = 0.15;

/// A press that the pipeline has seen.
struct SeenPress {
    /// The index of the hand.
    hand: usize,
    /// The time in seconds.
    seconds: f64,
    target: TargetId,
    /// The point on the board, in metres; `None` for a press without a touch, such as a bent finger.
    point: Option<Vec3>,
}

/// The state of a phrase that is being typed, and the record of its strokes and presses.
pub(super) struct Session<'a> {
    pub(super) pipeline: Pipeline,
    events: Events,
    pub(super) field: UsTextField,
    pub(super) strokes: Vec<Stroke>,
    presses: Vec<SeenPress>,
    pub(super) keystrokes: usize,
    /// The number of presses of Backspace.
    pub(super) fixes: usize,
    /// The number of events that shortened the text.
    pub(super) fixed: usize,
    pub(super) span: Option<(Timestamp, Timestamp)>,
    pub(super) draw: Draw,
    /// A detector of taps for comparison, which counts each crossing of the plane of a board; `None` without a decoder.
    pub(super) plane: Option<PlaneCrossing>,
    /// The time of the lowest point of the last stroke, in seconds.
    pub(super) bottom: f64,
    /// The time at which the last finger is up, in seconds.
    pub(super) end: f64,
    /// The latest reading, reused because it is large.
    reading: Reading,
    /// The index of the first stroke whose lowest point has not passed.
    first_open: usize,
    /// The record for an observer, if there is one.
    watch: Option<&'a mut Watch>,
}

/// The record of a phrase for an observer, such as the person of the lab that Studio shows.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    /// The readings that entered the pipeline.
    pub readings: Vec<Reading>,
    /// The text after each change, with the time of the reading.
    pub texts: Vec<(Timestamp, String)>,
    /// The strokes with what they pressed, in the order of their lowest points.
    pub strokes: Vec<Stroke>,
}

impl Watch {
    fn record(&mut self, reading: &Reading, text: &str) {
        self.readings.push(reading.clone());
        let last = self.texts.last().map_or("", |(_, last)| last);
        if last != text {
            self.texts.push((reading.time, text.to_owned()));
        }
    }
}

/// Returns a reading without values, to be overwritten.
pub(super) fn no_reading() -> Reading {
    let nothing = Sample::Angles {
        angles: JointAngles::default(),
    };
    Reading::new(Timestamp::default(), None, nothing)
}

impl Station {
    /// Passes the readings of the sensors at a time through the pipeline, and records what it shows and presses.
    pub(super) fn read(
        &mut self,
        session: &mut Session,
        seconds: f64,
        period: f64,
        observed: &mut Observed,
    ) {
        let time = Timestamp((seconds * 1e6).round() as u64);
        session.pass_strokes_before(seconds - period);
        for (index, hand) in self.hands.iter_mut().enumerate() {
            let reading = &mut session.reading;
            if !hand.sample(seconds, period, &mut reading.sample) {
                continue;
            }
            (reading.time, reading.side) = (time, Some(hand.side()));
            observed.readings += 1;
            observed.simulated_seconds += period;
            session.events.clear();
            if let Ok(output) = session.pipeline.step(reading, &mut session.events) {
                let scene = &self.layout.scene;
                let strokes = &mut session.strokes[session.first_open..];
                let now = seconds - period..seconds;
                note_shown_points(strokes, index, &now, scene, &output.pose);
                session.presses.extend(seen_presses(index, output));
                if let Some(plane) = &mut session.plane {
                    let recorder = self.recorder.as_ref().map(SharedRecorder::lock);
                    if let Some(recorder) = recorder {
                        plane.see(scene, recorder.keys(), hand.side(), &output.pose);
                    }
                }
                let start = output.pose.start;
                let is_placed = start.own.is_some() && self.layout.scene.starts_at_hand();
                if is_placed && start != hand.start() {
                    hand.set_start(start);
                }
            }
            session.follow_events();
            if let Some(watch) = &mut session.watch {
                watch.record(&session.reading, session.field.text());
            }
        }
    }
}

/// Notes the points that the pipeline shows for the strokes of a hand whose lowest points are within `now`, in seconds.
fn note_shown_points(
    strokes: &mut [Stroke],
    hand: usize,
    now: &Range<f64>,
    scene: &Scene,
    pose: &HandPose,
) {
    let strokes = strokes.iter_mut();
    let lowest = strokes.filter(|stroke| stroke.hand == hand && now.contains(&stroke.bottom));
    for stroke in lowest {
        stroke.shown = shown_point(scene, stroke, pose);
    }
}

/// Returns the presses of a step of the hand with an index.
fn seen_presses(hand: usize, output: &StepOutput) -> impl Iterator<Item = SeenPress> {
    let touches = output.touches.iter();
    let pressed = touches.filter(|touch| touch.phase == Phase::Pressed);
    pressed.map(move |touch| {
        let press = output.presses.iter().find(|it| it.target == touch.target);
        SeenPress {
            hand,
            seconds: touch.time.0 as f64 * 1e-6,
            target: touch.target,
            point: press.map(|press| press.point),
        }
    })
}

impl<'a> Session<'a> {
    /// Starts a phrase whose first stroke begins after `clear` seconds.
    pub(super) fn new(
        station: &Station,
        seed: u64,
        clear: f64,
        watch: Option<&'a mut Watch>,
    ) -> Self {
        let plane = station.recorder.as_ref();
        Self {
            pipeline: station.pipeline(),
            events: Events::new(),
            field: UsTextField::new(),
            strokes: Vec::new(),
            presses: Vec::new(),
            keystrokes: 0,
            fixes: 0,
            fixed: 0,
            span: None,
            draw: Draw::new(seed, 0x7e57),
            plane: plane.map(|_| PlaneCrossing::new(station.layout.boards.len())),
            bottom: clear,
            end: clear,
            reading: no_reading(),
            first_open: 0,
            watch,
        }
    }

    pub(super) fn add(&mut self, step: &Step, kind: StrokeKind, plan: &StrokePlan) {
        self.bottom = self.bottom.max(plan.bottom);
        self.end = self.end.max(plan.end);
        self.strokes.push(Stroke {
            target: step.targets[0],
            finger: step.finger,
            hand: step.hand,
            kind,
            targets: step.targets.clone(),
            bottom: plan.bottom,
            distance: plan.distance,
            point: plan.point,
            shown: None,
            presses: Vec::new(),
        });
    }

    /// Passes over the strokes whose lowest points are before a time in seconds. The lowest points of strokes ascend.
    fn pass_strokes_before(&mut self, seconds: f64) {
        let has_passed = |stroke: &Stroke| stroke.bottom < seconds;
        while self.strokes.get(self.first_open).is_some_and(has_passed) {
            self.first_open += 1;
        }
    }

    /// Applies the events of the last step to the text, and counts keystrokes and deletions.
    fn follow_events(&mut self) {
        for event in &self.events {
            let length = self.field.text().len();
            self.field.handle(event);
            self.fixes += usize::from(event.kind == EventKind::KeyDown(KeyCode::BACKSPACE));
            self.fixed += usize::from(self.field.text().len() < length);
            if event.kind.is_press() {
                self.keystrokes += 1;
                let first = self.span.map_or(event.time, |(first, _)| first);
                self.span = Some((first, event.time));
            }
        }
    }

    /// At the end of the phrase, attributes each press to the stroke of the same hand that is nearest in time.
    pub(super) fn attribute(&mut self, layout: &Layout) {
        for press in &self.presses {
            let distance = |stroke: &Stroke| (stroke.bottom - press.seconds).abs();
            let own = self.strokes.iter_mut().filter(|it| it.hand == press.hand);
            let nearest = own.min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let Some(stroke) = nearest.filter(|stroke| distance(stroke) <= MAX_PRESS_DELAY_S)
            else {
                continue;
            };
            let meant = layout.scene.target(stroke.target);
            let from_center = meant.zip(press.point).map(|((_, meant), on_board)| {
                let point = meant.surface_from_target.inverse_transform_point(on_board);
                point.truncate()
            });
            stroke
                .presses
                .push((press.target, from_center.unwrap_or_default()));
        }
        if let Some(watch) = &mut self.watch {
            watch.strokes.clone_from(&self.strokes);
        }
    }
}

#[cfg(test)]
mod tests {
    use parry3d::math::Vec2;

    use super::*;
    use crate::document::Document;
    use crate::hand::Finger;
    use crate::people::{People, population};
    use crate::sim::fluent::SourceKind;

    #[test]
    fn a_press_belongs_to_a_stroke_of_its_hand() {
        let document = Document::shipped("qwerty-two-flat").expect("a shipped layout");
        let person = population(&People::Drawn(1), None, 1).remove(0);
        let station = Station::new(&document, &person, SourceKind::Ideal).expect("a person");
        let mut session = Session::new(&station, 1, 0.6, None);
        let stroke = |hand: usize, bottom| Stroke {
            target: TargetId(hand as u32),
            finger: Finger::Index,
            hand,
            kind: StrokeKind::Meant,
            targets: vec![TargetId(hand as u32)],
            bottom,
            distance: 0.0,
            point: Vec2::ZERO,
            shown: None,
            presses: Vec::new(),
        };
        session.strokes = vec![stroke(0, 1.0), stroke(1, 1.06)];
        session.presses.push(SeenPress {
            hand: 0,
            seconds: 1.04,
            target: TargetId(0),
            point: None,
        });
        session.attribute(station.layout());
        assert_eq!(session.strokes[0].presses, [(TargetId(0), Vec2::ZERO)]);
        assert!(session.strokes[1].presses.is_empty());
    }
}

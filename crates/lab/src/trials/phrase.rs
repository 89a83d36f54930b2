//! A person types a phrase.

use std::collections::BTreeMap;

use parry3d::math::{Vec2, Vec3};

use super::observed::{Observed, Stroke, StrokeKind};
use super::station::Station;
use crate::capture::Reading;
use crate::contact::surface::{Shape, Target};
use crate::contact::{Phase, TargetId};
use crate::device::{EventKind, Events};
use crate::hand::Finger;
use crate::layout::Layout;
use crate::people::Draw;
use crate::pipeline::Pipeline;
use crate::sim::fluent::{StrokePlan, Tap};
use crate::sim::{EditCounts, HandAction, UsTextField, taps_for_text, words_per_minute};
use crate::time::Timestamp;

/// The time for which the hand is clear of all keys at the start, in seconds: output is armed after 0.3 s.
const CLEAR: f64 = 0.6;
/// The same on a board that waits for the open hand.
const START: f64 = 2.2;
/// The time after the last stroke, in seconds.
const AFTER: f64 = 0.5;
/// Strokes are planned this long before the one before them is at its lowest point, in seconds.
const AHEAD: f64 = 0.25;
/// The shortest time between two strokes, in seconds.
const APART: f64 = 0.03;
/// The longest time between the lowest point of a stroke and a press that it causes, in seconds.
const CAUSED: f64 = 0.15;
/// The largest distance of a spurious tap from the intended one, in sizes of the key.
const SPURIOUS: f64 = 1.5;
/// Factors for the median time to the next stroke: of the other hand, and of the same finger on another key ?.
const OTHER_HAND: f64 = 0.75;
const SAME_FINGER: f64 = 1.35;

/// The strokes for each character of a layout, as far as a person can make them.
pub struct Strokes {
    known: BTreeMap<char, Vec<Step>>,
    /// The characters that the layout cannot type, each once.
    pub untypable: Vec<char>,
    /// The targets that no finger of the person reaches, each once.
    pub unreached: Vec<TargetId>,
}

impl Strokes {
    /// Returns whether some text can be typed: at least one letter or digit.
    pub fn can_type(&self) -> bool {
        self.known
            .keys()
            .any(|character| character.is_alphanumeric())
    }
}

/// A stroke that is meant.
#[derive(Clone)]
struct Step {
    hand: usize,
    finger: Finger,
    /// One, or more for a chord of fingers that bend.
    targets: Vec<TargetId>,
    is_bent: bool,
}

/// The times of what happens in a phrase.
struct Session {
    pipeline: Pipeline,
    events: Events,
    field: UsTextField,
    strokes: Vec<Stroke>,
    /// The time in seconds, the target, and the place on its board if a fingertip touched it (metres).
    presses: Vec<(f64, TargetId, Option<Vec3>)>,
    keystrokes: usize,
    span: Option<(Timestamp, Timestamp)>,
    draw: Draw,
    /// The time of the lowest point of the last stroke, and when the last finger is up.
    bottom: f64,
    end: f64,
}

impl Station {
    /// Finds the strokes for the characters of phrases.
    pub fn strokes_for<'a>(&mut self, phrases: impl IntoIterator<Item = &'a str>) -> Strokes {
        let mut strokes = Strokes {
            known: BTreeMap::new(),
            untypable: Vec::new(),
            unreached: Vec::new(),
        };
        let bindings = self.layout.key_bindings();
        for character in phrases.into_iter().flat_map(str::chars) {
            if strokes.known.contains_key(&character) || strokes.untypable.contains(&character) {
                continue;
            }
            let text = character.to_string();
            let actions = taps_for_text(&text, &bindings, self.layout.bend_chords());
            let steps = actions.ok().and_then(|actions| {
                let steps = actions.iter().map(|action| self.step(action, &mut strokes));
                steps.collect::<Option<Vec<_>>>()
            });
            match steps {
                Some(steps) => _ = strokes.known.insert(character, steps),
                None => strokes.untypable.push(character),
            }
        }
        strokes
    }

    fn step(&mut self, action: &HandAction, strokes: &mut Strokes) -> Option<Step> {
        let targets = match action {
            HandAction::Chord(targets) => targets.clone(),
            other => vec![other.target()?],
        };
        let hand = self.hand_for(targets[0])?;
        let (surface, _) = self.layout.scene.target(targets[0])?;
        let is_bent = surface.bent_by(targets[0]).is_some();
        let Some(finger) = self.hands[hand].finger_for(&self.layout.scene, targets[0]) else {
            if !strokes.unreached.contains(&targets[0]) {
                strokes.unreached.push(targets[0]);
            }
            return None;
        };
        Some(Step {
            hand,
            finger,
            targets,
            is_bent,
        })
    }

    /// Types a phrase, without the characters for which there are no strokes, and adds what was observed. Returns what was to be typed
    /// and what was typed.
    pub fn type_phrase(
        &mut self,
        phrase: &str,
        strokes: &Strokes,
        seed: u64,
        observed: &mut Observed,
    ) -> (String, String) {
        let is_known = |character: &char| strokes.known.contains_key(character);
        let presented: String = phrase.chars().filter(is_known).collect();
        let steps = presented.chars().flat_map(|it| &strokes.known[&it]);
        let steps: Vec<&Step> = steps.collect();
        for hand in &mut self.hands {
            hand.restart(seed);
        }
        let starts_at_hand = self.layout.scene.starts_at_hand();
        if !starts_at_hand {
            self.start_clear(&steps, strokes);
        }
        let clear = if starts_at_hand { START } else { CLEAR };
        let mut session = Session {
            pipeline: self.pipeline(),
            events: Events::new(),
            field: UsTextField::new(),
            strokes: Vec::new(),
            presses: Vec::new(),
            keystrokes: 0,
            span: None,
            draw: Draw::new(seed, 0x7e57),
            bottom: clear,
            end: clear,
        };
        let period = 1.0 / self.source.rate_hz();
        let mut next = 0;
        for number in 1_u64.. {
            let seconds = number as f64 * period;
            let is_ready = seconds >= clear;
            while is_ready && next < steps.len() && session.bottom <= seconds + AHEAD {
                self.plan(steps[next], &mut session, seconds, observed);
                next += 1;
            }
            self.read(&mut session, seconds, period, observed);
            if next >= steps.len() && seconds > session.end + AFTER {
                break;
            }
        }
        let layout = &self.layout;
        session.attribute(layout);
        observed.add_strokes(&session.strokes, |a, b| are_neighbors(layout, a, b));
        let typed = session.field.text().to_owned();
        let edits = EditCounts::new(&presented, &typed);
        observed.edits.correct += edits.correct;
        observed.edits.substitutions += edits.substitutions;
        observed.edits.insertions += edits.insertions;
        observed.edits.deletions += edits.deletions;
        observed.characters += presented.chars().count();
        observed.keystrokes += session.keystrokes;
        observed.phrases += 1;
        let span = session.span.map(|(first, last)| last.since(first));
        observed.seconds += span.unwrap_or_default().as_secs_f64();
        for hand in &mut self.hands {
            let load = std::mem::take(&mut hand.load);
            observed.load.travel += load.travel;
            observed.load.uncomfortable += load.uncomfortable;
            observed.load.seconds += load.seconds;
        }
        (presented, typed)
    }

    /// Starts with each hand above its first key, or above any of its keys if it has none to press.
    fn start_clear(&mut self, steps: &[&Step], strokes: &Strokes) {
        for index in 0..self.hands.len() {
            let all = strokes.known.values().flatten();
            let mut own = steps.iter().copied().chain(all);
            let first = own.find(|step| step.hand == index && !step.is_bent);
            if let Some(step) = first {
                let scene = &self.layout.scene;
                self.hands[index].start_above(scene, step.targets[0], step.finger);
            }
        }
    }

    /// Passes what the sensors show at a time through the pipeline.
    fn read(&mut self, session: &mut Session, seconds: f64, period: f64, observed: &mut Observed) {
        let time = Timestamp((seconds * 1e6).round() as u64);
        for hand in &mut self.hands {
            let Some(sample) = hand.sample(seconds, period) else {
                continue;
            };
            let reading = Reading::new(time, Some(hand.side()), sample);
            observed.readings += 1;
            observed.simulated_seconds += period;
            session.events.clear();
            if let Ok(output) = session.pipeline.step(&reading, &mut session.events) {
                let pressed = output.touches.iter();
                let pressed = pressed.filter(|touch| touch.phase == Phase::Pressed);
                for touch in pressed {
                    let press = output.presses.iter().find(|it| it.target == touch.target);
                    let place = press.map(|press| press.point);
                    let at = touch.time.0 as f64 * 1e-6;
                    session.presses.push((at, touch.target, place));
                }
                let start = output.pose.start;
                let is_placed = start.own.is_some() && self.layout.scene.starts_at_hand();
                if is_placed && start != hand.start() {
                    hand.set_start(start);
                }
            }
            for event in &session.events {
                session.field.handle(event);
                if matches!(event.kind, EventKind::KeyDown(_) | EventKind::Character(_)) {
                    session.keystrokes += 1;
                    let first = session.span.map_or(event.time, |(first, _)| first);
                    session.span = Some((first, event.time));
                }
            }
        }
    }

    /// Plans a stroke, and perhaps a spurious one after it.
    fn plan(&mut self, step: &Step, session: &mut Session, now: f64, observed: &mut Observed) {
        let factor = match session.strokes.last() {
            Some(last) if last.hand != step.hand => OTHER_HAND,
            Some(last) if last.finger == step.finger && last.target != step.targets[0] => {
                SAME_FINGER
            }
            _ => 1.0,
        };
        let median = self.person.interval() * factor;
        let interval = session.draw.log_normal(median, self.person.interval_cv);
        let wanted = session.bottom + interval.max(APART);
        let is_shallow = session.draw.happens(self.person.missed);
        let kind = match is_shallow {
            true => StrokeKind::Shallow,
            false => StrokeKind::Meant,
        };
        let scene = session.pipeline.layout().scene();
        let hand = &mut self.hands[step.hand];
        let tap = Tap {
            target: step.targets[0],
            finger: step.finger,
            shift: Vec2::ZERO,
            wanted,
            now,
            is_shallow,
        };
        let plan = match step.is_bent {
            true => hand.chord(scene, &step.targets, wanted, now, is_shallow),
            false => hand.tap(scene, tap),
        };
        let Some(plan) = plan else { return };
        let size = self.layout.scene.target(step.targets[0]);
        let width = size.map_or(0.017, |(_, target)| width(target));
        let person = &self.person;
        observed.predicted_seconds += match step.is_bent {
            true => person.fitts_a_ms * 1e-3,
            false => person.movement_time(plan.distance, width),
        };
        let is_followed = !step.is_bent && session.draw.happens(self.person.spurious);
        let reach = (SPURIOUS * width) as f32;
        let shift = Vec2::new(
            session.draw.between(-1.0, 1.0) as f32,
            session.draw.between(-1.0, 1.0) as f32,
        );
        let spurious = Tap {
            shift: shift * reach,
            wanted: plan.end,
            is_shallow: false,
            ..tap
        };
        let hand = &mut self.hands[step.hand];
        let further = is_followed.then(|| hand.tap(scene, spurious)).flatten();
        session.add(step, kind, &plan);
        if let Some(plan) = further {
            session.add(step, StrokeKind::Spurious, &plan);
        }
    }
}

impl Session {
    fn add(&mut self, step: &Step, kind: StrokeKind, plan: &StrokePlan) {
        self.bottom = self.bottom.max(plan.bottom);
        self.end = self.end.max(plan.end);
        self.strokes.push(Stroke {
            target: step.targets[0],
            finger: step.finger,
            hand: step.hand,
            kind,
            keys: step.targets.len(),
            bottom: plan.bottom,
            distance: plan.distance,
            presses: Vec::new(),
        });
    }

    /// Attributes each press to the stroke that is nearest in time.
    fn attribute(&mut self, layout: &Layout) {
        for &(seconds, target, place) in &self.presses {
            let distance = |stroke: &Stroke| (stroke.bottom - seconds).abs();
            let nearest = self
                .strokes
                .iter_mut()
                .min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let Some(stroke) = nearest.filter(|stroke| distance(stroke) <= CAUSED) else {
                continue;
            };
            let meant = layout.scene.target(stroke.target);
            let from_center = meant.zip(place).map(|((_, meant), place)| {
                let place = meant.surface_from_target.inverse_transform_point(place);
                place.truncate()
            });
            stroke
                .presses
                .push((target, from_center.unwrap_or_default()));
        }
    }
}

/// Returns the smaller size of a target, in metres.
fn width(target: &Target) -> f64 {
    f64::from(match target.shape {
        Shape::Box(half) => 2.0 * half.min_element(),
        Shape::Disc(radius) => 2.0 * radius,
    })
}

/// Returns whether two targets of one board are less than half a key apart.
fn are_neighbors(layout: &Layout, a: TargetId, b: TargetId) -> bool {
    let (Some(a), Some(b)) = (layout.face(a), layout.face(b)) else {
        return false;
    };
    let (a, b) = (&a.outline, &b.outline);
    let apart = (a.center - b.center).abs() - a.aabb_half_extents() - b.aabb_half_extents();
    apart.max_element() < 0.5 * a.half_extents().min_element()
}

/// Returns the speed of correct characters in words per minute, of several phrases together.
pub(crate) fn speed(correct: usize, phrases: usize, seconds: f64) -> f64 {
    words_per_minute((correct + 1).saturating_sub(phrases), seconds)
}

//! A person types a phrase.

use std::borrow::Cow;
use std::collections::{BTreeMap, VecDeque};

use parry3d::math::Vec2;

use super::nearest::text_of_nearest_keys;
use super::observed::{Observed, Stroke, StrokeKind};
use super::proofreader::{Decision, Proofreader};
use super::session::{Session, Watch};
use super::station::Station;
use crate::contact::TargetId;
use crate::contact::surface::{Shape, Target};
use crate::hand::Finger;
use crate::layout::Layout;
use crate::measures::KeystrokeClasses;
use crate::readings::{PhraseTaps, PlaneCrossing, plain};
use crate::sim::fluent::Tap;
use crate::sim::{
    EditCounts, HandAction, backspace_of, taps_for_text, word_errors, words_per_minute,
};

/// The time for which the hand is clear of all keys at the start, in seconds: output is armed after 0.3 s.
const CLEAR: f64 = 0.6;
/// The time for which the hand is clear at the start on a board that waits for the open hand, in seconds.
const START: f64 = 2.2;
/// The time after the last stroke, in seconds.
const AFTER: f64 = 0.5;
/// The time by which a stroke is planned before the previous stroke is at its lowest point, in seconds.
const AHEAD: f64 = 0.25;
/// The shortest time between two strokes, in seconds.
const APART: f64 = 0.03;
/// The largest distance of a spurious tap from the intended one, in sizes of the key.
const SPURIOUS: f64 = 1.5;
/// The size of a key for the scatter that the flat lexicon assumes, in metres.
const KEY_SIZE: f32 = 0.017;
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
    /// The stroke that deletes a character.
    backspace: Option<Step>,
}

impl Strokes {
    /// Returns `true` if some text can be typed: at least one letter or digit.
    pub fn can_type(&self) -> bool {
        self.known
            .keys()
            .any(|character| character.is_alphanumeric())
    }

    /// Returns a phrase without the characters that cannot be typed.
    pub fn typable(&self, phrase: &str) -> String {
        let is_known = |character: &char| self.known.contains_key(character);
        phrase.chars().filter(is_known).collect()
    }

    /// Returns the strokes of a typable phrase from a character on, each with the number of characters that are typed after it. A decoder
    /// corrects a word at its end: a space follows with `ends_with_space`, which is not part of the phrase.
    fn steps(
        &self,
        presented: &str,
        first: usize,
        ends_with_space: bool,
    ) -> VecDeque<(usize, &Step)> {
        let known = &self.known;
        let characters = presented.chars().enumerate().skip(first);
        let steps = characters.flat_map(|(index, it)| {
            let own = &known[&it];
            let last = own.len().saturating_sub(1);
            // Shift or a layer has typed nothing yet.
            let numbered = own.iter().enumerate();
            numbered.map(move |(place, step)| (index + usize::from(place == last), step))
        });
        let space = known.get(&' ').filter(|_| ends_with_space);
        let after = presented.chars().count() + 1;
        let space = space.into_iter().flatten().map(|step| (after, step));
        steps.chain(space).collect()
    }
}

/// A stroke that is meant.
#[derive(Clone)]
pub(super) struct Step {
    pub(super) hand: usize,
    pub(super) finger: Finger,
    /// One, or more for a chord of fingers that bend.
    pub(super) targets: Vec<TargetId>,
    is_bent: bool,
}

impl Station {
    /// Finds the strokes for the characters of phrases.
    pub fn strokes_for<'a>(&mut self, phrases: impl IntoIterator<Item = &'a str>) -> Strokes {
        let mut strokes = Strokes {
            known: BTreeMap::new(),
            untypable: Vec::new(),
            unreached: Vec::new(),
            backspace: None,
        };
        if self.person.corrects > 0.0 {
            let backspace = backspace_of(&self.layout);
            strokes.backspace = backspace.and_then(|action| self.step(&action, &mut strokes));
        }
        for character in phrases.into_iter().flat_map(str::chars) {
            if strokes.known.contains_key(&character) || strokes.untypable.contains(&character) {
                continue;
            }
            let text = character.to_string();
            let actions = taps_for_text(&text, &self.layout, self.finds_letters());
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
        self.type_watched(phrase, strokes, seed, observed, None)
    }

    /// Does the same, and keeps what is seen from outside in `watch`.
    pub fn type_watched(
        &mut self,
        phrase: &str,
        strokes: &Strokes,
        seed: u64,
        observed: &mut Observed,
        watch: Option<&mut Watch>,
    ) -> (String, String) {
        let presented = strokes.typable(phrase);
        let length = presented.chars().count();
        let is_decoded = self.recorder.is_some();
        let mut steps = strokes.steps(&presented, 0, is_decoded);
        let first: Vec<&Step> = steps.iter().map(|(_, step)| *step).collect();
        for hand in &mut self.hands {
            hand.restart(seed);
        }
        let starts_at_hand = self.layout.scene.starts_at_hand();
        if !starts_at_hand {
            self.start_clear(&first, strokes);
        }
        let clear = if starts_at_hand { START } else { CLEAR };
        let mut session = Session::new(self, seed, clear, watch);
        let period = 1.0 / self.source.rate_hz();
        let mut reader = Proofreader::new(&presented, &self.person, strokes.backspace.is_some());
        // The strokes that are planned: the time of the lowest point, and the characters that are typed then.
        let mut planned: Vec<(f64, usize)> = Vec::new();
        for number in 1_u64.. {
            let seconds = number as f64 * period;
            let done = planned.iter().rev().find(|(bottom, _)| *bottom < seconds);
            let done = done.map_or(0, |(_, characters)| *characters);
            let times = (seconds, session.end);
            let decision = reader.decide(session.field.text(), times, done, &mut session.draw);
            if let (Decision::Correct { backspaces, from }, Some(step)) =
                (decision, &strokes.backspace)
            {
                steps = strokes.steps(&presented, from, is_decoded);
                for _ in 0..backspaces {
                    steps.push_front((from, step));
                }
            }
            let is_ready = seconds >= clear && decision != Decision::Wait;
            while is_ready && session.bottom <= seconds + AHEAD {
                let Some((typed_then, step)) = steps.pop_front() else {
                    break;
                };
                // The space that is not part of the phrase hits.
                let is_exact = typed_then > length;
                self.plan(step, is_exact, &mut session, seconds, observed);
                reader.note_stroke(session.bottom);
                planned.push((session.bottom, typed_then));
            }
            self.read(&mut session, seconds, period, observed);
            let is_over = steps.is_empty() && decision == Decision::Type;
            if is_over && seconds > session.end + AFTER.max(reader.last_look()) {
                break;
            }
        }
        let typed = self.evaluate(&mut session, &presented, observed);
        (presented, typed)
    }

    /// Adds what was observed of a phrase that has been typed. Returns the typed text.
    fn evaluate(
        &mut self,
        session: &mut Session,
        presented: &str,
        observed: &mut Observed,
    ) -> String {
        let layout = &self.layout;
        session.attribute(layout);
        observed.add_strokes(&session.strokes, |a, b| are_neighbors(layout, a, b));
        let typed = session.field.text().to_owned();
        let nearest = text_of_nearest_keys(layout, &session.strokes, |it| it.point);
        let shown = |stroke: &Stroke| stroke.shown.unwrap_or(stroke.point);
        let shown = text_of_nearest_keys(layout, &session.strokes, shown);
        let meant = self.compared(presented);
        let errors = |text: &str| EditCounts::new(&meant, &self.compared(text)).errors();
        observed.nearest_errors += errors(&nearest);
        observed.shown_errors += errors(&shown);
        let plane = session.plane.take().map(PlaneCrossing::into_text);
        let readings = [nearest, plane.unwrap_or_default()];
        let edits = self.compare(presented, &typed, readings, observed);
        observed.keystrokes += session.keystrokes;
        let classes = KeystrokeClasses::new(&edits, session.fixed, session.fixes);
        observed.keystrokes_by_class.add(classes);
        observed.phrases += 1;
        let span = session.span.map(|(start, last)| last.since(start));
        let seconds = span.unwrap_or_default().as_secs_f64();
        observed.seconds += seconds;
        let characters = meant.chars().count();
        observed.by_phrase.push((edits, characters, seconds));
        for hand in &mut self.hands {
            observed.load.add(std::mem::take(&mut hand.load));
        }
        typed
    }

    /// Returns a text as it is compared: with a decoder, each phrase ends with a space that is not part of it.
    fn compared<'a>(&self, text: &'a str) -> Cow<'a, str> {
        if self.recorder.is_some() {
            plain(text).into()
        } else {
            text.into()
        }
    }

    /// Adds what is wrong in the typed text, and in other readings of the same taps: the nearest keys and plane crossing. Returns the
    /// edits of the typed text.
    fn compare(
        &self,
        presented: &str,
        typed: &str,
        [nearest, plane]: [String; 2],
        observed: &mut Observed,
    ) -> EditCounts {
        let (meant, compared) = (self.compared(presented), self.compared(typed));
        let [words, errors] = word_errors(&meant, &compared);
        observed.words[0] += words;
        observed.words[1] += errors;
        let edits = EditCounts::new(&meant, &compared);
        observed.edits.add(edits);
        observed.characters += meant.chars().count();
        let Some(recorder) = &self.recorder else {
            return edits;
        };
        let mut recorder = recorder.lock();
        let (literal, touches) = recorder.end_phrase();
        let scatter = self.person.deviation_at(Vec2::splat(KEY_SIZE)) * 1e3;
        observed.taps.push(PhraseTaps {
            presented: presented.to_owned(),
            plane,
            nearest,
            literal,
            touches,
            scatter: scatter.element_sum() / 2.0,
            decoded: typed.to_owned(),
        });
        edits
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

    /// Plans a stroke, and perhaps a spurious one after it.
    fn plan(
        &mut self,
        step: &Step,
        is_exact: bool,
        session: &mut Session,
        now: f64,
        observed: &mut Observed,
    ) {
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
        let is_shallow = session.draw.happens(self.person.missed) && !is_exact;
        let kind = if is_shallow {
            StrokeKind::Shallow
        } else {
            StrokeKind::Meant
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
            is_exact,
        };
        let plan = if step.is_bent {
            hand.chord(scene, &step.targets, wanted, now, is_shallow)
        } else {
            hand.tap(scene, tap)
        };
        let Some(plan) = plan else { return };
        let size = self.layout.scene.target(step.targets[0]);
        let width = size.map_or(0.017, |(_, target)| width(target));
        let person = &self.person;
        let shortest = if step.is_bent {
            person.fitts_a_ms * 1e-3
        } else {
            person.movement_time(plan.distance, width)
        };
        // The time of a phrase begins with its first event.
        if !session.strokes.is_empty() {
            observed.predicted_seconds += shortest;
        }
        let is_followed = !step.is_bent && session.draw.happens(self.person.spurious) && !is_exact;
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
        let tapping_hand = &mut self.hands[step.hand];
        let further = is_followed
            .then(|| tapping_hand.tap(scene, spurious))
            .flatten();
        session.add(step, kind, &plan);
        if let Some(spurious_plan) = further {
            session.add(step, StrokeKind::Spurious, &spurious_plan);
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

/// Returns `true` if two targets are on one board, and less than a quarter of the first apart.
fn are_neighbors(layout: &Layout, a: TargetId, b: TargetId) -> bool {
    let found = layout.scene.target(a);
    if found.is_none_or(|(board, _)| board.target(b).is_none()) {
        return false;
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;

    #[test]
    fn neighbors_are_keys_of_one_board() {
        let document = Document::shipped("qwerty-two-flat").expect("a shipped layout");
        let layout = Layout::from_document(document).expect("a layout");
        let keys_of = |board: usize| -> Vec<TargetId> {
            let faces = layout.faces(&layout.boards[board]);
            faces.map(|face| face.target).collect()
        };
        let (left, right) = (keys_of(0), keys_of(1));
        let neighbors_of = |key: TargetId, keys: &[TargetId]| {
            let others = keys.iter().filter(|other| **other != key);
            others
                .filter(|other| are_neighbors(&layout, key, **other))
                .count()
        };
        for key in &left {
            assert!(neighbors_of(*key, &left) > 0, "{key:?}");
            assert_eq!(neighbors_of(*key, &right), 0, "{key:?}");
        }
    }

    #[test]
    fn a_capital_is_typed_after_its_last_stroke_and_not_after_shift() {
        let step = |target| Step {
            hand: 0,
            finger: Finger::Index,
            targets: vec![TargetId(target)],
            is_bent: false,
        };
        let strokes = Strokes {
            known: BTreeMap::from([
                ('a', vec![step(1)]),
                ('A', vec![step(0), step(1)]),
                (' ', vec![step(2)]),
            ]),
            untypable: Vec::new(),
            unreached: Vec::new(),
            backspace: None,
        };
        let typed_after = |first, ends_with_space| {
            let steps = strokes.steps("Aa", first, ends_with_space);
            let steps = steps
                .iter()
                .map(|(typed, stroke)| (*typed, stroke.targets[0].0));
            steps.collect::<Vec<_>>()
        };
        assert_eq!(typed_after(0, false), [(0, 0), (1, 1), (2, 1)]);
        assert_eq!(typed_after(1, true), [(2, 1), (3, 2)]);
    }
}

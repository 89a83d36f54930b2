//! The score of a layout: what each person of a population did on it.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};

use super::keystrokes::KeystrokeClasses;
use crate::contact::TargetId;
use crate::document::Document;
use crate::layout::Layout;
use crate::people::Participant;
use crate::phrases::Corpus;
use crate::readings::{self, Decoding, KeyPlaces, ReadingScore};
use crate::sim::EditCounts;
use crate::sim::fluent::SourceKind;
use crate::trials::{
    Cancelled, KeyTally, Observed, PointingScore, Station, Strokes, TaskKind, TaskResult,
    TasksDone, TrialError, for_each, speed,
};

/// The layout, people and conditions of a score.
#[derive(Clone, Debug)]
pub struct Conditions<'a> {
    /// The layout.
    pub document: &'a Document,
    /// The people.
    pub people: &'a [Participant],
    /// The phrases that they type.
    pub corpus: &'a Corpus,
    /// The number of phrases of each person; each person begins at another one.
    pub phrases: usize,
    /// The sensor that measures their hands.
    pub source: SourceKind,
    /// The seed of all runs.
    pub seed: u64,
    /// The number of threads.
    pub jobs: NonZeroUsize,
}

/// Reason why there is no score.
#[derive(Debug, thiserror::Error)]
pub enum ScoreError {
    /// A person cannot be put in front of the layout.
    #[error(transparent)]
    Trial(#[from] TrialError),
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The figures of one person on a layout.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PersonScore {
    /// The number of the person.
    pub number: u32,
    /// The length of the hand, in millimetres.
    pub hand_mm: f64,
    /// The fingers, as a word.
    pub style: String,
    /// The pace that the person intended, in words per minute: an input.
    pub pace_wpm: f64,
    /// Characters to be typed.
    pub characters: u64,
    /// Characters that are right.
    pub correct: u64,
    /// Characters in place of another one.
    pub substitutions: u64,
    /// Characters too many.
    pub insertions: u64,
    /// Characters that are missing.
    pub deletions: u64,
    /// Wrong characters of the text that the nearest keys of the taps type: what a perfect detection of taps without a decoder
    /// makes. `None` if the layout has chords.
    #[serde(default)]
    pub nearest_errors: Option<u64>,
    /// The errors for the places at which the pipeline shows the fingertip at the lowest point of each stroke: with the errors of
    /// the sensors and of the assumed hand.
    #[serde(default)]
    pub shown_errors: Option<u64>,
    /// Words to be typed.
    #[serde(default)]
    pub words: u64,
    /// The edit distance of the words.
    #[serde(default)]
    pub word_errors: u64,
    /// Words to be typed that the lexicon of the decoder lacks; `None` without a decoder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unknown_words: Option<u64>,
    /// Keys that went down.
    pub keystrokes: u64,
    /// The keystrokes by class; `None` for a person who does not correct.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keystrokes_by_class: Option<KeystrokeClasses>,
    /// Words of correct text per minute.
    pub wpm: f64,
    /// The phrases, in the order in which they were typed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub by_phrase: Vec<PhraseScore>,
    /// The speed of the shortest movements, in words per minute (Fitts's law with the person's own constants).
    pub fitts_wpm: f64,
    /// Strokes that were meant, and those that pressed what was meant.
    pub strokes: u64,
    /// Strokes that pressed their target.
    pub hits: u64,
    /// Presses of a target that touches the meant one.
    pub neighbor_slips: u64,
    /// Turns of all joints for each character, in degrees.
    pub joint_travel_deg: f64,
    /// The part of the time in which a joint was outside its comfortable range, 0..=1.
    pub uncomfortable: f64,
    /// Pairs of strokes on two targets; of these by the same finger, by two hands, by two fingers of a hand, and rolls that change
    /// direction.
    pub pairs: [u64; 5],
    /// Strokes by finger, thumb first.
    pub fingers: [u64; 5],
    /// Seconds that were simulated, of each hand.
    pub simulated_seconds: f64,
    /// Readings that passed through the pipeline.
    pub readings: u64,
    /// The keys.
    pub keys: Vec<KeyScore>,
    /// Presses of other targets than the meant ones.
    pub wrong: Vec<Wrong>,
    /// The tasks, if the layout does not type.
    pub tasks: Vec<TaskScore>,
    /// Clicks on rings of targets, if the layout does not type and has a pointer that the hand can use.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pointing: Option<PointingScore>,
    /// Controls that no finger of the person reaches, of those that the text needs.
    pub unreached: Vec<String>,
    /// Controls that even a hand without errors cannot use in the lab. Their tries do not count.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub untried: Vec<String>,
    /// Characters that the layout cannot type, or that need a control out of reach.
    pub untypable: String,
    /// Readings of the same taps, with a decoder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub text_readings: Vec<ReadingScore>,
}

/// One phrase of one person.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PhraseScore {
    /// Characters to be typed.
    pub characters: u64,
    /// Characters that are right.
    pub correct: u64,
    /// Insertions, deletions and substitutions.
    pub errors: u64,
    /// The time from the first to the last event, in seconds.
    pub seconds: f64,
}

/// A key of one person.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeyScore {
    /// The name.
    pub name: String,
    /// Strokes that meant it.
    pub meant: u64,
    /// Strokes that pressed it.
    pub hit: u64,
    /// Strokes that pressed nothing.
    pub nothing: u64,
    /// The mean place of presses from its center, in millimetres: to the right, away from the wearer.
    pub bias_mm: [f64; 2],
    /// The standard deviation of these places, in millimetres.
    pub spread_mm: [f64; 2],
    /// The number of presses with a place.
    pub places: u64,
}

/// Presses of a target that was not meant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wrong {
    /// The name of what was meant.
    pub meant: String,
    /// The name of what was pressed.
    pub pressed: String,
    /// The number.
    pub count: u64,
}

/// The tasks of one kind on one control.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TaskScore {
    /// The name of the control.
    pub name: String,
    /// The kind.
    pub kind: TaskKind,
    /// Tries.
    pub tries: u64,
    /// Tries that did what they should.
    pub done: u64,
    /// Presses of other controls.
    pub wrong: u64,
    /// The mean time of the tries that did what they should, in seconds; 0 without one.
    pub seconds: f64,
    /// The mean difference from the value, as a part of the range; `None` if no value was set.
    pub error: Option<f64>,
}

/// Scores a layout. `progress` gets the number of people so far.
pub fn score(
    conditions: &Conditions,
    cancel: &AtomicBool,
    progress: impl FnMut(usize),
) -> Result<Vec<PersonScore>, ScoreError> {
    score_decoded(conditions, None, cancel, progress)
}

/// Scores a layout with a text decoder after its devices, and with other readings of the same taps. Texts are compared without capitals,
/// double spaces and punctuation at their end. Each phrase ends with a space.
pub fn score_decoded(
    conditions: &Conditions,
    decoding: Option<&Decoding>,
    cancel: &AtomicBool,
    progress: impl FnMut(usize),
) -> Result<Vec<PersonScore>, ScoreError> {
    let work = |index: usize| one(conditions, decoding, index, cancel);
    let people = conditions.people.len();
    let scores = for_each(people, conditions.jobs, cancel, work, progress)?;
    scores.into_iter().collect()
}

fn one(
    conditions: &Conditions,
    decoding: Option<&Decoding>,
    index: usize,
    cancel: &AtomicBool,
) -> Result<PersonScore, ScoreError> {
    let person = &conditions.people[index];
    let mut station = station(conditions, decoding, person)?;
    let strokes = conditions.strokes(&mut station, decoding);
    let mut observed = Observed::default();
    if strokes.can_type() {
        for (number, phrase) in conditions.phrases_of(person).enumerate() {
            // Typing of one person may take longer than an interrupted program may run.
            if cancel.load(Ordering::Relaxed) {
                return Err(Cancelled.into());
            }
            let seed = conditions.seed_of(person, number);
            station.type_phrase(phrase, &strokes, seed, &mut observed);
        }
    }
    let (tasks, pointing) = if strokes.can_type() {
        (TasksDone::default(), None)
    } else {
        let pointing = station.point(conditions.seed_of(person, 1));
        let seed = conditions.seed_of(person, 0);
        let tasks = station.do_tasks(seed, pointing.is_some(), cancel)?;
        (tasks, pointing)
    };
    let names = station.layout().target_names();
    let unreached = strokes.unreached.iter();
    let unreached = unreached.map(|target| names.get(*target).to_string());
    let untypable: String = strokes.untypable.iter().collect();
    let mut score = from_observed(person, station.layout(), &observed);
    score.tasks = task_scores(tasks.results);
    score.untried = tasks.untried;
    score.pointing = pointing;
    score.text_readings = decoding.map_or_else(Vec::new, |decoding| {
        let keys = KeyPlaces::new(station.layout(), station.finds_letters());
        readings::scores(&observed.taps, &keys, decoding.lexicon)
    });
    score.unknown_words = decoding.map(|decoding| {
        let presented = observed.taps.iter().map(|it| it.presented.as_str());
        let unknown = |it| decoding.lexicon.unknown_words(&readings::plain(it));
        presented.map(unknown).sum()
    });
    score.unreached = unreached.collect();
    score.untypable = untypable;
    Ok(score)
}

/// Creates the station of a person at the layout, with a text decoder if there is one.
pub(super) fn station(
    conditions: &Conditions,
    decoding: Option<&Decoding>,
    person: &Participant,
) -> Result<Station, TrialError> {
    let mut station = Station::new(conditions.document, person, conditions.source)?;
    if let Some(decoding) = decoding
        && !station.set_decoder(decoding.decoder)
    {
        return Err(TrialError::NoLetters);
    }
    Ok(station)
}

impl Conditions<'_> {
    /// Returns the phrases of a person.
    pub(super) fn phrases_of(&self, person: &Participant) -> impl Iterator<Item = &str> {
        let all = &self.corpus.phrases;
        // By the number of the person, which is the same in a part of the people.
        let first = person.number as usize * self.phrases;
        (first..first + self.phrases).map(|place| all[place % all.len()].as_str())
    }

    /// Returns the seed of a phrase of a person.
    pub(super) fn seed_of(&self, person: &Participant, phrase: usize) -> u64 {
        let run = self.seed ^ person.seed.rotate_left(17);
        crate::people::mix(run.wrapping_add(phrase as u64))
    }

    /// Finds the strokes for the characters of the phrases of all people.
    pub(super) fn strokes(&self, station: &mut Station, decoding: Option<&Decoding>) -> Strokes {
        let space = decoding.map(|_| " ");
        let all = self.corpus.phrases.iter();
        station.strokes_for(all.map(String::as_str).chain(space))
    }
}

fn from_observed(person: &Participant, layout: &Layout, observed: &Observed) -> PersonScore {
    let names = layout.target_names();
    let name = |target: &TargetId| names.get(*target).to_string();
    let keys = observed.keys.iter();
    let wrong = observed
        .confusions
        .iter()
        .map(|((meant, pressed), count)| Wrong {
            meant: name(meant),
            pressed: name(pressed),
            count: *count,
        });
    let pairs = observed.pairs;
    let nearest = !layout.scene.has_bend_targets();
    let strokes: u64 = observed.keys.values().map(|key| key.meant).sum();
    PersonScore {
        number: person.number,
        hand_mm: person.hand_mm(),
        style: style(person).to_owned(),
        pace_wpm: person.pace_wpm,
        characters: observed.characters as u64,
        correct: observed.edits.correct as u64,
        substitutions: observed.edits.substitutions as u64,
        insertions: observed.edits.insertions as u64,
        deletions: observed.edits.deletions as u64,
        nearest_errors: nearest.then_some(observed.nearest_errors as u64),
        shown_errors: nearest.then_some(observed.shown_errors as u64),
        words: observed.words[0] as u64,
        word_errors: observed.words[1] as u64,
        keystrokes: observed.keystrokes as u64,
        keystrokes_by_class: (person.corrects > 0.0).then_some(observed.keystrokes_by_class),
        wpm: speed(observed.edits.correct, observed.phrases, observed.seconds),
        by_phrase: observed.by_phrase.iter().map(phrase_score).collect(),
        fitts_wpm: speed(
            observed.characters,
            observed.phrases,
            observed.predicted_seconds,
        ),
        strokes,
        hits: observed.keys.values().map(|key| key.hit).sum(),
        neighbor_slips: observed.neighbor_slips,
        joint_travel_deg: ratio(
            observed.load.travel.to_degrees(),
            observed.characters as f64,
        ),
        uncomfortable: ratio(observed.load.uncomfortable, observed.load.seconds),
        pairs: [
            pairs.all,
            pairs.same_finger,
            pairs.alternating,
            pairs.rolls,
            pairs.redirects,
        ],
        fingers: observed.fingers,
        simulated_seconds: observed.simulated_seconds,
        readings: observed.readings,
        keys: keys
            .map(|(target, tally)| key_score(name(target), tally))
            .collect(),
        wrong: wrong.collect(),
        ..PersonScore::default()
    }
}

fn phrase_score((edits, characters, seconds): &(EditCounts, usize, f64)) -> PhraseScore {
    PhraseScore {
        characters: *characters as u64,
        correct: edits.correct as u64,
        errors: edits.errors() as u64,
        seconds: *seconds,
    }
}

/// Returns one word for the fingers of a person.
fn style(person: &Participant) -> &'static str {
    match person.fingers.len() {
        0 => "layout",
        1 => "index",
        5 => "ten",
        _ => "four",
    }
}

fn key_score(name: String, tally: &KeyTally) -> KeyScore {
    let count = tally.places as f64;
    let mean = tally.sum.map(|sum| ratio(sum, count));
    let spread = std::array::from_fn(|axis| {
        let variance = ratio(tally.squares[axis], count) - mean[axis] * mean[axis];
        variance.max(0.0).sqrt() * 1e3
    });
    KeyScore {
        name,
        meant: tally.meant,
        hit: tally.hit,
        nothing: tally.nothing,
        bias_mm: mean.map(|metres| metres * 1e3),
        spread_mm: spread,
        places: tally.places,
    }
}

pub(super) fn task_scores(results: Vec<TaskResult>) -> Vec<TaskScore> {
    let mut scores: BTreeMap<(String, bool), TaskScore> = BTreeMap::new();
    for result in results {
        let key = (result.name.clone(), result.kind == TaskKind::Value);
        let score = scores.entry(key).or_insert_with(|| TaskScore {
            name: result.name.clone(),
            kind: result.kind,
            tries: 0,
            done: 0,
            wrong: 0,
            seconds: 0.0,
            error: None,
        });
        score.tries += 1;
        score.done += u64::from(result.is_done);
        score.wrong += result.wrong as u64;
        // Sums, until all results are in. A control that is out of reach takes no time.
        if result.is_done {
            score.seconds += result.seconds;
        }
        if let Some(error) = result.error {
            score.error = Some(score.error.unwrap_or_default() + error);
        }
    }
    let mut scores: Vec<TaskScore> = scores.into_values().collect();
    for score in &mut scores {
        score.seconds = ratio(score.seconds, score.done as f64);
        score.error = score.error.map(|sum| ratio(sum, score.done as f64));
    }
    scores
}

/// Returns a quotient; 0 for no divisor.
pub(super) fn ratio(sum: f64, count: f64) -> f64 {
    if count > 0.0 { sum / count } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::people::{People, population};
    use crate::phrases::PhraseSet;

    #[test]
    fn a_cancelled_person_ends_before_the_next_phrase_or_task() {
        let people = population(&People::Drawn(1), None, 0);
        for layout in ["qwerty-flat", "workshop"] {
            let conditions = Conditions {
                document: &Document::shipped(layout).expect("a shipped layout"),
                people: &people,
                corpus: &Corpus::shipped(PhraseSet::En),
                phrases: 2,
                source: SourceKind::Ideal,
                seed: 0,
                jobs: NonZeroUsize::MIN,
            };
            let score = one(&conditions, None, 0, &AtomicBool::new(true));
            assert!(matches!(score, Err(ScoreError::Cancelled(_))), "{layout}");
        }
    }
}

//! One phrase of a person again, to be watched.

use super::score::{Conditions, station};
use crate::capture::Reading;
use crate::kinematics::ArmModel;
use crate::readings::Decoding;
use crate::sim::EditCounts;
use crate::time::Timestamp;
use crate::trials::{Observed, Stroke, StrokeKind, TrialError, Watch};

/// The phrase that a person types worst.
#[derive(Clone, Debug)]
pub struct WatchedPhrase {
    /// The index of the phrase among the phrases of the person.
    pub index: usize,
    /// The text to type.
    pub presented: String,
    /// The typed text.
    pub typed: String,
    /// Insertions, deletions and substitutions.
    pub errors: usize,
    /// The readings that entered the pipeline, of all hands.
    pub readings: Vec<Reading>,
    /// The text after each change, with the time of the reading.
    pub texts: Vec<(Timestamp, String)>,
    /// The strokes that did not press what they meant.
    pub failures: Vec<Failure>,
    /// The arms that the pipeline assumes, the right one first of two.
    pub arms: Vec<ArmModel>,
}

/// A stroke that did not press what it meant.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The time of its lowest point.
    pub time: Timestamp,
    /// The name of what was meant; `None` for a stroke that was not meant.
    pub meant: Option<String>,
    /// The names of what was pressed.
    pub pressed: Vec<String>,
}

/// Simulates a person of a score typing all phrases again, and returns the typed phrase with the most errors; `None` if the layout does
/// not type. The same conditions give the same readings.
///
/// # Errors
/// If the person cannot be put in front of the layout, as for the score.
///
/// # Panics
/// If there is no person with this index.
pub fn watch_worst_phrase(
    conditions: &Conditions,
    decoding: Option<&Decoding>,
    index: usize,
) -> Result<Option<WatchedPhrase>, TrialError> {
    let person = &conditions.people[index];
    let mut station = station(conditions, decoding, person)?;
    let strokes = conditions.strokes(&mut station, decoding);
    if !strokes.can_type() {
        return Ok(None);
    }
    let mut observed = Observed::default();
    let mut worst: Option<WatchedPhrase> = None;
    for (number, phrase) in conditions.phrases_of(person).enumerate() {
        let mut watch = Watch::default();
        let seed = conditions.seed_of(person, number);
        let (presented, typed) =
            station.type_watched(phrase, &strokes, seed, &mut observed, Some(&mut watch));
        let errors = EditCounts::new(&presented, &typed).errors();
        if worst.as_ref().is_some_and(|worst| worst.errors >= errors) {
            continue;
        }
        let names = station.layout().target_names();
        let failure = |stroke: &Stroke| Failure {
            time: Timestamp::from_seconds(stroke.bottom),
            meant: (stroke.kind != StrokeKind::Spurious)
                .then(|| names.get(stroke.target).to_string()),
            pressed: {
                let pressed = stroke.presses.iter();
                pressed
                    .map(|(target, _)| names.get(*target).to_string())
                    .collect()
            },
        };
        let failed = watch.strokes.iter().filter(|stroke| has_failed(stroke));
        worst = Some(WatchedPhrase {
            index: number,
            presented,
            typed,
            errors,
            failures: failed.map(failure).collect(),
            readings: watch.readings,
            texts: watch.texts,
            arms: station.assumed_arms().to_vec(),
        });
    }
    Ok(worst)
}

/// Returns `true` if a stroke pressed something else than it meant, or nothing.
fn has_failed(stroke: &Stroke) -> bool {
    match stroke.kind {
        StrokeKind::Spurious => !stroke.presses.is_empty(),
        StrokeKind::Meant | StrokeKind::Shallow => {
            stroke.presses.len() > stroke.targets.len() || !stroke.has_hit()
        }
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroUsize;
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::document::Document;
    use crate::measures::score;
    use crate::people::{People, Tier, population};
    use crate::phrases::{Corpus, PhraseSet};
    use crate::sim::fluent::SourceKind;

    #[test]
    fn the_watched_phrase_is_one_of_the_score_and_its_failures_are_its_errors() {
        let document = Document::shipped("qwerty-flat").expect("a shipped layout");
        let people = population(&People::Drawn(2), Some(Tier::T2), 3);
        let conditions = Conditions {
            document: &document,
            people: &people,
            corpus: &Corpus::shipped(PhraseSet::En),
            phrases: 2,
            source: SourceKind::Ideal,
            seed: 3,
            jobs: NonZeroUsize::MIN,
        };
        let never = AtomicBool::new(false);
        let scores = score(&conditions, &never, |_| {}).expect("a score");
        let watched = watch_worst_phrase(&conditions, None, 1).expect("a person");
        let watched = watched.expect("the layout types");
        let all = scores[1].errors() as usize;
        assert!(
            (all.div_ceil(2)..=all).contains(&watched.errors),
            "{all} {}",
            watched.errors
        );
        let (_, last) = watched.texts.last().expect("something was typed");
        assert_eq!(*last, watched.typed);
        assert!(!watched.failures.is_empty());
        assert!(watched.failures.iter().all(|it| it.time.0 > 0));
        let times = watched.readings.windows(2);
        assert!(times.into_iter().all(|pair| pair[0].time < pair[1].time));
        assert_eq!(watched.arms.len(), 1);
    }
}

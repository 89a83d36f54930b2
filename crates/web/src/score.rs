//! The score of a layout: a few simulated people type phrases on it, one after the other.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

use ademan_core::document::{Document, DocumentError};
use ademan_core::layout::Layout;
use ademan_lab::measures::{Conditions, PersonScore, ScoreError, score};
use ademan_lab::people::{Participant, People, population};
use ademan_lab::phrases::{Corpus, PhraseSet};
use ademan_lab::sim::fluent::SourceKind;
use serde::Serialize;

use crate::session::NAME;

/// Phrases that each person types.
const PHRASES: usize = 6;

/// The seed of the people and of their errors, as `ademan lab score` has it.
const SEED: u64 = 1;

/// Most people: a browser shows the trend, the program gives the figures.
const MAX_PEOPLE: u32 = 100;

/// People who type on a layout one after the other.
pub struct Scoring {
    document: Document,
    people: Vec<Participant>,
    corpus: Corpus,
    scores: Vec<PersonScore>,
}

/// The score of the people so far.
#[derive(Debug, Serialize)]
pub struct LayoutScore {
    /// People so far.
    pub people: usize,
    /// People in all.
    pub of: usize,
    /// Wrong characters by typed ones, 0 or more: mean, best and worst person.
    pub errors: [f64; 3],
    /// Words of correct text per minute: mean, slowest and fastest person.
    pub wpm: [f64; 3],
    /// Characters that the layout cannot type for somebody.
    pub untypable: String,
    /// The keys, by name.
    pub keys: BTreeMap<String, KeyTotal>,
    /// Tasks that were done and tries, for a layout that types nothing.
    pub tasks: [u64; 2],
}

/// A key of all people.
#[derive(Clone, Debug, Default, Serialize)]
pub struct KeyTotal {
    /// Strokes that meant it.
    pub meant: u64,
    /// Strokes that pressed it.
    pub hit: u64,
    /// Strokes that pressed nothing.
    pub nothing: u64,
    /// Presses of it that meant another key.
    pub wrong: u64,
}

impl Scoring {
    /// Prepares people for a layout. Fails if the layout has faults.
    pub fn new(layout: &str, people: u32) -> Result<Self, DocumentError> {
        let document = Document::new(NAME, layout);
        Layout::from_document(document.clone())?;
        Ok(Self {
            document,
            people: population(&People::Drawn(people.clamp(1, MAX_PEOPLE)), None, SEED),
            corpus: Corpus::shipped(PhraseSet::En),
            scores: Vec::new(),
        })
    }

    /// Simulates the next person. Returns the score of the people so far; `None` after the last one.
    pub fn advance(&mut self) -> Result<Option<LayoutScore>, ScoreError> {
        let next = self.scores.len();
        let Some(person) = self.people.get(next..=next) else {
            return Ok(None);
        };
        let conditions = Conditions {
            document: &self.document,
            people: person,
            corpus: &self.corpus,
            phrases: PHRASES,
            source: SourceKind::Ideal,
            seed: SEED,
            jobs: NonZeroUsize::MIN,
        };
        let scores = score(&conditions, &AtomicBool::new(false), |_| {})?;
        self.scores.extend(scores);
        Ok(Some(self.total()))
    }

    fn total(&self) -> LayoutScore {
        let mut keys = BTreeMap::<String, KeyTotal>::new();
        let mut untypable = String::new();
        let mut tasks = [0; 2];
        for person in &self.scores {
            for own in &person.keys {
                let key = keys.entry(own.name.clone()).or_default();
                key.meant += own.meant;
                key.hit += own.hit;
                key.nothing += own.nothing;
            }
            for wrong in &person.wrong {
                keys.entry(wrong.pressed.clone()).or_default().wrong += wrong.count;
            }
            let new = person.untypable.chars();
            untypable.extend(
                new.filter(|it| !untypable.contains(*it))
                    .collect::<Vec<_>>(),
            );
            for task in &person.tasks {
                tasks = [tasks[0] + task.done, tasks[1] + task.tries];
            }
        }
        LayoutScore {
            people: self.scores.len(),
            of: self.people.len(),
            errors: range(self.scores.iter().map(PersonScore::cer)),
            wpm: range(self.scores.iter().map(|it| it.wpm)),
            untypable,
            keys,
            tasks,
        }
    }
}

/// Returns the mean, the least and the most of values; zeros without values.
fn range(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let values: Vec<f64> = values.collect();
    if values.is_empty() {
        return [0.0; 3];
    }
    [
        values.iter().sum::<f64>() / values.len() as f64,
        values.iter().copied().fold(f64::INFINITY, f64::min),
        values.iter().copied().fold(0.0, f64::max),
    ]
}

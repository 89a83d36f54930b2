//! The search: annealing over states, with the same people and random numbers for all.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};

use super::limits::Limits;
use super::moves::{MoveKind, Moves, NoMoves, State};
use super::objective::{Objective, Reference};
use crate::document::Document;
use crate::layout::Layout;
use crate::measures::{Conditions, PersonScore, ScoreError, score};
use crate::people::{Draw, Participant};
use crate::phrases::Corpus;
use crate::sim::fluent::SourceKind;
use crate::trials::TrialError;

/// States in a row that the limits refuse before the search ends: nothing can move.
const STUCK: u32 = 2_000;
/// The part of the people who try a state first; it is dropped if they do worse.
const FIRST: usize = 3;
/// The highest temperature, as a part of the figure of the original.
const HOT: f64 = 0.01;
/// The part of the steps after which only better states are taken.
const COOL: f64 = 0.6;

/// The objective of a search, and its people.
pub struct Task<'a> {
    /// The original.
    pub document: &'a Document,
    /// The people of the search.
    pub people: &'a [Participant],
    /// The phrases that the people type.
    pub corpus: &'a Corpus,
    /// The phrases of each person.
    pub phrases: usize,
    /// The sensors.
    pub source: SourceKind,
    /// The properties that change.
    pub kinds: &'a [MoveKind],
    /// The names of controls that stay as they are.
    pub keep: &'a [String],
    /// The growth of the outline of a board that is permitted on each side, in metres.
    pub margin: f32,
    /// The figure that counts.
    pub objective: Objective,
    /// States that are tried.
    pub steps: u32,
    /// The seed of the search and of the errors of the people.
    pub seed: u64,
    /// Threads.
    pub jobs: NonZeroUsize,
}

/// The state of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// States that were tried.
    pub step: u32,
    /// States that are to be tried.
    pub steps: u32,
    /// The gain of the best one with the people of the search.
    pub gain: f64,
}

/// States that were not tried, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refused {
    /// Controls overlap, or a number is out of its range.
    pub invalid: u64,
    /// Outside the outline of a board, or boards share space.
    pub outline: u64,
    /// Better, but a person does not reach a control.
    pub reach: u64,
}

/// The best layout of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The text; the original if nothing is better.
    pub text: String,
    /// Numbers and keys that differ from the original.
    pub changes: (usize, usize),
    /// The gain with the people of the search.
    pub gain: f64,
    /// States that were tried.
    pub tried: u32,
    /// States that were not.
    pub refused: Refused,
    /// `true` if the search was cancelled.
    pub is_cancelled: bool,
}

/// Reason why a search cannot start.
#[derive(Debug, thiserror::Error)]
pub enum ImproveError {
    /// Nothing can change.
    #[error(transparent)]
    NoMoves(#[from] NoMoves),
    /// The original cannot be scored.
    #[error(transparent)]
    Score(#[from] ScoreError),
    /// A text cannot be edited.
    #[error("cannot edit the layout: {0}")]
    Edit(#[from] crate::editing::EditError),
    /// Effort of tasks is not measured.
    #[error("the layout is scored by tasks, whose effort is not measured; use speed or errors")]
    Effort,
    /// No simulated person can use the original layout.
    #[error("nobody can use the layout: it has no control within reach")]
    Nobody,
    /// The search was interrupted before the original was scored.
    #[error("interrupted before the original was scored")]
    Cancelled,
}

impl From<TrialError> for ImproveError {
    fn from(error: TrialError) -> Self {
        Self::Score(error.into())
    }
}

/// A search that runs.
struct Search<'a> {
    task: &'a Task<'a>,
    moves: Moves,
    limits: Limits,
    reference: Reference,
    /// The results of the people on the original.
    original: Vec<PersonScore>,
    cancel: &'a AtomicBool,
    refused: Refused,
}

/// A state, its text, and what the people did on it.
#[derive(Clone)]
struct Tried {
    state: State,
    text: String,
    scores: Vec<PersonScore>,
}

/// Searches for a layout on which people do better. `progress` is called after each state that was tried. A search that is cancelled
/// returns the best so far.
pub fn improve(
    task: &Task,
    cancel: &AtomicBool,
    mut progress: impl FnMut(Progress),
) -> Result<Found, ImproveError> {
    let moves = Moves::new(task.document, task.kinds, task.keep, &task.corpus.phrases)?;
    let layout = Layout::from_document(task.document.clone()).map_err(NoMoves::from)?;
    let limits = Limits::new(&layout, task.margin, task.people)?;
    let score_all = |document: &Document, people: &[Participant]| {
        score(&task.conditions(document, people), cancel, |_| {})
    };
    let original = task
        .groups()
        .map(|group| score_all(task.document, group))
        .collect::<Result<Vec<_>, _>>();
    let original = match original {
        Err(ScoreError::Cancelled(_)) => return Err(ImproveError::Cancelled),
        other => other?.concat(),
    };
    if original
        .iter()
        .all(|it| it.characters == 0 && it.tasks.is_empty())
    {
        return Err(ImproveError::Nobody);
    }
    let types = original.iter().any(|it| it.characters > 0);
    if !types && task.objective.speed == 0.0 && task.objective.errors == 0.0 {
        return Err(ImproveError::Effort);
    }
    let mut search = Search {
        task,
        limits,
        reference: Reference::new(&original),
        cancel,
        refused: Refused::default(),
        original: original.clone(),
        moves,
    };
    let first = Tried {
        state: search.moves.start(),
        text: task.document.text.clone(),
        scores: original,
    };
    let (best, tried) = search.run(first, &mut progress)?;
    Ok(Found {
        changes: search.moves.changes(&best.state),
        gain: search.gain(&search.original, &best.scores),
        text: best.text,
        tried,
        refused: search.refused,
        is_cancelled: cancel.load(Ordering::Relaxed),
    })
}

impl Task<'_> {
    fn conditions<'a>(
        &'a self,
        document: &'a Document,
        people: &'a [Participant],
    ) -> Conditions<'a> {
        Conditions {
            document,
            people,
            corpus: self.corpus,
            phrases: self.phrases,
            source: self.source,
            seed: self.seed,
            jobs: self.jobs,
        }
    }

    /// Returns the people who try a state first, and the others.
    fn groups(&self) -> impl Iterator<Item = &[Participant]> {
        let first = self.people.len().div_ceil(FIRST);
        let (first, others) = self.people.split_at(first);
        [first, others]
            .into_iter()
            .filter(|group| !group.is_empty())
    }
}

impl Search<'_> {
    /// Tries states until all steps are done. Returns the best one, and the number of states that were tried.
    fn run(
        &mut self,
        first: Tried,
        progress: &mut impl FnMut(Progress),
    ) -> Result<(Tried, u32), ImproveError> {
        let steps = self.task.steps;
        let mut draw = Draw::new(self.task.seed, 0x1a9e);
        let hot = HOT * self.value(&first.scores).abs().max(1.0);
        let (mut best, mut current) = (first.clone(), first);
        let (mut tried, mut stuck) = (0, 0);
        while tried < steps && stuck < STUCK && !self.cancel.load(Ordering::Relaxed) {
            let (state, step) = self.moves.propose(&current.state, &mut draw);
            let part = f64::from(tried) / f64::from(steps);
            let temperature = hot * (1.0 - part / COOL).max(0.0);
            let Some(text) = self.allowed_text(&state, &current.text)? else {
                stuck += 1;
                self.moves.learn(&mut current.state, step, false);
                continue;
            };
            stuck = 0;
            tried += 1;
            // The loss that is taken this time.
            let loss = -temperature * draw.between(f64::EPSILON, 1.0).ln();
            let scores = self.race(&text, &current.scores, loss)?;
            let is_taken = scores.is_some();
            self.moves.learn(&mut current.state, step, is_taken);
            if let Some(scores) = scores {
                let learned = current.state.clone();
                let is_better = self.value(&scores) > self.value(&best.scores);
                current = Tried {
                    state,
                    text,
                    scores,
                };
                current.state.keep_steps(&learned);
                if is_better {
                    best = current.clone();
                }
            }
            progress(Progress {
                step: tried,
                steps,
                gain: self.gain(&self.original, &best.scores),
            });
        }
        Ok((best, tried))
    }

    fn value(&self, people: &[PersonScore]) -> f64 {
        let people: Vec<&PersonScore> = people.iter().collect();
        self.task.objective.value(&people, &self.reference)
    }

    fn gain(&self, before: &[PersonScore], after: &[PersonScore]) -> f64 {
        self.value(after) - self.value(before)
    }

    /// Returns the text of a state that is a valid layout within the outlines, and not the current one.
    fn allowed_text(
        &mut self,
        state: &State,
        current: &str,
    ) -> Result<Option<String>, ImproveError> {
        let text = self.moves.text(state)?;
        if text == current {
            return Ok(None);
        }
        let document = Document::new(self.task.document.file.as_str(), text.as_str());
        let Ok(layout) = Layout::from_document(document) else {
            self.refused.invalid += 1;
            return Ok(None);
        };
        if !self.limits.allow_shape(&layout) {
            self.refused.outline += 1;
            return Ok(None);
        }
        Ok(Some(text))
    }

    /// Scores a layout with all people, unless the first of them do clearly worse than on the current layout. `None` if it is worse by more
    /// than `loss`, some control is out of reach, or the search is cancelled.
    fn race(
        &mut self,
        text: &str,
        current: &[PersonScore],
        loss: f64,
    ) -> Result<Option<Vec<PersonScore>>, ImproveError> {
        let document = Document::new(self.task.document.file.as_str(), text);
        let mut scores: Vec<PersonScore> = Vec::new();
        for group in self.task.groups() {
            let own = score(&self.task.conditions(&document, group), self.cancel, |_| {});
            match own {
                Ok(own) => scores.extend(own),
                Err(ScoreError::Cancelled(_)) => return Ok(None),
                // A layout that does not fit the hand of a person.
                Err(ScoreError::Trial(_)) => {
                    self.refused.invalid += 1;
                    return Ok(None);
                }
            }
            let is_last = scores.len() == current.len();
            let slack = if is_last {
                0.0
            } else {
                self.noise(current, &scores)
            };
            if self.gain(&current[..scores.len()], &scores) < -loss - slack {
                return Ok(None);
            }
        }
        // Characters that cannot be typed make no errors.
        let characters =
            |people: &[PersonScore]| people.iter().map(|it| it.characters).sum::<u64>();
        let is_reached = characters(&scores) >= characters(&self.original)
            && self.limits.allow_reach(&document)?;
        if !is_reached {
            self.refused.reach += 1;
        }
        Ok(is_reached.then_some(scores))
    }

    /// Returns the standard error of the mean gain of some people.
    fn noise(&self, before: &[PersonScore], after: &[PersonScore]) -> f64 {
        let gains: Vec<f64> = before
            .iter()
            .zip(after)
            .map(|(before, after)| {
                self.gain(std::slice::from_ref(before), std::slice::from_ref(after))
            })
            .collect();
        let count = gains.len() as f64;
        let mean = gains.iter().sum::<f64>() / count;
        let squares: f64 = gains.iter().map(|gain| (gain - mean).powi(2)).sum();
        (squares / (count * (count - 1.0).max(1.0))).sqrt()
    }
}

//! A run in parts, for many machines: a plan, the scores of its shards, and their results together.
//!
//! ```text
//!  Plan ─▶ shard 0: people 0..10 on every layout ─▶ ShardScores ─┐
//!       ─▶ shard 1: people 10..20                ─▶ ShardScores ─┴▶ merge ─▶ LabResult of each layout
//! ```
//!
//! A shard needs the plan only, so shards run in any order, on any machine with the same build. A person does the same in a shard as in
//! a run of all people.

use std::ops::Range;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::measures::{
    Header, LabResult, MAX_PEOPLE, Partial, PersonScore, ReadError, has_possible_counts, summarize,
};
use crate::message::escape_line;
use crate::people::Participant;
use crate::phrases::fnv;

/// The name of the format of a plan.
const PLAN: &str = "ademan-lab-plan";
/// The name of the format of the scores of a shard.
const SHARD: &str = "ademan-lab-shard";
/// The version of both formats.
const VERSION: u32 = 2;

/// The largest number of shards: more files take longer to write than their people to type.
pub const MAX_SHARDS: usize = 10_000;

/// A run in parts: the layouts with all conditions, and the number of parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The name of the format.
    format: String,
    /// The version of the format.
    format_version: u32,
    /// The version of the program.
    program_version: String,
    /// The number of shards, at least 1.
    pub shards: usize,
    /// The number of people, at least one for each shard.
    pub people: usize,
    /// A result without scores for each layout.
    pub runs: Vec<LabResult>,
}

/// The scores of the people of one shard.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShardScores {
    /// The name of the format.
    format: String,
    /// The version of the format.
    format_version: u32,
    /// The version of the program.
    program_version: String,
    /// The hash of the plan.
    plan: String,
    /// The index of the shard.
    shard: usize,
    /// The scores of the people of the shard, for each layout of the plan.
    pub scores: Vec<Vec<PersonScore>>,
}

/// Reason why a plan or the scores of a shard cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShardError {
    /// The file is damaged, or no file of this kind.
    #[error("it cannot be read: {}", escape_line(.0))]
    Unreadable(String),
    /// The file is of another kind, or another version wrote it.
    #[error(transparent)]
    Other(#[from] ReadError),
    /// The shard is one of another plan.
    #[error("it belongs to another plan; remove it, or merge it with its own plan")]
    Foreign,
    /// The file holds another shard, or other people than it should.
    #[error("it does not hold the people of shard {0}; remove it and run the shard again")]
    OtherPeople(usize),
    /// A layout of the plan is used by another number of people than the plan has.
    #[error(
        "its layouts do not have the {0} people of the plan, so the file was changed; create another plan with `ademan lab plan`"
    )]
    OtherCount(usize),
    /// The plan has no people, no layout, or more or fewer shards than it may have.
    #[error(
        "it has no people, no layout or an impossible number of shards; create another plan with `ademan lab plan`"
    )]
    Empty,
}

impl Plan {
    /// Plans runs of `people` people in at most `shards` shards, each of at least one person. `own` is the version of the program.
    pub fn new(runs: Vec<LabResult>, people: usize, shards: usize, own: &str) -> Self {
        Self {
            format: PLAN.to_owned(),
            format_version: VERSION,
            program_version: own.to_owned(),
            shards: shards.clamp(1, people.clamp(1, MAX_SHARDS)),
            people,
            runs,
        }
    }

    /// Returns the indices of the people of a shard, which is below [`shards`](Self::shards).
    pub fn people_of(&self, shard: usize) -> Range<usize> {
        let start = |index: usize| self.people * index / self.shards;
        start(shard)..start(shard + 1)
    }

    /// Returns the hash of the whole plan: FNV-1a, 64 bits, in hexadecimal digits.
    pub fn hash(&self) -> String {
        let text = serde_json::to_string(self).expect("the fields of a plan have names");
        format!("{:016x}", fnv(text.bytes()))
    }

    /// Returns the text of the file.
    pub fn to_json(&self) -> String {
        let text = serde_json::to_string_pretty(self);
        text.expect("the fields of a plan have names") + "\n"
    }

    /// Reads the text of a file that version `own` of the program has written.
    pub fn from_json(text: &str, own: &str) -> Result<Self, ShardError> {
        let plan: Self = read(text, PLAN, own)?;
        for run in &plan.runs {
            run.check()?;
        }
        if plan.people > MAX_PEOPLE as usize {
            return Err(ReadError::TooLarge.into());
        }
        let has_all = |run: &LabResult| run.people.count() as usize == plan.people;
        if !plan.runs.iter().all(has_all) {
            return Err(ShardError::OtherCount(plan.people));
        }
        let is_possible = (1..=MAX_SHARDS.min(plan.people)).contains(&plan.shards);
        if is_possible && !plan.runs.is_empty() {
            Ok(plan)
        } else {
            Err(ShardError::Empty)
        }
    }

    /// Merges the scores of shards, in the order of the shards, into a result for each layout. `participants` are all people of the
    /// plan. If shards are missing, the results cover the people of the other shards and are marked as partial.
    pub fn merge(
        &self,
        participants: &[Participant],
        shards: &[Option<ShardScores>],
    ) -> Vec<LabResult> {
        let missing: Vec<usize> = (0..self.shards)
            .filter(|&index| shards.get(index).is_none_or(Option::is_none))
            .collect();
        let merged = |(index, run): (usize, &LabResult)| {
            let present = shards.iter().flatten();
            let scores: Vec<PersonScore> = present
                .flat_map(|shard| shard.scores[index].iter().cloned())
                .collect();
            let own = scores.iter().filter_map(|score| {
                let position = usize::try_from(score.number).ok()?;
                participants.get(position).cloned()
            });
            LabResult {
                summary: summarize(&scores),
                participants: own.collect(),
                partial: (!missing.is_empty()).then(|| Partial {
                    missing: missing.clone(),
                    shards: self.shards,
                    people: self.people,
                }),
                scores,
                ..run.clone()
            }
        };
        self.runs.iter().enumerate().map(merged).collect()
    }
}

impl ShardScores {
    /// Creates the scores of a shard of a plan.
    pub fn new(plan: &Plan, shard: usize, scores: Vec<Vec<PersonScore>>) -> Self {
        Self {
            format: SHARD.to_owned(),
            format_version: VERSION,
            program_version: plan.program_version.clone(),
            plan: plan.hash(),
            shard,
            scores,
        }
    }

    /// Returns the text of the file.
    pub fn to_json(&self) -> String {
        let text = serde_json::to_string(self);
        text.expect("the fields of scores have names") + "\n"
    }

    /// Reads the text of the file of a shard of a plan.
    pub fn from_json(text: &str, plan: &Plan, shard: usize) -> Result<Self, ShardError> {
        let scores: Self = read(text, SHARD, &plan.program_version)?;
        if scores.plan != plan.hash() {
            return Err(ShardError::Foreign);
        }
        let numbers = plan.people_of(shard);
        let is_complete = |people: &Vec<PersonScore>| {
            let own = people.iter().map(|score| score.number as usize);
            own.eq(numbers.clone())
        };
        let is_whole = scores.shard == shard
            && scores.scores.len() == plan.runs.len()
            && scores.scores.iter().all(is_complete);
        if !is_whole {
            return Err(ShardError::OtherPeople(shard));
        }
        if scores.scores.iter().flatten().all(has_possible_counts) {
            Ok(scores)
        } else {
            Err(ReadError::LargeCount.into())
        }
    }
}

fn read<T: DeserializeOwned>(text: &str, format: &str, own: &str) -> Result<T, ShardError> {
    let unreadable = |error: serde_json::Error| ShardError::Unreadable(error.to_string());
    let header: Header = serde_json::from_str(text).map_err(unreadable)?;
    header.check(format, VERSION, own)?;
    serde_json::from_str(text).map_err(unreadable)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_of_other_people_than_those_of_its_layouts_is_refused() {
        let read = |plan: &Plan| Plan::from_json(&plan.to_json(), "1");
        let runs = || vec![LabResult::unscored(7), LabResult::unscored(7)];
        let plan = Plan::new(runs(), 7, 3, "1");
        assert_eq!(read(&plan), Ok(plan));
        let longer = Plan::new(runs(), 70, 3, "1");
        assert_eq!(read(&longer), Err(ShardError::OtherCount(70)));
        let mut empty = Plan::new(runs(), 7, 3, "1");
        empty.runs.clear();
        assert_eq!(read(&empty), Err(ShardError::Empty));
    }
}

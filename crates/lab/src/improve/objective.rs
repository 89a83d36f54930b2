//! The objective of a search.

use std::str::FromStr;

use crate::measures::{Interval, PersonScore, bootstrap};
use crate::message::escape;

/// The weights of speed, errors and effort in one figure, of which more is better.
///
/// A layout that types: words of correct text per minute, minus wrong characters in percent, minus the effort. A layout that is scored
/// by tasks: tasks that are done per minute, minus tasks that are not done in percent. A task that is not done counts with the mean time of
/// a task that is, so that it raises no speed. The effort is a percentage of the effort on the original layout: half for the turns of all
/// joints for each character, half for the time outside the comfortable range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Objective {
    /// Weight of a word per minute.
    pub speed: f64,
    /// Weight of one percent of wrong characters.
    pub errors: f64,
    /// Weight of one percent of the effort.
    pub effort: f64,
}

/// Reason why a text is not an objective.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ObjectiveError {
    /// A name that is none.
    #[error(
        "unknown objective `{}`; write speed, errors or effort, or weights such as speed=1,errors=2", escape(.0)
    )]
    Name(String),
    /// A weight that is not a number of 0 or more.
    #[error("the weight `{}` is not a number from 0 to 1000", escape(.0))]
    Weight(String),
    /// All weights are 0.
    #[error("all weights are 0; give one of speed, errors and effort a weight")]
    Nothing,
}

/// The largest weight.
const MAX_WEIGHT: f64 = 1_000.0;

impl FromStr for Objective {
    type Err = ObjectiveError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut own = Self {
            speed: 0.0,
            errors: 0.0,
            effort: 0.0,
        };
        for part in text.split(',') {
            let (name, weight) = match part.split_once('=') {
                None => (part, 1.0),
                Some((name, weight)) => {
                    let error = || ObjectiveError::Weight(weight.to_owned());
                    let number: f64 = weight.trim().parse().map_err(|_| error())?;
                    let is_valid = (0.0..=MAX_WEIGHT).contains(&number);
                    (name, is_valid.then_some(number).ok_or_else(error)?)
                }
            };
            match name.trim() {
                "speed" => own.speed = weight,
                "errors" => own.errors = weight,
                "effort" => own.effort = weight,
                other => return Err(ObjectiveError::Name(other.to_owned())),
            }
        }
        let is_nothing = [own.speed, own.errors, own.effort] == [0.0; 3];
        if is_nothing {
            return Err(ObjectiveError::Nothing);
        }
        Ok(own)
    }
}

/// The effort of people on the original layout.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reference {
    travel: f64,
    uncomfortable: f64,
}

impl Reference {
    /// Returns the mean effort of people.
    pub fn new(people: &[PersonScore]) -> Self {
        let count = people.len().max(1) as f64;
        Self {
            travel: people.iter().map(|it| it.joint_travel_deg).sum::<f64>() / count,
            uncomfortable: people.iter().map(|it| it.uncomfortable).sum::<f64>() / count,
        }
    }
}

impl Objective {
    /// Returns the figure of people, or of one.
    pub fn value(&self, people: &[&PersonScore], reference: &Reference) -> f64 {
        let sum = |value: &dyn Fn(&PersonScore) -> f64| people.iter().map(|it| value(it)).sum();
        let ratio = |part: f64, all: f64| if all > 0.0 { part / all } else { 0.0 };
        let count = people.len() as f64;
        let characters: f64 = sum(&|it| it.characters as f64);
        if characters == 0.0 {
            let tries: f64 = sum(&|it| it.tasks.iter().map(|task| task.tries as f64).sum());
            let done: f64 = sum(&|it| it.tasks.iter().map(|task| task.done as f64).sum());
            let times = |it: &PersonScore| {
                let times = it.tasks.iter();
                times.map(|task| task.seconds * task.done as f64).sum()
            };
            let all_seconds = ratio(sum(&times), done) * tries;
            let per_minute = ratio(60.0 * done, all_seconds);
            return self.speed * per_minute - self.errors * 100.0 * (1.0 - ratio(done, tries));
        }
        let speed = ratio(sum(&|it| it.wpm), count);
        let errors = 100.0 * ratio(sum(&|it| it.errors() as f64), characters);
        let travel = ratio(sum(&|it| it.joint_travel_deg), count * reference.travel);
        let uncomfortable = ratio(sum(&|it| it.uncomfortable), count * reference.uncomfortable);
        let effort = if reference.uncomfortable > 0.0 {
            50.0 * (travel + uncomfortable)
        } else {
            100.0 * travel
        };
        self.speed * speed - self.errors * errors - self.effort * effort
    }

    /// Returns by how much the same people do better on a second layout, with the interval over people.
    pub fn gain(
        &self,
        before: &[PersonScore],
        after: &[PersonScore],
        reference: &Reference,
    ) -> Interval {
        let pairs: Vec<(&PersonScore, &PersonScore)> = before.iter().zip(after).collect();
        bootstrap(&pairs, |pairs| {
            let first: Vec<&PersonScore> = pairs.iter().map(|pair| pair.0).collect();
            let second: Vec<&PersonScore> = pairs.iter().map(|pair| pair.1).collect();
            self.value(&second, reference) - self.value(&first, reference)
        })
    }

    /// Returns words for a unit of the figure.
    pub fn unit(&self, types: bool) -> &'static str {
        match (self.speed, self.errors, self.effort, types) {
            (1.0, 0.0, 0.0, true) => "words/min of correct text",
            (1.0, 0.0, 0.0, false) => "tasks/min",
            (0.0, 1.0, 0.0, true) => "points fewer wrong characters",
            (0.0, 1.0, 0.0, false) => "points more tasks done",
            (0.0, 0.0, 1.0, true) => "% less effort",
            _ => "points of the weights",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::TaskScore;
    use crate::trials::TaskKind;

    #[test]
    fn tasks_that_are_not_done_raise_no_speed() {
        let person = |tries, done| PersonScore {
            tasks: vec![TaskScore {
                name: "A".to_owned(),
                kind: TaskKind::Touch,
                tries,
                done,
                wrong: 0,
                seconds: 0.5,
                error: None,
            }],
            ..PersonScore::default()
        };
        let objective: Objective = "speed".parse().expect("a name");
        let value = |tries, done| objective.value(&[&person(tries, done)], &Reference::default());
        assert_eq!(value(4, 4), 120.0);
        assert_eq!(value(4, 2), 60.0);
        assert_eq!(value(4, 0), 0.0);
    }

    #[test]
    fn an_objective_is_a_name_or_weights() {
        let weights = |text: &str| text.parse::<Objective>();
        let parsed = weights("speed=1, errors=2.5").expect("weights");
        assert_eq!(
            (parsed.speed, parsed.errors, parsed.effort),
            (1.0, 2.5, 0.0)
        );
        assert_eq!(weights("effort").expect("a name").effort, 1.0);
        for (text, words) in [
            ("sped", "unknown objective `sped`"),
            ("speed=x", "the weight `x`"),
            ("speed=-1", "the weight `-1`"),
            ("speed=NaN", "the weight `NaN`"),
            ("speed=0", "all weights are 0"),
            ("", "unknown objective"),
        ] {
            let error = weights(text).expect_err(text).to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}

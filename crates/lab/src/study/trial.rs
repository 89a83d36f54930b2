//! A trial of a participant.

use serde::{Deserialize, Serialize};

use crate::measures::{KeystrokeClasses, PointingResult};
use crate::sim::{EditCounts, TypingScore};

/// The kind of a trial.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TrialKind {
    /// A phrase of the study.
    Phrase,
    /// A ring of targets.
    Targets,
    /// A value of a slider or knob.
    Value,
    /// A practice session, with a text of its own.
    #[default]
    Practice,
}

impl TrialKind {
    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Phrase => "phrase",
            Self::Targets => "targets",
            Self::Value => "value",
            Self::Practice => "practice",
        }
    }
}

/// The outcome of a trial of a participant. Numbers that a kind of trial does not have are `None`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The pseudonym.
    pub participant: String,
    /// The number of trials of the participant before.
    pub order: usize,
    /// The name of the layout.
    pub layout: String,
    /// The kind.
    pub kind: TrialKind,
    /// The index of the task on its layout; `None` for practice.
    pub task: Option<usize>,
    /// The time of its end, in UTC.
    pub time: String,
    /// `true` if a simulated hand did the trial.
    pub is_simulated: bool,
    /// The version of the program.
    pub program_version: String,
    /// The time from the first to the last event, in seconds.
    pub seconds: f64,
    /// The text to type; absent for practice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub presented: Option<String>,
    /// The text that was typed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub typed: Option<String>,
    /// Characters to be typed.
    pub characters: Option<usize>,
    /// Characters in place of another one.
    pub substitutions: Option<usize>,
    /// Characters too many.
    pub insertions: Option<usize>,
    /// Characters that are missing.
    pub deletions: Option<usize>,
    /// Keys that went down.
    pub keystrokes: Option<usize>,
    /// The presses of Backspace among them.
    pub backspaces: Option<usize>,
    /// Characters that were deleted again.
    pub deleted: Option<usize>,
    /// Words of correct text per minute.
    pub wpm: Option<f64>,
    /// The clicks on a ring.
    pub pointing: Option<PointingResult>,
    /// The value that was to be set, and the one that was.
    pub value: Option<[f64; 2]>,
    /// The file of the recording beside the trial, if there is one.
    pub recording: Option<String>,
}

impl Trial {
    /// Sets the figures of a typed text.
    pub fn set_typing(&mut self, score: &TypingScore) {
        let edits = score.edits;
        self.characters = Some(score.presented.chars().count());
        self.substitutions = Some(edits.substitutions);
        self.insertions = Some(edits.insertions);
        self.deletions = Some(edits.deletions);
        self.wpm = Some(score.words_per_minute);
        self.presented = Some(score.presented.clone());
        self.typed = Some(score.typed.clone());
    }

    /// Returns insertions, deletions and substitutions by presented characters.
    pub fn cer(&self) -> Option<f64> {
        let errors = self.substitutions? + self.insertions? + self.deletions?;
        let characters = self.characters.filter(|it| *it > 0)?;
        Some(errors as f64 / characters as f64)
    }

    /// Returns the number of characters of the typed text.
    pub fn transcribed(&self) -> Option<usize> {
        Some((self.characters? + self.insertions?).saturating_sub(self.deletions?))
    }

    /// Returns keystrokes by transcribed characters (Soukoreff & MacKenzie 2003).
    pub fn kspc(&self) -> Option<f64> {
        let characters = self.transcribed().filter(|it| *it > 0)?;
        Some(self.keystrokes? as f64 / characters as f64)
    }

    /// Returns the keystrokes by class.
    pub fn keystrokes_by_class(&self) -> Option<KeystrokeClasses> {
        let (substitutions, deletions) = (self.substitutions?, self.deletions?);
        let edits = EditCounts {
            correct: self.characters?.saturating_sub(substitutions + deletions),
            substitutions,
            insertions: self.insertions?,
            deletions,
        };
        Some(KeystrokeClasses::new(
            &edits,
            self.deleted?,
            self.backspaces?,
        ))
    }

    /// Returns the difference from the value that was to be set.
    pub fn value_error(&self) -> Option<f64> {
        self.value.map(|[goal, set]| (set - goal).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(counts: &str) -> Trial {
        let text = format!(
            "{{\"participant\":\"P01\",\"order\":0,\"layout\":\"board\",\"kind\":\"phrase\",\"task\":0,\"time\":\"\",\
             \"is_simulated\":false,\"program_version\":\"\",\"seconds\":1.0{counts}}}"
        );
        serde_json::from_str(&text).expect("a trial")
    }

    #[test]
    fn the_keystrokes_of_a_trial_have_classes_if_they_were_counted() {
        let edits = ",\"characters\":20,\"substitutions\":1,\"insertions\":0,\"deletions\":2";
        let counted = trial(&format!("{edits},\"backspaces\":4,\"deleted\":3"));
        let expected = KeystrokeClasses {
            correct: 17,
            not_fixed: 3,
            fixed: 3,
            fixes: 4,
        };
        assert_eq!(counted.keystrokes_by_class(), Some(expected));
        assert_eq!(trial(edits).keystrokes_by_class(), None);
    }
}

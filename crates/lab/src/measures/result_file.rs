//! Result files: the conditions of a run, and its figures.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::compare::Comparison;
use super::score::PersonScore;
use super::summary::Summary;
use crate::message::{escape, escape_line};
use crate::people::Participant;
use crate::phrases::Corpus;

/// The name of the format.
pub const FORMAT: &str = "ademan-lab-result";
/// The version of the format.
const VERSION: u32 = 2;

/// The most people of a run: more give no narrower interval that matters.
pub const MAX_PEOPLE: u32 = 100_000;
/// The most phrases of each person.
const MAX_PHRASES: usize = u16::MAX as usize;

/// The largest count in a file: sums over all people stay far below the largest number.
const MAX_COUNT: u64 = 1 << 32;

/// The hash of phrases, in hexadecimal digits.
pub type CorpusHash = String;

/// The people who typed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PeopleSpec {
    /// A number of people of the general population.
    Drawn(u32),
    /// A person of a file, with a number of repetitions.
    Person {
        /// The file, as its user named it.
        file: String,
        /// The text of the file.
        text: String,
        /// The number of repetitions.
        count: u32,
    },
}

impl PeopleSpec {
    /// Returns the number of people.
    pub fn count(&self) -> u32 {
        let (Self::Drawn(count) | Self::Person { count, .. }) = self;
        *count
    }
}

/// A run and its results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LabResult {
    /// The name of the format.
    pub format: String,
    /// The version of the format.
    pub format_version: u32,
    /// The version of the program.
    pub program_version: String,
    /// The file of the layout, as its user named it.
    pub layout_file: String,
    /// The text of the layout.
    pub layout: String,
    /// The people who typed.
    pub people: PeopleSpec,
    /// The tier; `None` for the errors of the people.
    pub tier: Option<String>,
    /// The sensor that measured their hands.
    pub source: String,
    /// The mode and the language of the text decoder, if there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decoder: Option<String>,
    /// The probability that a person corrects an error.
    #[serde(default)]
    pub corrections: f64,
    /// The seed.
    pub seed: u64,
    /// Phrases of each person.
    pub phrases: usize,
    /// The name of the corpus.
    pub corpus: String,
    /// The hash of the corpus.
    pub corpus_hash: CorpusHash,
    /// The phrases of the corpus.
    pub corpus_phrases: Vec<String>,
    /// The figures of all people.
    pub summary: Summary,
    /// The figures of each person.
    pub scores: Vec<PersonScore>,
    /// The people with all their parameters.
    pub participants: Vec<Participant>,
    /// The comparison with another layout, if there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Comparison>,
    /// The shards that are missing, if this is the result of a part of the people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub partial: Option<Partial>,
}

/// The part that is missing in a result of some of the people.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Partial {
    /// The indices of the shards without scores.
    pub missing: Vec<usize>,
    /// The number of shards of the plan.
    pub shards: usize,
    /// The number of people of the plan.
    pub people: usize,
}

/// The reason why a result file cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReadError {
    /// The file is not JSON of this form.
    #[error("this is not a lab file of the expected kind: {}", escape_line(.0))]
    NoResult(String),
    /// The file has another version of the format.
    #[error(
        "it has version {found} of the format, and this program reads version {VERSION}; run the lab again"
    )]
    OtherFormat {
        /// The version of the file.
        found: u32,
    },
    /// Another version of the program wrote it.
    #[error(
        "version {} of the program wrote it, and this is {own}, which may give other figures; run the lab again",
        escape(.found)
    )]
    OtherProgram {
        /// The version of the program that wrote the file.
        found: String,
        /// The version of this program.
        own: String,
    },
    /// The phrases do not have their hash.
    #[error("its phrases do not have the hash {}, so the file was changed; create it again", escape(.0))]
    OtherCorpus(String),
    /// There are no phrases.
    #[error("it has no phrase, so the file was changed; create it again")]
    NoPhrase,
    /// The run has more people or phrases than any run of the program.
    #[error(
        "it has more people or phrases than a run may have, {MAX_PEOPLE} and {MAX_PHRASES}, so the file was changed; create it again"
    )]
    TooLarge,
    /// A count is larger than any run gives.
    #[error(
        "it has a count above {MAX_COUNT}, which no run reaches, so the file was changed; create it again"
    )]
    LargeCount,
}

/// Returns `true` if no whole number in what was read from a file is larger than any count, so that sums of them do not overflow.
pub fn has_possible_counts(read: &impl Serialize) -> bool {
    serde_json::to_value(read).is_ok_and(|value| is_possible(&value))
}

fn is_possible(value: &Value) -> bool {
    match value {
        Value::Number(number) => number.as_u64().is_none_or(|count| count <= MAX_COUNT),
        Value::Array(values) => values.iter().all(is_possible),
        Value::Object(fields) => fields.values().all(is_possible),
        Value::Null | Value::Bool(_) | Value::String(_) => true,
    }
}

/// The first fields of a file, to tell the reason why the others do not fit.
#[derive(Deserialize)]
pub(crate) struct Header {
    format: String,
    format_version: u32,
    program_version: String,
}

impl Header {
    /// Checks that version `own` of the program has written the file, in a version of a format.
    pub(crate) fn check(self, format: &str, version: u32, own: &str) -> Result<(), ReadError> {
        if self.format != format {
            return Err(ReadError::NoResult(format!("its format is not `{format}`")));
        }
        if self.format_version != version {
            return Err(ReadError::OtherFormat {
                found: self.format_version,
            });
        }
        if self.program_version != own {
            return Err(ReadError::OtherProgram {
                found: self.program_version,
                own: own.to_owned(),
            });
        }
        Ok(())
    }
}

impl LabResult {
    /// Returns the version of the format.
    pub fn format_version() -> u32 {
        VERSION
    }

    /// Returns the hash of a corpus, as results state it.
    pub fn hash_of(corpus: &Corpus) -> CorpusHash {
        format!("{:016x}", corpus.hash())
    }

    /// Returns the corpus.
    pub fn corpus(&self) -> Corpus {
        Corpus {
            name: self.corpus.clone(),
            phrases: self.corpus_phrases.clone(),
        }
    }

    /// Returns `true` if the scores are repetitions of one person, over which the intervals are.
    pub fn is_repeated(&self) -> bool {
        matches!(self.people, PeopleSpec::Person { .. }) && self.scores.len() > 1
    }

    /// Returns the people with scores as words, such as `20 simulated people`.
    pub fn subjects(&self) -> String {
        let count = self.scores.len();
        if self.is_repeated() {
            format!("{count} repetitions of one simulated person")
        } else if count == 1 {
            "1 simulated person".to_owned()
        } else {
            format!("{count} simulated people")
        }
    }

    /// Returns the text of the file.
    pub fn to_json(&self) -> String {
        let text = serde_json::to_string_pretty(self);
        text.expect("the fields of a result have names") + "\n"
    }

    /// Reads the text of a file that version `own` of the program has written.
    pub fn from_json(text: &str, own: &str) -> Result<Self, ReadError> {
        let no_result = |error: serde_json::Error| ReadError::NoResult(error.to_string());
        let header: Header = serde_json::from_str(text).map_err(no_result)?;
        header.check(FORMAT, VERSION, own)?;
        let result: Self = serde_json::from_str(text).map_err(no_result)?;
        result.check()?;
        Ok(result)
    }

    /// Checks that there are phrases, that they have their hash, and that neither the run nor a count is too large.
    pub(crate) fn check(&self) -> Result<(), ReadError> {
        if self.people.count() > MAX_PEOPLE || self.phrases > MAX_PHRASES {
            return Err(ReadError::TooLarge);
        }
        if !self.scores.iter().all(has_possible_counts) {
            return Err(ReadError::LargeCount);
        }
        // People take their phrases from the corpus in turn.
        if self.corpus_phrases.is_empty() {
            return Err(ReadError::NoPhrase);
        }
        if Self::hash_of(&self.corpus()) == self.corpus_hash {
            Ok(())
        } else {
            Err(ReadError::OtherCorpus(self.corpus_hash.clone()))
        }
    }
}

#[cfg(test)]
impl LabResult {
    /// Returns a result without scores.
    pub(crate) fn unscored(people: u32) -> Self {
        let corpus = Corpus::shipped(crate::phrases::PhraseSet::Digits);
        Self {
            format: FORMAT.to_owned(),
            format_version: VERSION,
            program_version: "1".to_owned(),
            layout_file: "numpad".to_owned(),
            layout: String::new(),
            people: PeopleSpec::Drawn(people),
            tier: None,
            source: "ideal".to_owned(),
            decoder: None,
            corrections: 0.0,
            seed: 0,
            phrases: 1,
            corpus_hash: Self::hash_of(&corpus),
            corpus: corpus.name,
            corpus_phrases: corpus.phrases,
            summary: super::summary::summarize(&[]),
            scores: Vec::new(),
            participants: Vec::new(),
            comparison: None,
            partial: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_whose_phrases_were_changed_or_removed_is_refused() {
        let whole = LabResult::unscored(3);
        let read = |result: &LabResult| LabResult::from_json(&result.to_json(), "1");
        assert_eq!(read(&whole), Ok(whole.clone()));
        let mut changed = whole.clone();
        changed.corpus_phrases.pop();
        let hash = whole.corpus_hash.clone();
        assert_eq!(read(&changed), Err(ReadError::OtherCorpus(hash)));
        // The hash of no phrases is no secret.
        changed.corpus_phrases.clear();
        changed.corpus_hash = LabResult::hash_of(&changed.corpus());
        assert_eq!(read(&changed), Err(ReadError::NoPhrase));
        let crowded = LabResult::unscored(MAX_PEOPLE + 1);
        assert_eq!(read(&crowded), Err(ReadError::TooLarge));
    }

    #[test]
    fn a_result_whose_counts_cannot_be_added_is_refused() {
        let read = |count: u64| {
            let score = PersonScore {
                keystrokes: count,
                wpm: 1e300,
                ..PersonScore::default()
            };
            let mut result = LabResult::unscored(1);
            result.scores.push(score);
            LabResult::from_json(&result.to_json(), "1").map(drop)
        };
        assert_eq!(read(MAX_COUNT), Ok(()));
        assert_eq!(read(MAX_COUNT + 1), Err(ReadError::LargeCount));
        assert_eq!(read(u64::MAX), Err(ReadError::LargeCount));
    }

    #[test]
    fn what_a_file_states_begins_no_line_of_a_message() {
        let forged = "1\nerror: forged";
        let whole = LabResult::unscored(1);
        let other_program = LabResult {
            program_version: forged.to_owned(),
            ..whole.clone()
        };
        let other_corpus = LabResult {
            corpus_hash: forged.to_owned(),
            ..whole.clone()
        };
        let texts = [
            other_program.to_json(),
            other_corpus.to_json(),
            whole
                .to_json()
                .replace("\"drawn\"", "\"1\\nerror: forged\""),
        ];
        for text in texts {
            let refused = LabResult::from_json(&text, "1").expect_err("a refusal");
            let refused = refused.to_string();
            assert!(refused.contains("error: forged"), "{refused}");
            assert!(!refused.contains('\n'), "{refused}");
        }
    }
}

//! Knowledge of a text decoder about a person, as a file keeps it.

mod values;

use std::fmt::Write;

use ademan_core::document::{
    Document, DocumentError, Format, Structure, Table, first_error, schema, tables_of,
};
use ademan_core::message::escape;
use ademan_core::pipeline::PressFilter;
use serde::{Deserialize, Serialize};

use super::text_filter::TextFilter;
use crate::correction::Restored;
use crate::touch::{ErrorSums, KeySums, TouchModel};
use crate::{Corrector, Prior};

pub use values::{LearnedErrors, LearnedKey, LearnedPairs, LearnedTaps};

/// The most that learned taps count for, so that a sensor that sits elsewhere today is learned within a few sentences.
const MAX_TAPS: f32 = 200.0;
/// The most words and keys of a file, and the most bytes of a word.
const MAX_WORDS: usize = 512;
const MAX_KEYS: usize = 256;
const MAX_BYTES: usize = 64;
/// The fewest taps on a key that are kept.
const MIN_KEY_TAPS: f32 = 0.5;

schema! {
    /// Knowledge of the text decoder about a person.
    #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "Learned", default, deny_unknown_fields)]
    pub struct Learned {
        /// Words that are never changed, and that taps may mean, as they are written inside a sentence: at most 512, each of 1 to 64
        /// bytes without a space.
        pub words: Vec<String>,
        /// The taps on all keys but the space bar. They count for at most 200 taps.
        pub person: LearnedTaps,
        /// The taps on each key, at most 256 keys.
        pub keys: Vec<LearnedKey>,
        /// The errors of the person.
        pub errors: LearnedErrors,
        /// Successive taps of different hands.
        pub other_hand: LearnedPairs,
        /// Successive taps of one hand.
        pub same_hand: LearnedPairs,
    }
}

const FORMAT: Format = Format {
    name: "Learned",
    remedy: "; `ademan ctl save-learned` writes one",
    reread: |text| first_error::<Learned>(text),
    structures: || {
        vec![
            Structure::of::<Learned>("Learned"),
            Structure::of::<LearnedTaps>("person"),
            Structure::of::<LearnedKey>("keys"),
            Structure::of::<LearnedErrors>("errors"),
            Structure::of::<LearnedPairs>("other_hand"),
            Structure::of::<LearnedPairs>("same_hand"),
        ]
    },
};

/// Knowledge about a person in a few numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LearnedSummary {
    /// The taps, with their mean distance from the centers of keys and their standard deviation.
    pub taps: LearnedTaps,
    /// The number of the person's words.
    pub words: usize,
}

impl Learned {
    /// Reads a file. Fails for values outside their ranges. An error shows no line of the file, and no word: the person has typed them.
    pub fn parse(document: &Document) -> Result<Self, DocumentError> {
        Self::checked(document).map_err(DocumentError::without_excerpts)
    }

    fn checked(document: &Document) -> Result<Self, DocumentError> {
        let learned: Self = document.parse_as(&FORMAT)?;
        // Without a line: the values have lost theirs.
        let error = |message: String| DocumentError::for_file(&document.file, message);
        if learned.words.len() > MAX_WORDS || learned.keys.len() > MAX_KEYS {
            return Err(error(format!(
                "there are more than {MAX_WORDS} words or {MAX_KEYS} keys; remove some"
            )));
        }
        let is_word = |word: &&String| {
            !word.is_empty()
                && word.len() <= MAX_BYTES
                && !word.contains(|it: char| it.is_whitespace() || it.is_control())
        };
        if let Some(index) = learned.words.iter().position(|word| !is_word(&word)) {
            return Err(error(format!(
                "word {} of `words` is not used: a word has 1 to {MAX_BYTES} bytes and no space",
                index + 1
            )));
        }
        learned
            .person
            .check()
            .and_then(|()| learned.errors.check())
            .and_then(|()| learned.other_hand.check())
            .and_then(|()| learned.same_hand.check())
            .map_err(|message| error(message.to_owned()))?;
        for key in &learned.keys {
            let name = escape(&key.key);
            if key.key.chars().count() != 1 {
                return Err(error(format!("the key `{name}` is not one character")));
            }
            let numbers = key.numbers().check();
            numbers.map_err(|message| error(format!("the key `{name}`: {message}")))?;
        }
        Ok(learned)
    }

    /// Adds the words of another layout of the same person, as long as there is room.
    pub fn add_words(&mut self, other: Self) {
        let mut words = Restored::from(std::mem::take(&mut self.words));
        other.words.iter().for_each(|word| words.add(word));
        self.words = words.into();
    }

    /// Returns the text of a file.
    pub fn to_ron(&self) -> String {
        let mut text = String::from(
            "// Learned of a person by the text decoder. `ademan ctl save-learned` writes it, `--learned FILE` reads it.\nLearned(\n    words: [",
        );
        for word in &self.words {
            let _ = write!(text, "\n        {word:?},");
        }
        text.push_str(if self.words.is_empty() {
            "],\n    person: ("
        } else {
            "\n    ],\n    person: ("
        });
        self.person.write(&mut text);
        text.push_str("),\n    keys: [");
        for key in &self.keys {
            let _ = write!(text, "\n        (key: {:?}, ", key.key);
            key.numbers().write(&mut text);
            text.push_str("),");
        }
        text.push_str(if self.keys.is_empty() {
            "],\n"
        } else {
            "\n    ],\n"
        });
        let LearnedErrors {
            taps,
            spurious,
            missed,
            swapped,
        } = self.errors;
        let _ = writeln!(
            text,
            "    errors: (taps: {taps:.1}, spurious: {spurious:.2}, missed: {missed:.2}, swapped: {swapped:.2}),"
        );
        self.other_hand.write("other_hand", &mut text);
        self.same_hand.write("same_hand", &mut text);
        text.push_str(")\n");
        text
    }

    /// Returns what a corrector has learned.
    pub fn of(corrector: &Corrector) -> Self {
        Self::new(corrector.decoder().touch(), corrector.restored())
    }

    fn new(touch: &TouchModel, words: &Restored) -> Self {
        let keys = touch.keys.iter();
        let ErrorSums {
            taps,
            spurious,
            missed,
            swapped,
        } = touch.errors;
        Self {
            words: words.words().map(str::to_owned).collect(),
            person: LearnedTaps::new(&touch.person),
            keys: keys
                .filter(|key| key.sums.taps >= MIN_KEY_TAPS)
                .map(LearnedKey::new)
                .collect(),
            errors: LearnedErrors {
                taps,
                spurious,
                missed,
                swapped,
            },
            other_hand: LearnedPairs::new(&touch.other_hand),
            same_hand: LearnedPairs::new(&touch.same_hand),
        }
    }

    /// Returns the touch model to start with. What was learned counts for at most 200 taps.
    pub fn touch(&self) -> TouchModel {
        let fraction_of = |taps: f32| {
            if taps > MAX_TAPS {
                MAX_TAPS / taps
            } else {
                1.0
            }
        };
        let fraction = fraction_of(self.person.taps);
        let errors = fraction_of(self.errors.taps);
        let prior = Prior::default();
        let (sx, sy) = self.person.scatter_mm;
        let mut variance = sx * sx + sy * sy;
        if variance == 0.0 {
            // Without taps the correlations are the correlations of an average scatter.
            variance = prior.covariance[0] + prior.covariance[1];
        }
        let pairs_of = |learned: &LearnedPairs| learned.sums(fraction_of(learned.pairs), variance);
        let key_sums = self.keys.iter().filter_map(|key| {
            Some(KeySums {
                character: key.key.chars().next()?,
                sums: key.numbers().sums(fraction),
            })
        });
        TouchModel {
            person: self.person.sums(fraction),
            keys: key_sums.collect(),
            errors: ErrorSums {
                taps: self.errors.taps * errors,
                spurious: self.errors.spurious * errors,
                missed: self.errors.missed * errors,
                swapped: self.errors.swapped * errors,
            },
            other_hand: pairs_of(&self.other_hand),
            same_hand: pairs_of(&self.same_hand),
            ..TouchModel::new(prior)
        }
    }
}

/// Returns the tables of the fields of a file.
pub fn learned_field_tables() -> Vec<Table> {
    tables_of::<Learned>()
}

/// Returns what a text decoder has learned; `None` for another filter. Allocates.
pub fn learned(filter: &dyn PressFilter) -> Option<Learned> {
    let filter: &TextFilter = filter.as_any()?.downcast_ref()?;
    Some(Learned::of(filter.corrector()))
}

/// Returns what a text decoder has learned, in a few numbers; `None` for another filter. Does not allocate.
pub fn learned_summary(filter: &dyn PressFilter) -> Option<LearnedSummary> {
    let filter: &TextFilter = filter.as_any()?.downcast_ref()?;
    let corrector = filter.corrector();
    Some(LearnedSummary {
        taps: LearnedTaps::new(&corrector.decoder().touch().person),
        words: corrector.restored().words().len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::touch::Sums;

    fn person() -> Learned {
        let mut touch = TouchModel::new(Prior::default());
        let mut random = fastrand::Rng::with_seed(5);
        touch.keys = vec![KeySums {
            character: 'a',
            sums: Sums::default(),
        }];
        for _ in 0..300 {
            let noise = (random.f32() - 0.5) * 6.0;
            touch.learn('a', [3.0 + noise, -2.0 + noise / 2.0]);
        }
        for _ in 0..400 {
            touch.learn_pair(true, [3.0, 0.0], [1.0, 0.0]);
        }
        let words = Restored::from(vec!["Nuria".to_owned(), "h2\"o".to_owned()]);
        Learned::new(&touch, &words)
    }

    fn parsed(text: &str) -> Result<Learned, String> {
        Learned::parse(&Document::new("me.ron", text)).map_err(|error| error.to_string())
    }

    #[test]
    fn a_file_keeps_what_was_learned() {
        let learned = person();
        assert!((learned.person.offset_mm.0 - 3.0).abs() < 0.3);
        assert!((learned.person.scatter_mm.0 - 1.73).abs() < 0.2);
        assert!(learned.person.correlation > 0.99);
        let read = parsed(&learned.to_ron()).expect("a file");
        assert_eq!(read.words, ["Nuria", "h2\"o"]);
        assert!((read.keys[0].offset_mm.1 - learned.keys[0].offset_mm.1).abs() < 1e-3);
        assert_eq!(read.to_ron(), learned.to_ron());
        assert!((read.same_hand.correlation - 0.6).abs() < 1e-3);
        assert_eq!(read.other_hand, LearnedPairs::default());
        assert_eq!(parsed("Learned()").expect("nothing"), Learned::default());
        assert_eq!(
            parsed(&Learned::default().to_ron()).expect("nothing"),
            Learned::default()
        );
    }

    #[test]
    fn learned_taps_count_for_a_few_sentences() {
        let mut learned = person();
        let touch = learned.touch();
        assert!((touch.person.taps - MAX_TAPS).abs() < 0.1);
        assert!((touch.person.residuals[0] / MAX_TAPS - learned.person.offset_mm.0).abs() < 1e-3);
        assert!((touch.keys[0].sums.taps - MAX_TAPS).abs() < 0.1);
        assert!((touch.same_hand.pairs - MAX_TAPS).abs() < 0.1);
        assert!((touch.same_hand.correlation() - 0.6).abs() < 1e-3);
        learned.person.taps = 50.0;
        assert!((learned.touch().person.taps - 50.0).abs() < 1e-3);
    }

    #[test]
    fn a_correlation_counts_in_a_file_without_taps() {
        let learned = parsed("Learned(same_hand: (pairs: 100, correlation: 0.3))").expect("a file");
        let touch = learned.touch();
        assert_eq!(touch.same_hand.pairs, 100.0);
        assert!((touch.same_hand.correlation() - 0.3).abs() < 1e-6);
    }

    #[test]
    fn values_that_cannot_be_are_refused() {
        for (text, message) in [
            ("Learned(word: [])", "unknown field `word`"),
            (
                "Learned(words: [\"c\", \"a b\"])",
                "word 2 of `words` is not used",
            ),
            ("Learned(words: [\"\"])", "1 to 64 bytes"),
            ("Learned(words: [Nuria])", "expected a text in quotes"),
            ("Learned(person: (taps: -1))", "`taps` is 0 to 10000"),
            (
                "Learned(person: (scatter_mm: (3, NaN)))",
                "`scatter_mm` is 0 to 100 mm",
            ),
            ("Learned(errors: (missed: inf))", "are 0 to 10000"),
            (
                "Learned(same_hand: (correlation: 2))",
                "`correlation` -1 to 1",
            ),
            (
                "Learned(keys: [(key: \"ab\", taps: 1, offset_mm: (0, 0), scatter_mm: (1, 1), correlation: 0)])",
                "the key `ab` is not one character",
            ),
            (
                "Learned(keys: [(key: \"a\", taps: 1, offset_mm: (0, 200), scatter_mm: (1, 1), correlation: 0)])",
                "the key `a`: `offset_mm` is -100 to 100 mm",
            ),
        ] {
            let error = parsed(text).expect_err(text);
            assert!(error.contains(message), "{text}: {error}");
            let is_at_start = error.starts_with("me.ron:1:1:");
            assert!(!is_at_start, "nothing is wrong there: {error}");
            let has_word = error.contains("a b") || error.contains("Nuria");
            assert!(!has_word && !error.contains('^'), "{error}");
        }
    }
}

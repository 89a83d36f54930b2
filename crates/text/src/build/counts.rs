//! Counts of words and pairs in lists and texts.

use std::collections::BTreeMap;

use super::{Word, Words};
use crate::model::lexicon::Case;

/// The longest word in letters.
const MAX_LETTERS: usize = 30;
/// The fewest occurrences in the texts of a word that no list has.
const MIN_UNLISTED: u32 = 2;
/// The least ratio of a name to the same word in lower case at which the word is written as a name: a fox is no `Fox`.
const COMMON_AS_NAME: u32 = 10;

/// The word that stands for the start of a sentence in pairs.
pub const SENTENCE_START: &str = "";
/// The word that stands for a comma in pairs.
pub const COMMA: &str = ",";

/// The counts of a spelling.
#[derive(Clone, Debug, Default)]
struct Spelled {
    /// The weight in the lists.
    weight: f64,
    listed: bool,
    /// The occurrences in texts.
    count: u32,
    /// The evidence for each case: list entries and occurrences inside a sentence.
    cases: [u32; 3],
}

/// Counts of words and pairs.
#[derive(Clone, Debug, Default)]
pub struct Counts {
    spelled: BTreeMap<String, Spelled>,
    pairs: BTreeMap<(String, String), u32>,
    threes: BTreeMap<(String, String, String), u32>,
}

/// Returns the case of a word. A word with capitals inside, such as `iPhone`, counts as lower case: a model has no case for it, and the
/// capitals that the person types stay.
fn case(word: &str) -> Option<Case> {
    let mut upper = word
        .chars()
        .filter(|&letter| letter != '\'')
        .map(char::is_uppercase);
    let first = upper.next()?;
    let (mut any, mut all) = (false, true);
    for is_upper in upper {
        any |= is_upper;
        all &= is_upper;
    }
    Some(match (first, any, all) {
        (true, false, _) => Case::Title,
        (true, true, true) => Case::Upper,
        _ => Case::Lower,
    })
}

/// Returns the lower-case spelling and the case of a word, or `None` if it has characters that words do not have.
pub fn spelling(word: &str) -> Option<(String, Case)> {
    let letters = |letter: char| letter.is_alphabetic() || letter == '\'';
    let inside = !word.starts_with('\'') && !word.ends_with('\'');
    if word.chars().count() > MAX_LETTERS || !inside || !word.chars().all(letters) {
        return None;
    }
    Some((word.to_lowercase(), case(word)?))
}

impl Counts {
    /// Adds an entry of a list. Returns `true` if it is a word.
    pub fn listed(&mut self, word: &str, weight: f64) -> bool {
        let Some((key, case)) = spelling(&word.replace('\u{2019}', "'")) else {
            return false;
        };
        let spelled = self.spelled.entry(key).or_default();
        spelled.weight = spelled.weight.max(weight);
        spelled.listed = true;
        spelled.cases[case as usize] += 1;
        true
    }

    /// Adds a sentence.
    pub fn sentence(&mut self, sentence: &str) {
        let mut before = Some(SENTENCE_START.to_owned());
        let mut earlier: Option<String> = None;
        let sentence = sentence.replace('\u{2019}', "'");
        for piece in sentence.split_whitespace() {
            let is_part = |letter: char| letter.is_alphabetic() || letter == '\'';
            let is_around = |letter: char| !letter.is_alphanumeric();
            let start = piece.trim_start_matches(is_around);
            let word = start.trim_end_matches(is_around);
            if word.is_empty() {
                continue;
            }
            let after = &start[word.len()..];
            let ends = after.contains(['.', ',', ';', ':', '!', '?']);
            let found = word.chars().all(is_part).then(|| spelling(word)).flatten();
            let Some((key, case)) = found else {
                before = None;
                earlier = None;
                continue;
            };
            let spelled = self.spelled.entry(key.clone()).or_default();
            spelled.count += 1;
            // The first word of a sentence has a capital whatever it is.
            if before.as_deref() != Some(SENTENCE_START) {
                spelled.cases[case as usize] += 1;
            }
            if let Some(before) = &before {
                let pair = (before.clone(), key.clone());
                *self.pairs.entry(pair).or_default() += 1;
                if let Some(earlier) = earlier.take() {
                    let three = (earlier, before.clone(), key.clone());
                    *self.threes.entry(three).or_default() += 1;
                }
            }
            earlier = before.filter(|_| !ends);
            before = if ends {
                after.starts_with(',').then(|| COMMA.to_owned())
            } else {
                Some(key)
            };
        }
    }

    /// Returns the words with their probabilities.
    pub fn words(&self) -> Words {
        let known = || {
            self.spelled
                .iter()
                .filter(|(_, spelled)| spelled.listed || spelled.count >= MIN_UNLISTED)
        };
        let mut preceding: BTreeMap<&str, u32> = BTreeMap::new();
        for (_, word) in self.pairs.keys() {
            *preceding.entry(word).or_default() += 1;
        }
        let preceding = |word: &String| preceding.get(word.as_str()).copied().unwrap_or(0);
        let mass = |spelled: &Spelled, count: u32| f64::from(count) + spelled.weight;
        let number = known().count() as f64;
        // Words of no weight are equally likely.
        let share = |part: f64, sum: f64| if sum > 0.0 { part / sum } else { 1.0 / number };
        let total: f64 = known()
            .map(|(_, spelled)| mass(spelled, spelled.count))
            .sum();
        let varied: f64 = known()
            .map(|(word, spelled)| mass(spelled, preceding(word)))
            .sum();
        known()
            .map(|(word, spelled)| {
                let [lower, title, upper] = spelled.cases;
                let capital = title.max(upper);
                let is_lower = COMMON_AS_NAME * lower >= capital;
                let case = match (is_lower, title >= upper) {
                    (true, _) => Case::Lower,
                    (false, true) => Case::Title,
                    (false, false) => Case::Upper,
                };
                let probability = 0.5 * share(mass(spelled, spelled.count), total)
                    + 0.5 * share(mass(spelled, preceding(word)), varied);
                (word.clone(), Word { probability, case })
            })
            .collect()
    }

    /// Returns the pairs and their counts, sorted.
    pub fn pairs(&self) -> impl Iterator<Item = (&str, &str, u32)> + Clone {
        self.pairs
            .iter()
            .map(|((before, word), &count)| (before.as_str(), word.as_str(), count))
    }

    /// Returns three words in a row and their counts, sorted.
    pub fn threes(&self) -> impl Iterator<Item = ([&str; 3], u32)> + Clone {
        self.threes.iter().map(|((earlier, before, word), &count)| {
            ([earlier.as_str(), before.as_str(), word.as_str()], count)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_case_of_a_word_is_that_inside_sentences() {
        let mut counts = Counts::default();
        counts.sentence("The cat of Anna and I saw NASA.");
        counts.sentence("The cat of Anna and I saw NASA.");
        let words = counts.words();
        let case = |word: &str| words[word].case;
        assert_eq!(case("the"), Case::Lower);
        assert_eq!(case("anna"), Case::Title);
        assert_eq!(case("i"), Case::Title);
        assert_eq!(case("nasa"), Case::Upper);
    }

    #[test]
    fn a_word_with_capitals_inside_is_written_as_the_person_does() {
        let mut counts = Counts::default();
        for word in ["iPhone", "McDonald", "eBay"] {
            counts.listed(word, 1.0);
        }
        let words = counts.words();
        let cases: Vec<_> = words
            .iter()
            .map(|(word, known)| (word.as_str(), known.case))
            .collect();
        let lower = ["ebay", "iphone", "mcdonald"].map(|word| (word, Case::Lower));
        assert_eq!(cases, lower);
    }

    #[test]
    fn an_abbreviation_in_capitals_outweighs_a_few_in_lower_case() {
        let mut counts = Counts::default();
        for text in ["A tv.", "A new TV.", "No TV."].repeat(6) {
            counts.sentence(text);
        }
        counts.listed("TV", 1.0);
        assert_eq!(counts.words()["tv"].case, Case::Lower);
        for _ in 0..60 {
            counts.sentence("On TV.");
        }
        assert_eq!(counts.words()["tv"].case, Case::Upper);
    }

    #[test]
    fn pairs_do_not_reach_over_punctuation_and_numbers() {
        let mut counts = Counts::default();
        counts.sentence("Well, it's 5 o'clock (now); then \"no,\" she said.");
        let pairs: Vec<_> = counts.pairs().collect();
        let expected = [
            ("", "well", 1),
            (COMMA, "it's", 1),
            (COMMA, "she", 1),
            ("o'clock", "now", 1),
            ("she", "said", 1),
            ("then", "no", 1),
        ];
        assert_eq!(pairs, expected);
    }

    #[test]
    fn what_is_no_word_is_left_out() {
        for text in ["x1", "'tis", "a_b", ""] {
            assert_eq!(spelling(text), None, "{text}");
        }
    }
}

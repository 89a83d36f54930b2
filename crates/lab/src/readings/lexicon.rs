//! Two ways to correct words that a decoder is compared with: one does not see where the taps were, one does not see errors of length.

use std::collections::BTreeMap;

use super::keyboard::{KeyPlaces, Touch, write};

/// The largest edit distance of a spelling correction.
const MAX_EDITS: usize = 2;

/// Words with the logarithms of their probabilities.
#[derive(Clone, Debug)]
pub struct Lexicon {
    /// The likeliest first.
    words: Vec<(Vec<char>, f32)>,
    /// The letters of each word, as bits.
    letters: Vec<u64>,
    /// The indices of the words of a length.
    by_length: BTreeMap<usize, Vec<usize>>,
}

impl Lexicon {
    /// Makes a lexicon of words and the natural logarithms of their probabilities.
    pub fn new(words: impl IntoIterator<Item = (String, f32)>) -> Self {
        let words = words.into_iter();
        let mut words: Vec<(Vec<char>, f32)> = words
            .map(|(word, probability)| (word.chars().collect(), probability))
            .collect();
        words.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
        let mut by_length: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, (word, _)) in words.iter().enumerate() {
            by_length.entry(word.len()).or_default().push(index);
        }
        Self {
            letters: words.iter().map(|(word, _)| letters_of(word)).collect(),
            words,
            by_length,
        }
    }

    /// Returns the number of words of a text that are not in the lexicon. Words are separated by blanks; capitals and punctuation around a
    /// word do not count.
    pub(crate) fn unknown_words(&self, text: &str) -> u64 {
        let words = text.split_whitespace();
        let unknown = words.filter(|word| {
            let letters: Vec<char> = word.to_lowercase().chars().collect();
            let is_part = |letter: &char| letter.is_alphanumeric();
            let first = letters.iter().position(is_part).unwrap_or_default();
            let end = letters.iter().rposition(is_part).map_or(0, |last| last + 1);
            // Some words begin or end with an apostrophe.
            !self.has(&letters) && !self.has(letters.get(first..end).unwrap_or_default())
        });
        unknown.count() as u64
    }

    fn has(&self, word: &[char]) -> bool {
        let letters = letters_of(word);
        let indices = self.by_length.get(&word.len());
        let mut indices = indices.into_iter().flatten();
        indices.any(|&index| self.letters[index] == letters && self.words[index].0 == word)
    }

    /// Corrects each word to the likeliest of the nearest words, at most two edits away: what SymSpell answers first. An edit adds,
    /// removes or replaces a letter, or swaps two adjacent ones. An unknown word without such a word stays.
    pub fn spelling(&self, text: &str) -> String {
        let words = text.split(' ').map(|word| self.spelled(word));
        words.collect::<Vec<_>>().join(" ")
    }

    fn spelled(&self, word: &str) -> String {
        let letters: Vec<char> = word.chars().collect();
        if !letters.iter().any(|letter| letter.is_alphabetic()) {
            return word.to_owned();
        }
        let lengths = letters.len().saturating_sub(MAX_EDITS)..=letters.len() + MAX_EDITS;
        let mut best: Option<(usize, usize)> = None;
        let own_letters = letters_of(&letters);
        // An edit adds one letter at most, and removes one.
        let is_far = |index: usize| {
            let other = self.letters[index];
            let missing = (own_letters & !other).count_ones();
            missing.max((other & !own_letters).count_ones()) > MAX_EDITS as u32
        };
        for (_, indices) in self.by_length.range(lengths) {
            for &index in indices.iter().filter(|index| !is_far(**index)) {
                let limit = best.map_or(MAX_EDITS, |(distance, _)| distance);
                let distance = distance(&letters, &self.words[index].0, limit);
                let own = distance.map(|distance| (distance, index));
                // A smaller index is a likelier word.
                if own.is_some_and(|own| best.is_none_or(|best| own < best)) {
                    best = own;
                }
            }
        }
        best.map_or_else(
            || word.to_owned(),
            |(_, index)| self.words[index].0.iter().collect(),
        )
    }

    /// Reads taps by the nearest words of the same length: Σ ln N(tap; key, σ) + ln P(word), with one scatter (millimetres) for all keys.
    /// Words end where a key types no letter.
    pub(crate) fn flat(&self, keys: &KeyPlaces, touches: &[Touch], scatter: f32) -> String {
        let mut text = String::new();
        let ends = |touch: &Touch| !touch.character.is_alphabetic() && touch.character != '\'';
        let mut start = 0;
        for end in 0..=touches.len() {
            let next = touches.get(end);
            if next.is_some_and(|touch| !ends(touch)) {
                continue;
            }
            if end > start {
                text.push_str(&self.nearest(keys, &touches[start..end], scatter));
            }
            if let Some(touch) = next {
                write(&mut text, touch.character);
            }
            start = end + 1;
        }
        text
    }

    fn nearest(&self, keys: &KeyPlaces, touches: &[Touch], scatter: f32) -> String {
        let typed = || touches.iter().map(|touch| touch.character).collect();
        let Some(indices) = self.by_length.get(&touches.len()) else {
            return typed();
        };
        // The costs of each letter at each tap.
        let costs: Vec<BTreeMap<char, f32>> = touches
            .iter()
            .map(|touch| {
                let letters = ('a'..='z').chain(['\'']);
                let cost = |letter| {
                    let (board, center) = keys.center(letter)?;
                    let far = if board == touch.board { 0.0 } else { 1e6 };
                    let squares = touch.at.distance_squared(center) + far;
                    Some((letter, squares / (2.0 * scatter * scatter)))
                };
                letters.filter_map(cost).collect()
            })
            .collect();
        let mut best: Option<(f32, usize)> = None;
        for &index in indices {
            let (word, probability) = &self.words[index];
            let limit = best.map_or(f32::NEG_INFINITY, |(score, _)| score);
            let mut score = *probability;
            for (letter, letter_costs) in word.iter().zip(&costs) {
                score -= letter_costs.get(letter).copied().unwrap_or(f32::INFINITY);
                if score <= limit {
                    break;
                }
            }
            if score > limit {
                best = Some((score, index));
            }
        }
        best.map_or_else(typed, |(_, index)| self.words[index].0.iter().collect())
    }
}

/// Returns a bit for each letter of a word; rare letters may share one.
fn letters_of(word: &[char]) -> u64 {
    word.iter()
        .fold(0, |all, letter| all | 1 << (u32::from(*letter) % 64))
}

/// Returns the edit distance with swaps of adjacent letters (optimal string alignment), if it is at most a limit of two or less.
fn distance(a: &[char], b: &[char], limit: usize) -> Option<usize> {
    // Equal ends cost nothing.
    let start = a.iter().zip(b).take_while(|(a, b)| a == b).count();
    let (a, b) = (&a[start..], &b[start..]);
    let end = a.iter().rev().zip(b.iter().rev());
    let end = end.take_while(|(left, right)| left == right).count();
    let (a, b) = (&a[..a.len() - end], &b[..b.len() - end]);
    let distance = match (a, b) {
        ([], rest) | (rest, []) => rest.len(),
        ([x, a_rest @ ..], [y, b_rest @ ..]) => {
            let limit = limit.checked_sub(1)?;
            let swapped = match (a_rest, b_rest) {
                ([x2, a_rest @ ..], [y2, b_rest @ ..]) if (x, x2) == (y2, y) => {
                    distance(a_rest, b_rest, limit)
                }
                _ => None,
            };
            let others = [
                distance(a_rest, b_rest, limit),
                distance(a_rest, b, limit),
                distance(a, b_rest, limit),
                swapped,
            ];
            let least = others.into_iter().flatten().min();
            least? + 1
        }
    };
    (distance <= limit).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lexicon() -> Lexicon {
        let words = [
            ("the", -1.0),
            ("then", -3.0),
            ("toe", -2.0),
            ("a", -0.5),
            ("kettle", -4.0),
        ];
        Lexicon::new(words.map(|(word, probability)| (word.to_owned(), probability)))
    }

    #[test]
    fn a_word_becomes_the_nearest_word_and_the_likeliest_of_these() {
        let lexicon = lexicon();
        for (typed, read) in [
            ("the", "the"),
            ("teh", "the"),
            ("thr", "the"),
            ("thenn", "then"),
            ("ktetel", "kettle"),
            ("xyzzyx", "xyzzyx"),
            ("42", "42"),
            ("thr ketle", "the kettle"),
        ] {
            assert_eq!(lexicon.spelling(typed), read, "{typed}");
        }
    }

    #[test]
    fn words_that_the_lexicon_lacks_are_counted_without_capitals_and_punctuation() {
        let lexicon = lexicon();
        for (text, unknown) in [
            ("the toe", 0),
            ("The \"toe\", then a kettle.", 0),
            ("the teh a", 1),
            ("a 42 => kettles", 3),
            ("", 0),
        ] {
            assert_eq!(lexicon.unknown_words(text), unknown, "{text}");
        }
    }

    #[test]
    fn distances_are_those_of_optimal_string_alignment() {
        for (a, b, expected) in [
            ("abc", "abc", Some(0)),
            ("abc", "acb", Some(1)),
            ("abcd", "abXYcd", Some(2)),
            ("abc", "xyz", None),
            ("ca", "abc", None),
            ("", "ab", Some(2)),
            ("ab", "ba", Some(1)),
            ("aabb", "abab", Some(1)),
        ] {
            let letters = |text: &str| text.chars().collect::<Vec<_>>();
            assert_eq!(distance(&letters(a), &letters(b), 2), expected, "{a} {b}");
            assert_eq!(distance(&letters(b), &letters(a), 2), expected, "{b} {a}");
        }
    }
}

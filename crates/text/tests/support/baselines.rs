//! The competitors of the decoder: the nearest word of the same length in the flat lexicon, and a spelling corrector that does not
//! see positions. Both get the words and probabilities of the model.

use std::collections::BTreeMap;

use ademan_text::{Keyboard, Model, Tap};
use symspell::{AsciiStringStrategy, SymSpell, Verbosity};

use super::session::Phrase;

/// The flat lexicon: per word, Σ ln N(tap; key, σ) + ln P(word), without errors of length, and without learning.
pub struct Flat {
    by_length: BTreeMap<usize, Vec<(String, Vec<usize>, f32)>>,
    keyboard: Keyboard,
    variance: f32,
}

impl Flat {
    pub fn new(model: &Model, keyboard: &Keyboard, scatter: f32) -> Self {
        let mut by_length: BTreeMap<usize, Vec<_>> = BTreeMap::new();
        for (word, log_probability) in model.word_list() {
            let keys: Option<Vec<usize>> =
                word.chars().map(|letter| keyboard.index(letter)).collect();
            if let Some(keys) = keys {
                by_length
                    .entry(keys.len())
                    .or_default()
                    .push((word, keys, log_probability));
            }
        }
        Self {
            by_length,
            keyboard: keyboard.clone(),
            variance: scatter * scatter,
        }
    }

    fn word(&self, taps: &[Tap], nearest: &str) -> String {
        let known = self
            .by_length
            .get(&taps.len())
            .map_or(&[][..], Vec::as_slice);
        let score = |keys: &[usize], log_probability: f32| {
            let apart = |(&key, tap): (&usize, &Tap)| {
                let [x, y] = self.keyboard.keys()[key].center;
                (tap.position[0] - x).powi(2) + (tap.position[1] - y).powi(2)
            };
            log_probability - keys.iter().zip(taps).map(apart).sum::<f32>() / (2.0 * self.variance)
        };
        let scored = known
            .iter()
            .map(|(word, keys, probability)| (word, score(keys, *probability)));
        let best = scored.max_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or_else(|| nearest.to_owned(), |(word, _)| word.clone())
    }

    /// Reads a phrase: words end where the nearest key is no letter.
    pub fn read(&self, phrase: &Phrase) -> String {
        read_words(&self.keyboard, phrase, |taps, nearest| {
            self.word(taps, nearest)
        })
    }
}

/// Reads a phrase word by word with `word`, which gets the taps of a word and the text of the nearest keys. Words end where the nearest
/// key is no letter.
pub fn read_words(
    keyboard: &Keyboard,
    phrase: &Phrase,
    word: impl Fn(&[Tap], &str) -> String,
) -> String {
    let text = super::session::nearest(keyboard, &phrase.taps);
    let characters: Vec<char> = text.chars().collect();
    let mut read = String::new();
    let mut start = 0;
    for end in 0..=characters.len() {
        let ends = characters
            .get(end)
            .is_none_or(|&last| !last.is_alphabetic() && last != '\'');
        if !ends {
            continue;
        }
        if end > start {
            let nearest: String = characters[start..end].iter().collect();
            read.push_str(&word(&phrase.taps[start..end], &nearest));
        }
        read.extend(characters.get(end));
        start = end + 1;
    }
    read
}

/// SymSpell, an edit distance of at most 2.
pub struct Spelling(SymSpell<AsciiStringStrategy>);

impl Spelling {
    pub fn new(model: &Model) -> Self {
        let mut spelling = SymSpell::default();
        for (word, log_probability) in model.word_list() {
            if word.is_ascii() {
                let count = (f64::from(log_probability).exp() * 1e12) as i64;
                spelling.load_dictionary_line(&format!("{word}\t{count}"), 0, 1, "\t");
            }
        }
        Self(spelling)
    }

    /// Reads the text of the nearest keys: the first suggestion for each word.
    pub fn read(&self, nearest: &str) -> String {
        let words = nearest.split(' ').map(|word| {
            let found = self.0.lookup(word, Verbosity::Top, 2);
            found
                .first()
                .map_or_else(|| word.to_owned(), |found| found.term.clone())
        });
        words.collect::<Vec<_>>().join(" ")
    }
}

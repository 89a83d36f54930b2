//! The builder of language models: from lists of words and text to the bytes of a model.
//!
//! The same lists and texts, in any order of their lines, give the same bytes on every machine: counts are sorted, and the only
//! function beyond arithmetic is [`ln`].
//!
//! - A word has half its probability of its count in the texts plus its weight in the lists, and half of the number of different words
//!   before it plus that weight (Kneser and Ney 1995), so that `francisco` is unlikely after other words than `san`.
//! - A pair of words has its count less a discount of 0.75, divided by the count of the first word; what
//!   remains of that word goes to all words in proportion to their own probabilities (absolute discounting). Three words in a row
//!   that occur at least twice do alike with what follows the second one. The start of a sentence and a comma count as first words.
//! - Another model in the ARPA format gets a share of each of these probabilities: a tenth of a word alone, a half after words that
//!   the texts have, and 0.8 after others.
//! - Pairs and threes that do not fit into 4 MB are left out, those first that save least in a text (Stolcke 1998).
//! - Spelling: the letters of all words, each word weighted by the root of its probability, up to four letters before the next one,
//!   interpolated after Witten and Bell.

mod arpa;
mod counts;
mod letters;
mod mixture;
mod pairs;
mod trie;

use std::collections::BTreeMap;

use crate::logarithm::ln;
use crate::model::alphabet::{Alphabet, MAX_SYMBOLS};
use crate::model::bytes::checksum;
use crate::model::lexicon::{Case, MAX_NODES};
use crate::model::{CHECKED_FROM, HEADER_BYTES, MAGIC, SECTIONS, VERSION};
use ademan_core::document::BYTE_ORDER_MARK;
use arpa::{Arpa, Other};
use counts::Counts;

/// The size up to which pairs and threes of words are kept.
const MAX_BYTES: usize = 4_000_000;
/// The size up to which pairs and threes are kept in any case, even if the words leave no room for them.
const MIN_PAIR_BYTES: usize = 1_000_000;

/// Lists and texts that make no model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// There is no word.
    #[error("there are no words: give a list of words, or a text in which words occur twice")]
    Empty,
    /// There are too many letters.
    #[error(
        "the words have {0} different letters, more than the 60 of a model; keep words of one language"
    )]
    Letters(usize),
    /// There are too many words.
    #[error("the words need {0} nodes, more than the {MAX_NODES} of a model; keep fewer words")]
    Nodes(usize),
}

/// A line that does not belong to a list of words, or to a model in the ARPA format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {fault}")]
pub struct LineError {
    /// The line, from 1.
    pub line: usize,
    /// The fault.
    pub fault: &'static str,
}

/// Collects words and text.
#[derive(Clone, Debug, Default)]
pub struct Builder {
    counts: Counts,
    arpa: Arpa,
}

/// A word of the model to be.
#[derive(Clone, Debug)]
struct Word {
    probability: f64,
    case: Case,
}

/// Words by their lower-case spelling.
type Words = BTreeMap<String, Word>;

impl Builder {
    /// Makes an empty builder.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the words of a list: one per line, with a weight after a tab or a space if it is not 1. A weight is the number of times that
    /// the word is expected in a text as long as the given ones. Leaves out lines whose first part is no word, such as `e-mail`, and
    /// returns the numbers of words that were added and left out.
    ///
    /// # Errors
    ///
    /// Fails at the first line whose weight is not a finite number of 0 or more; nothing of the list is added then.
    pub fn words(&mut self, list: &str) -> Result<(usize, usize), LineError> {
        let mut words = Vec::new();
        let list = list.trim_start_matches(BYTE_ORDER_MARK);
        for (index, line) in list.lines().enumerate() {
            let mut fields = line.split_whitespace();
            let Some(word) = fields.next() else { continue };
            let weight = fields.next().map_or(Ok(1.0), str::parse);
            let weight = weight
                .ok()
                .filter(|weight: &f64| weight.is_finite() && *weight >= 0.0);
            let weight = weight.ok_or(LineError {
                line: index + 1,
                fault: "its weight is not a number of 0 or more; write it like 0.5, without thousands separators",
            })?;
            words.push((word, weight));
        }
        let all = words.len();
        let added = words
            .into_iter()
            .filter(|&(word, weight)| self.counts.listed(word, weight))
            .count();
        Ok((added, all - added))
    }

    /// Adds the words and pairs of a text, a sentence each line. A word that no list has counts if it occurs twice.
    pub fn text(&mut self, text: &str) {
        for line in text.lines() {
            self.counts.sentence(line);
        }
    }

    /// Mixes probabilities of another language model in the ARPA format with what the texts say, in place of one that was given before. It
    /// adds no words.
    ///
    /// # Errors
    ///
    /// Fails if the text is no such model.
    pub fn arpa(&mut self, text: &str) -> Result<(), LineError> {
        self.arpa = Arpa::read(text)?;
        Ok(())
    }

    /// Returns the bytes of the model.
    ///
    /// # Errors
    ///
    /// Fails if there is no word, or more than a model has room for.
    pub fn build(&self) -> Result<Vec<u8>, BuildError> {
        let mut words = self.counts.words();
        if words.is_empty() {
            return Err(BuildError::Empty);
        }
        let mut letters: Vec<char> = words.keys().flat_map(|word| word.chars()).collect();
        letters.sort_unstable();
        letters.dedup();
        if letters.len() > MAX_SYMBOLS {
            return Err(BuildError::Letters(letters.len()));
        }
        let alphabet = Alphabet::new(letters);
        mixture::mix_words(&mut words, &self.arpa, &self.counts);
        let (nodes, indices) = trie::build(&words, &alphabet)?;
        let (states, arcs) = letters::build(&words, &alphabet);
        let symbols = alphabet.write();
        let others = HEADER_BYTES + symbols.len() + nodes.len() + states.len() + arcs.len();
        let room = MAX_BYTES.saturating_sub(others).max(MIN_PAIR_BYTES);
        let alone = indices
            .iter()
            .map(|(&word, &node)| (node, words[word].probability))
            .collect();
        let other = Other::new(&self.arpa, &indices);
        let mixture = mixture::mix(&self.counts, &indices, &other, &alone);
        let [rows, pairs, contexts, threes] = pairs::build(mixture, &alone, room);
        Ok(file([
            symbols, nodes, rows, pairs, contexts, threes, states, arcs,
        ]))
    }
}

/// Returns `true` for a line of a text that the shipped models leave out, every 20th, so that it can be used to measure them.
pub fn held_out(line: usize) -> bool {
    line % 20 == 19
}

fn file(sections: [Vec<u8>; SECTIONS]) -> Vec<u8> {
    let mut bytes = Vec::new();
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((SECTIONS as u32).to_le_bytes());
    bytes.extend([0; 8]);
    for section in &sections {
        bytes.extend((section.len() as u32).to_le_bytes());
    }
    debug_assert_eq!(bytes.len(), HEADER_BYTES);
    bytes.extend(sections.into_iter().flatten());
    let sum = checksum(&bytes[CHECKED_FROM..]);
    bytes[16..CHECKED_FROM].copy_from_slice(&sum.to_le_bytes());
    bytes
}

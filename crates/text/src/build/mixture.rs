//! The probabilities of words after others: from counts, mixed with another model.

use std::collections::BTreeMap;

use super::arpa::{Arpa, Other};
use super::counts::{COMMA, Counts, SENTENCE_START};
use super::trie::Indices;
use super::{Words, ln};
use crate::model::bigrams::AFTER_COMMA;
use crate::model::lexicon::ROOT;

/// The discount of each count in favor of words that were not seen.
const DISCOUNT: f64 = 0.75;
/// The fewest occurrences of three words: once says little, and is most of them.
const MIN_THREES: u32 = 2;
/// The share of the other model after words that the texts have: between 0.4, best for sentences of the same collection that no
/// model has seen, and more, better for other texts.
const SHARE: f64 = 0.5;
/// The share where the texts say nothing.
const SHARE_UNSEEN: f64 = 0.8;
/// The share in the probabilities of words alone, chosen on sentences that no model has seen.
const SHARE_ALONE: f64 = 0.1;
/// The share of words of a text that a sentence has in front of it, or a comma.
const MARK: f64 = 0.1;
/// The least probability that can be stored.
const LEAST: f64 = 8e-12;
/// The least probability of all words that a row lacks.
const LEAST_WEIGHT: f64 = 1e-6;

/// A word after others.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The node.
    pub node: u32,
    /// The probability.
    pub probability: f64,
    /// The probability if it is not stored, before the weight of the row.
    pub shorter: f64,
    /// The share of words of a text that it is, after the words of the row.
    frequency: f64,
}

impl Entry {
    fn new(node: u32, probability: f64, shorter: f64, before: f64) -> Self {
        let probability = probability.clamp(LEAST, 1.0);
        Self {
            node,
            probability,
            shorter,
            frequency: before * probability,
        }
    }

    /// Returns the nats of each word of a text that are saved if the word is stored in a row whose other words have this weight
    /// (Stolcke 1998). That the weight changes with it is passed over.
    pub fn gain(&self, weight: f64) -> f64 {
        let otherwise = (weight * self.shorter).max(LEAST);
        self.frequency * ln(self.probability / otherwise)
    }
}

/// The words after one word or two.
#[derive(Debug, Default)]
pub struct Row {
    /// The words, sorted.
    pub entries: Vec<Entry>,
    /// The weight of all other words.
    pub weight: f64,
}

impl Row {
    fn new(entries: Vec<Entry>) -> Self {
        let mut row = Self {
            entries,
            weight: 1.0,
        };
        row.weigh(|_, _| true);
        row
    }

    /// Computes the weight of the words that are not stored, given which ones are with the present weight.
    pub fn weigh(&mut self, is_stored: impl Fn(&Entry, f64) -> bool) {
        let weight = self.weight;
        let stored = self.entries.iter().filter(|entry| is_stored(entry, weight));
        let (inside, outside) = stored.fold((0.0, 0.0), |(inside, outside), entry| {
            (inside + entry.probability, outside + entry.shorter)
        });
        self.weight = (1.0 - inside).max(LEAST_WEIGHT) / (1.0 - outside).max(LEAST_WEIGHT);
    }

    /// Removes entries.
    pub fn keep(&mut self, is_stored: impl Fn(&Entry, f64) -> bool) {
        let weight = self.weight;
        self.entries.retain(|entry| is_stored(entry, weight));
        self.weigh(|_, _| true);
    }

    /// Computes the weight with other probabilities of words that are not stored.
    pub fn stand_on(&mut self, shorter: impl Fn(u32) -> f64) {
        for entry in &mut self.entries {
            entry.shorter = shorter(entry.node);
        }
        self.weigh(|_, _| true);
    }

    /// Returns the gain of each entry.
    pub fn gains(&self) -> impl Iterator<Item = f64> {
        self.entries.iter().map(|entry| entry.gain(self.weight))
    }

    /// Returns the entry of a word.
    fn find(&self, node: u32) -> Option<&Entry> {
        let index = self.entries.binary_search_by_key(&node, |entry| entry.node);
        index.ok().map(|index| &self.entries[index])
    }

    /// Returns the probability of a word, given its probability if no word before it is known.
    pub fn probability(&self, node: u32, alone: f64) -> f64 {
        let found = self.find(node);
        found.map_or(self.weight * alone, |entry| entry.probability)
    }
}

/// Words by their number of occurrences.
#[derive(Debug, Default)]
struct Tally {
    total: u32,
    seen: BTreeMap<u32, u32>,
}

impl Tally {
    fn add(&mut self, node: Option<u32>, count: u32, least: u32) {
        self.total += count;
        if let Some(node) = node.filter(|_| count >= least) {
            *self.seen.entry(node).or_default() += count;
        }
    }

    /// Returns what is left for words that were not seen.
    fn rest(&self) -> f64 {
        let seen = self.seen.keys().map(|&node| self.seen(node));
        1.0 - seen.sum::<f64>()
    }

    fn seen(&self, node: u32) -> f64 {
        match self.seen.get(&node) {
            None | Some(0) => 0.0,
            Some(&count) => (f64::from(count) - DISCOUNT) / f64::from(self.total),
        }
    }
}

/// Probabilities of pairs and threes before any is left out.
#[derive(Debug)]
pub struct Mixture {
    /// The words after a word.
    pub pairs: BTreeMap<u32, Row>,
    /// The words after two words.
    pub threes: BTreeMap<(u32, u32), Context>,
}

/// Two words and the words after them.
#[derive(Debug)]
pub struct Context {
    /// The second word after the first.
    pub pair: Entry,
    /// The words after both.
    pub row: Row,
}

/// Counts, the other model and the probabilities of words alone, by nodes.
struct Sources<'a> {
    counts: &'a Counts,
    indices: &'a Indices<'a>,
    other: &'a Other,
    alone: &'a BTreeMap<u32, f64>,
}

/// Mixes the probabilities of words alone with another model.
pub fn mix_words(words: &mut Words, other: &Arpa, counts: &Counts) {
    let other = other.alone(words);
    if other.is_empty() {
        return;
    }
    let has_text = counts.pairs().next().is_some();
    let share = if has_text { SHARE_ALONE } else { SHARE_UNSEEN };
    for (word, entry) in words {
        let probability = other.get(word).copied().unwrap_or(0.0);
        entry.probability += share * (probability - entry.probability);
    }
}

/// Mixes the counts of texts with another model, given the probability of each word alone.
pub fn mix(
    counts: &Counts,
    indices: &Indices,
    other: &Other,
    alone: &BTreeMap<u32, f64>,
) -> Mixture {
    let sources = Sources {
        counts,
        indices,
        other,
        alone,
    };
    let pairs = sources.pairs();
    let threes = sources.threes(&pairs);
    Mixture { pairs, threes }
}

impl Sources<'_> {
    /// Returns the node that stands for what is in front of a word.
    fn context(&self, before: &str) -> Option<u32> {
        match before {
            SENTENCE_START => Some(ROOT),
            COMMA => Some(AFTER_COMMA),
            before => self.indices.get(before).copied(),
        }
    }

    fn alone(&self, node: u32) -> f64 {
        self.alone.get(&node).copied().unwrap_or(0.0)
    }

    /// Returns the share of words of a text that a word or mark in front is.
    fn frequency(&self, before: u32) -> f64 {
        self.alone.get(&before).copied().unwrap_or(MARK)
    }

    /// Returns the share of the other model after some words.
    fn share(&self, before: &[u32], tally: &Tally) -> f64 {
        let has_all = before.iter().all(|&word| self.other.has(word));
        match (has_all, tally.total) {
            (false, _) => 0.0,
            (true, 0) => SHARE_UNSEEN,
            (true, _) => SHARE,
        }
    }

    fn pairs(&self) -> BTreeMap<u32, Row> {
        let mut tallies: BTreeMap<u32, Tally> = BTreeMap::new();
        for (before, word, count) in self.counts.pairs() {
            if let Some(before) = self.context(before) {
                let node = self.indices.get(word).copied();
                tallies.entry(before).or_default().add(node, count, 1);
            }
        }
        for (before, word) in self.other.pairs() {
            let tally = tallies.entry(before).or_default();
            tally.seen.entry(word).or_default();
        }
        let row = |(before, tally): (u32, Tally)| {
            let rest = tally.rest();
            let share = self.share(&[before], &tally);
            let frequency = self.frequency(before);
            let entry = |&node: &u32| {
                let alone = self.alone(node);
                let counted = tally.seen(node) + rest * alone;
                let probability = counted + share * (self.other.pair(before, node) - counted);
                Entry::new(node, probability, alone, frequency)
            };
            (before, Row::new(tally.seen.keys().map(entry).collect()))
        };
        let rows = tallies.into_iter().map(row);
        rows.filter(|(_, words)| !words.entries.is_empty())
            .collect()
    }

    fn threes(&self, pairs: &BTreeMap<u32, Row>) -> BTreeMap<(u32, u32), Context> {
        let mut tallies: BTreeMap<(u32, u32), Tally> = BTreeMap::new();
        for ([earlier, before, word], count) in self.counts.threes() {
            let earlier = self.context(earlier);
            let before = self.indices.get(before).copied();
            if let Some(context) = earlier.zip(before) {
                let node = self.indices.get(word).copied();
                tallies
                    .entry(context)
                    .or_default()
                    .add(node, count, MIN_THREES);
            }
        }
        for (earlier, before, word) in self.other.threes() {
            let tally = tallies.entry((earlier, before)).or_default();
            tally.seen.entry(word).or_default();
        }
        let row = |((earlier, before), tally): ((u32, u32), Tally)| {
            // A context is stored at the entry of its pair.
            let pair = *pairs.get(&earlier)?.find(before)?;
            let frequency = self.frequency(earlier) * pair.probability;
            let (rest, share) = (tally.rest(), self.share(&[earlier, before], &tally));
            let following = pairs.get(&before);
            let entry = |&node: &u32| {
                let alone = self.alone(node);
                let shorter = following.map_or(alone, |row| row.probability(node, alone));
                let counted = tally.seen(node) + rest * shorter;
                let other = self.other.three(earlier, before, node);
                let probability = counted + share * (other - counted);
                Entry::new(node, probability, shorter, frequency)
            };
            let row = Row::new(tally.seen.keys().map(entry).collect());
            Some(((earlier, before), Context { pair, row }))
        };
        let contexts = tallies.into_iter().filter_map(row);
        contexts
            .filter(|(_, context)| !context.row.entries.is_empty())
            .collect()
    }
}

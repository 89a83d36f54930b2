//! The rows and entries of pairs of words, and of three words in a row.

use std::collections::BTreeMap;

use super::counts::{COMMA, Counts, SENTENCE_START};
use super::trie::Indices;
use super::{Words, ln};
use crate::logarithm::quantize;
use crate::model::bigrams::{AFTER_COMMA, CONTEXT_BYTES, NO_ROW, ROW_BYTES};
use crate::model::lexicon::ROOT;

/// The discount of each count in favour of words that were not seen.
const DISCOUNT: f64 = 0.75;
/// The most pairs, and the most threes: rarer ones of a longer text are left out.
const MAX_PAIRS: usize = 250_000;
const MAX_TRIPLES: usize = 60_000;
/// Three words that were seen once say little and are most of all.
const MIN_TRIPLES: u32 = 2;
/// The node behind the last one.
const LAST: u32 = 0xff_ffff;

/// The words behind a word, or two.
#[derive(Default)]
struct Row {
    total: u32,
    kept: Vec<(u32, u32)>,
}

impl Row {
    fn add(&mut self, node: Option<u32>, count: u32, least: u32) {
        self.total += count;
        if let Some(node) = node.filter(|_| count >= least) {
            self.kept.push((node, count));
        }
    }

    fn seen(&self, count: u32) -> f64 {
        (f64::from(count) - DISCOUNT) / f64::from(self.total)
    }

    /// Returns the weight of the words that were not seen.
    fn rest(&self) -> f64 {
        let seen = self.kept.iter().map(|&(_, count)| self.seen(count));
        1.0 - seen.sum::<f64>()
    }

    /// Appends the entries and returns the stored weight.
    fn write(&mut self, entries: &mut Vec<u8>, shorter: impl Fn(u32) -> f64) -> u8 {
        self.kept.sort_unstable();
        let rest = self.rest();
        for &(node, count) in &self.kept {
            let probability = self.seen(count) + rest * shorter(node);
            let entry = node << 8 | u32::from(quantize(ln(probability)));
            entries.extend(entry.to_le_bytes());
        }
        quantize(ln(rest))
    }
}

/// Returns the least count with which at most `limit` of them are kept.
fn least(counts: impl Iterator<Item = u32> + Clone, from: u32, limit: usize) -> u32 {
    let mut least = from;
    while counts.clone().filter(|&count| count >= least).count() > limit {
        least += 1;
    }
    least
}

/// Returns the node that stands for what is in front of a word.
fn context(before: &str, indices: &Indices) -> Option<u32> {
    match before {
        SENTENCE_START => Some(ROOT),
        COMMA => Some(AFTER_COMMA),
        before => indices.get(before).copied(),
    }
}

/// Returns the rows and entries of pairs, and the contexts and entries of threes.
pub fn build(counts: &Counts, words: &Words, indices: &Indices) -> [Vec<u8>; 4] {
    let alone: BTreeMap<u32, f64> = indices
        .iter()
        .map(|(&word, &node)| (node, words[word].probability))
        .collect();
    let alone = |node: u32| alone.get(&node).copied().unwrap_or(0.0);
    let mut rows: BTreeMap<u32, Row> = BTreeMap::new();
    let fewest = least(counts.pairs().map(|(.., count)| count), 1, MAX_PAIRS);
    for (before, word, count) in counts.pairs() {
        let Some(before) = context(before, indices) else {
            continue;
        };
        let node = indices.get(word).copied();
        rows.entry(before).or_default().add(node, count, fewest);
    }
    rows.retain(|_, row| !row.kept.is_empty());
    let (mut heads, mut entries) = (Vec::new(), Vec::<u8>::new());
    for (node, row) in &mut rows {
        let start = entries.len();
        let weight = row.write(&mut entries, alone);
        head(&mut heads, *node, weight, start);
    }
    // The end of the last row.
    head(&mut heads, LAST, 255, entries.len());
    let pair = |before: u32, node: u32| {
        let Some(row) = rows.get(&before) else {
            return alone(node);
        };
        let found = row.kept.binary_search_by_key(&node, |&(node, _)| node);
        let seen = found.map_or(0.0, |index| row.seen(row.kept[index].1));
        seen + row.rest() * alone(node)
    };
    let (contexts, triples) = triples(counts, indices, &rows, pair);
    [heads, entries, contexts, triples]
}

fn head(heads: &mut Vec<u8>, key: u32, weight: u8, start: usize) {
    heads.extend((key << 8 | u32::from(weight)).to_le_bytes());
    heads.extend((start as u32 / 4).to_le_bytes());
}

/// Returns the contexts, each the index of the entry of its two words, and their entries.
fn triples(
    counts: &Counts,
    indices: &Indices,
    rows: &BTreeMap<u32, Row>,
    pair: impl Fn(u32, u32) -> f64,
) -> (Vec<u8>, Vec<u8>) {
    // The index of the entry of each pair, and the index of the row of each word.
    let mut places: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let mut row_of: BTreeMap<u32, u32> = BTreeMap::new();
    for (index, (&before, row)) in (0..).zip(rows) {
        row_of.insert(before, index);
        for &(node, _) in &row.kept {
            places.insert((before, node), places.len() as u32);
        }
    }
    let fewest = least(
        counts.triples().map(|(_, count)| count),
        MIN_TRIPLES,
        MAX_TRIPLES,
    );
    let mut contexts: BTreeMap<u32, (u32, Row)> = BTreeMap::new();
    for ([earlier, before, word], count) in counts.triples() {
        let (Some(earlier), Some(&before)) = (context(earlier, indices), indices.get(before))
        else {
            continue;
        };
        let Some(&place) = places.get(&(earlier, before)) else {
            continue;
        };
        let (_, row) = contexts
            .entry(place)
            .or_insert_with(|| (before, Row::default()));
        row.add(indices.get(word).copied(), count, fewest);
    }
    contexts.retain(|_, (_, row)| !row.kept.is_empty());
    let (mut heads, mut entries) = (Vec::new(), Vec::<u8>::new());
    for (place, (before, row)) in &mut contexts {
        let start = entries.len();
        let weight = row.write(&mut entries, |node| pair(*before, node));
        head(&mut heads, *place, weight, start);
        let shorter = row_of.get(before).copied().unwrap_or(NO_ROW.0);
        heads.extend(shorter.to_le_bytes());
    }
    head(&mut heads, LAST, 255, entries.len());
    heads.extend([0; CONTEXT_BYTES - ROW_BYTES]);
    (heads, entries)
}

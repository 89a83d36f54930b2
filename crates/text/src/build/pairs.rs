//! The rows and entries of pairs of words.

use std::collections::BTreeMap;

use super::counts::{Counts, SENTENCE_START};
use super::trie::Indices;
use super::{Words, ln};
use crate::logarithm::quantize;
use crate::model::lexicon::ROOT;

/// What is taken from each count for words that were not seen.
const DISCOUNT: f64 = 0.75;
/// A pair that was seen once says little and is most of all pairs.
const MIN_COUNT: u32 = 2;

#[derive(Default)]
struct Row {
    total: u32,
    kept: Vec<(u32, u32, f64)>,
}

/// Returns the rows and the entries.
pub fn build(counts: &Counts, words: &Words, indices: &Indices) -> (Vec<u8>, Vec<u8>) {
    let mut rows: BTreeMap<u32, Row> = BTreeMap::new();
    for (before, word, count) in counts.pairs() {
        let before = match before {
            SENTENCE_START => Some(ROOT),
            before => indices.get(before).copied(),
        };
        let Some(before) = before else { continue };
        let row = rows.entry(before).or_default();
        row.total += count;
        if let Some(&node) = indices.get(word).filter(|_| count >= MIN_COUNT) {
            row.kept.push((node, count, words[word].probability));
        }
    }
    rows.retain(|_, row| !row.kept.is_empty());
    let (mut heads, mut entries) = (Vec::new(), Vec::<u8>::new());
    let mut head = |node: u32, weight: u8, start: usize| {
        heads.extend((node << 8 | u32::from(weight)).to_le_bytes());
        heads.extend((start as u32 / 4).to_le_bytes());
    };
    for (node, row) in &mut rows {
        row.kept.sort_unstable_by_key(|&(node, ..)| node);
        let total = f64::from(row.total);
        let seen = |count: u32| (f64::from(count) - DISCOUNT) / total;
        let rest = 1.0
            - row
                .kept
                .iter()
                .map(|&(_, count, _)| seen(count))
                .sum::<f64>();
        head(*node, quantize(ln(rest)), entries.len());
        for &(node, count, alone) in &row.kept {
            let probability = seen(count) + rest * alone;
            let entry = node << 8 | u32::from(quantize(ln(probability)));
            entries.extend(entry.to_le_bytes());
        }
    }
    // The end of the last row.
    head(0xff_ffff, 255, entries.len());
    (heads, entries)
}

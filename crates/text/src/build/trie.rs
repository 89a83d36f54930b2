//! The nodes of the lexicon.

use std::collections::{BTreeMap, VecDeque};

use super::{BuildError, Words, ln};
use crate::logarithm::quantize;
use crate::model::alphabet::{Alphabet, Symbol};
use crate::model::lexicon::{Case, MAX_NODES, Node, PADDING};

/// The indices of the nodes of words.
pub type Indices<'a> = BTreeMap<&'a str, u32>;

/// Returns the nodes in breadth-first order, and the node of each word.
pub fn build<'a>(
    words: &'a Words,
    alphabet: &Alphabet,
) -> Result<(Vec<u8>, Indices<'a>), BuildError> {
    // Alphabets are sorted, so words with a common prefix are neighbors, and a node is a range of words.
    let mut sorted: Vec<(&str, Vec<Symbol>, u8, Case)> = words
        .iter()
        .map(|(word, entry)| {
            let symbols = word.chars().filter_map(|letter| alphabet.symbol(letter));
            let probability = quantize(ln(entry.probability));
            (word.as_str(), symbols.collect(), probability, entry.case)
        })
        .collect();
    sorted.sort_by(|a, b| a.1.cmp(&b.1));
    let mut indices = Indices::new();
    let mut bytes = Vec::new();
    let mut queue = VecDeque::from([(0..sorted.len(), 0, 0)]);
    let mut next = 1;
    let mut count = 0;
    while let Some((range, depth, symbol)) = queue.pop_front() {
        let best = sorted[range.clone()].iter().map(|word| word.2).min();
        let first_child = next;
        let (mut word, mut case) = (0, Case::Lower);
        let mut start = range.start;
        if sorted[start].1.len() == depth {
            (word, case) = (sorted[start].2, sorted[start].3);
            indices.insert(sorted[start].0, count);
            start += 1;
        }
        while start < range.end {
            let letter = sorted[start].1[depth];
            let same = |entry: &(&str, Vec<Symbol>, u8, Case)| entry.1[depth] == letter;
            let end = start + sorted[start..range.end].partition_point(same);
            queue.push_back((start..end, depth + 1, letter));
            next += 1;
            start = end;
        }
        let node = Node::new(first_child, symbol, word, best.unwrap_or(255), case);
        bytes.extend(node.to_bytes());
        count += 1;
    }
    if next as usize >= MAX_NODES {
        return Err(BuildError::Nodes(next as usize));
    }
    bytes.extend([0; PADDING]);
    Ok((bytes, indices))
}

//! The rows and entries of pairs of words, and of three words in a row: as many as a model has room for.

use std::collections::BTreeMap;

use super::ln;
use super::mixture::{Context, Mixture, Row};
use crate::logarithm::quantize;
use crate::model::bigrams::{CONTEXT_BYTES, NO_ROW, ROW_BYTES};

/// The bytes of an entry.
const ENTRY_BYTES: usize = 4;
/// The node after the last one.
const LAST: u32 = 0xff_ffff;
/// The gains between which the least one is searched, in nats for each word of a text, and the steps of the search.
const LOWEST_GAIN: f64 = 1e-12;
const HIGHEST_GAIN: f64 = 1.0;
const STEPS: u32 = 16;
/// Choices, each with the weights that the rows have after the previous choice.
const PASSES: u32 = 3;

/// Returns the rows and entries of pairs, and the contexts and entries of threes, in at most `room` bytes.
pub fn build(mixture: Mixture, alone: &BTreeMap<u32, f64>, room: usize) -> [Vec<u8>; 4] {
    let Mixture {
        pairs: rows,
        threes: contexts,
    } = chosen(mixture, alone, room);
    let (mut row_heads, mut pairs) = (Vec::new(), Vec::new());
    let mut row_of: BTreeMap<u32, u32> = BTreeMap::new();
    let mut places: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for (&before, row) in &rows {
        row_of.insert(before, row_of.len() as u32);
        for entry in &row.entries {
            places.insert((before, entry.node), places.len() as u32);
        }
        write(before, row, &mut row_heads, &mut pairs);
    }
    head(&mut row_heads, LAST, u8::MAX, pairs.len());
    let (mut context_heads, mut threes) = (Vec::new(), Vec::new());
    for ((earlier, before), Context { row, .. }) in &contexts {
        let place = places[&(*earlier, *before)];
        write(place, row, &mut context_heads, &mut threes);
        let shorter = row_of.get(before).copied().unwrap_or(NO_ROW.0);
        context_heads.extend(shorter.to_le_bytes());
    }
    head(&mut context_heads, LAST, u8::MAX, threes.len());
    context_heads.extend([0; CONTEXT_BYTES - ROW_BYTES]);
    [row_heads, pairs, context_heads, threes]
}

fn write(key: u32, row: &Row, heads: &mut Vec<u8>, entries: &mut Vec<u8>) {
    head(heads, key, quantize(ln(row.weight)), entries.len());
    for entry in &row.entries {
        let entry = entry.node << 8 | u32::from(quantize(ln(entry.probability)));
        entries.extend(entry.to_le_bytes());
    }
}

fn head(heads: &mut Vec<u8>, key: u32, weight: u8, start: usize) {
    heads.extend((key << 8 | u32::from(weight)).to_le_bytes());
    heads.extend(((start / ENTRY_BYTES) as u32).to_le_bytes());
}

/// Leaves out what gains least by entry, until the rest has room.
fn chosen(mut mixture: Mixture, alone: &BTreeMap<u32, f64>, room: usize) -> Mixture {
    if bytes(&mixture, f64::NEG_INFINITY) <= room {
        return mixture;
    }
    let mut least = least_gain(&mixture, room);
    for _ in 1..PASSES {
        let contexts = mixture.threes.values_mut();
        let threes = contexts.map(|context| &mut context.row);
        for row in mixture.pairs.values_mut().chain(threes) {
            row.weigh(|entry, weight| entry.gain(weight) >= least);
        }
        least = least_gain(&mixture, room);
    }
    let Mixture {
        mut pairs,
        mut threes,
    } = mixture;
    threes.retain(|_, context| is_kept(context, least));
    for (&before, row) in &mut pairs {
        let is_context = |node| threes.contains_key(&(before, node));
        row.keep(|entry, weight| entry.gain(weight) >= least || is_context(entry.node));
    }
    pairs.retain(|_, row| !row.entries.is_empty());
    for (&(_, before), context) in &mut threes {
        context
            .row
            .keep(|entry, weight| entry.gain(weight) >= least);
        let alone = |node: u32| alone.get(&node).copied().unwrap_or(0.0);
        context.row.stand_on(|node| match pairs.get(&before) {
            Some(row) => row.probability(node, alone(node)),
            None => alone(node),
        });
    }
    Mixture { pairs, threes }
}

/// Returns the least gain with which the rest has room.
fn least_gain(mixture: &Mixture, room: usize) -> f64 {
    let (mut too_low, mut least) = (LOWEST_GAIN, HIGHEST_GAIN);
    for _ in 0..STEPS {
        let middle = (too_low * least).sqrt();
        if bytes(mixture, middle) <= room {
            least = middle;
        } else {
            too_low = middle;
        }
    }
    least
}

/// Returns the bytes of what gains at least this by entry.
fn bytes(mixture: &Mixture, least: f64) -> usize {
    let row = |head: usize, row: &Row| match row.gains().filter(|&gain| gain >= least).count() {
        0 => 0,
        count => head + ENTRY_BYTES * count,
    };
    let pairs = mixture.pairs.values().map(|pairs| row(ROW_BYTES, pairs));
    let contexts = mixture
        .threes
        .iter()
        .filter(|(_, context)| is_kept(context, least));
    let threes = contexts.map(|((earlier, _), context)| {
        // With the row of its pair, if that has nothing else.
        let weight = mixture.pairs[earlier].weight;
        let has_pair = context.pair.gain(weight) >= least;
        let pair = if has_pair { 0 } else { ROW_BYTES + ENTRY_BYTES };
        row(CONTEXT_BYTES, &context.row) + pair
    });
    pairs.sum::<usize>() + threes.sum::<usize>() + ROW_BYTES + CONTEXT_BYTES
}

/// Returns `true` if the entries of a context gain enough for its own bytes, too.
fn is_kept(context: &Context, least: f64) -> bool {
    let surplus = context.row.gains().map(|gain| gain - least);
    let surplus: f64 = surplus.filter(|&gain| gain >= 0.0).sum();
    surplus >= least * (CONTEXT_BYTES / ENTRY_BYTES) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::arpa::Other;
    use crate::build::counts::Counts;
    use crate::build::mixture::mix;
    use crate::build::trie::Indices;

    #[test]
    fn what_has_no_room_is_what_saves_least() {
        let mut counts = Counts::default();
        // `san` is always in front of `jose`; the others are in any order.
        for (index, name) in ["anna", "ben", "carl", "dora"]
            .iter()
            .cycle()
            .take(40)
            .enumerate()
        {
            let other = ["anna", "ben", "carl", "dora"][index / 4 % 4];
            counts.sentence(&format!("{name} {other} saw san jose"));
        }
        let words = counts.words();
        let indices: Indices = words.keys().map(String::as_str).zip(1..).collect();
        let alone: BTreeMap<u32, f64> = indices
            .iter()
            .map(|(&word, &node)| (node, words[word].probability))
            .collect();
        let mixture = || mix(&counts, &indices, &Other::default(), &alone);
        let everything = bytes(&mixture(), f64::NEG_INFINITY);
        for room in [60, 100, everything / 2, everything - 1] {
            let kept = chosen(mixture(), &alone, room);
            let sections = build(mixture(), &alone, room);
            let size: usize = sections.iter().map(Vec::len).sum();
            assert!(size <= room, "{size} of {room} bytes");
            let after_san = &kept.pairs[&indices["san"]].entries;
            assert_eq!(after_san.len(), 1, "{room} bytes");
            assert_eq!(after_san[0].node, indices["jose"], "{room} bytes");
            // The weight of a row stands for what was left out.
            for row in kept.pairs.values() {
                let inside: f64 = row.entries.iter().map(|entry| entry.probability).sum();
                let nodes: Vec<u32> = row.entries.iter().map(|entry| entry.node).collect();
                let others = alone.iter().filter(|(node, _)| !nodes.contains(node));
                let outside: f64 = others
                    .map(|(_, probability)| row.weight * probability)
                    .sum();
                assert!(
                    (inside + outside - 1.0).abs() < 1e-6,
                    "{}",
                    inside + outside
                );
            }
        }
        let sections = build(mixture(), &alone, everything);
        assert_eq!(sections.iter().map(Vec::len).sum::<usize>(), everything);
    }
}

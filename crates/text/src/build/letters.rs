//! The automaton of spelling.

use std::collections::BTreeMap;

use super::{Words, ln};
use crate::logarithm::quantize;
use crate::model::alphabet::{Alphabet, Symbol};

/// The most letters before the next one.
const ORDER: usize = 4;
/// The fewest different words in which a state of the most letters is seen.
const MIN_WORDS: u32 = 60;
/// The letter before the first one.
const BEFORE: Symbol = 0xff;

/// The counts of the letters that follow some letters.
#[derive(Default)]
struct Context {
    words: u32,
    total: f64,
    next: BTreeMap<Symbol, f64>,
}

type Contexts = BTreeMap<(usize, Vec<Symbol>), Context>;

/// Returns the states and the arcs.
pub fn build(words: &Words, alphabet: &Alphabet) -> (Vec<u8>, Vec<u8>) {
    let end = alphabet.len() as Symbol;
    let mut contexts = count(words, alphabet, end);
    contexts.retain(|(length, _), context| *length < 2 || context.words >= MIN_WORDS);
    close_under_suffixes(&mut contexts);
    // The order of the map is by length first, so that a state of one letter less lies before.
    let names: BTreeMap<&Vec<Symbol>, u16> = {
        let mut order: Vec<&Vec<Symbol>> = contexts.keys().map(|(_, letters)| letters).collect();
        // The start of a word is the second state.
        order.sort_by_key(|letters| (letters.len(), ***letters != [BEFORE], (*letters).clone()));
        let indices = 0_u16..;
        order.into_iter().zip(indices).collect()
    };
    let mut ordered: Vec<(&Vec<Symbol>, &Context)> = contexts
        .iter()
        .map(|((_, letters), context)| (letters, context))
        .collect();
    ordered.sort_by_key(|(letters, _)| names[letters]);
    let (mut states, mut arcs) = (Vec::new(), Vec::<u8>::new());
    for (letters, context) in ordered {
        let types = context.next.len() as f64;
        let weight = types / (types + f64::from(context.words));
        let shorter = letters
            .get(1..)
            .map_or(0, |letters| names[&letters.to_vec()]);
        let start = (arcs.len() / 4) as u32;
        states.extend((start << 8 | u32::from(quantize(ln(weight)))).to_le_bytes());
        states.extend(shorter.to_le_bytes());
        let symbols: Vec<Symbol> = if letters.is_empty() {
            (0..=end).collect()
        } else {
            context.next.keys().copied().collect()
        };
        for symbol in symbols {
            let probability = probability(&contexts, letters, symbol, f64::from(end) + 1.0);
            arcs.extend([symbol, quantize(ln(probability))]);
            arcs.extend(next(&names, letters, symbol).to_le_bytes());
        }
    }
    states.extend((((arcs.len() / 4) as u32) << 8).to_le_bytes());
    states.extend([0; 2]);
    (states, arcs)
}

fn count(words: &Words, alphabet: &Alphabet, end: Symbol) -> Contexts {
    let mut contexts = Contexts::new();
    for (word, entry) in words {
        let weight = entry.probability.sqrt();
        let mut symbols = vec![BEFORE];
        symbols.extend(word.chars().filter_map(|letter| alphabet.symbol(letter)));
        symbols.push(end);
        for position in 1..symbols.len() {
            for length in 0..=ORDER.min(position) {
                let letters = symbols[position - length..position].to_vec();
                let context = contexts.entry((length, letters)).or_default();
                context.words += 1;
                context.total += weight;
                *context.next.entry(symbols[position]).or_default() += weight;
            }
        }
    }
    contexts
}

/// Removes the contexts whose own suffix is gone.
fn close_under_suffixes(contexts: &mut Contexts) {
    for length in 1..=ORDER {
        let gone: Vec<_> = contexts
            .keys()
            .filter(|key| {
                key.0 == length && !contexts.contains_key(&(length - 1, key.1[1..].to_vec()))
            })
            .cloned()
            .collect();
        for key in gone {
            contexts.remove(&key);
        }
    }
}

fn probability(contexts: &Contexts, letters: &[Symbol], symbol: Symbol, symbols: f64) -> f64 {
    let shorter = match letters.get(1..) {
        Some(shorter) => probability(contexts, shorter, symbol, symbols),
        None => 1.0 / symbols,
    };
    let Some(context) = contexts.get(&(letters.len(), letters.to_vec())) else {
        return shorter;
    };
    let types = context.next.len() as f64;
    let weight = types / (types + f64::from(context.words));
    // The words of a list may have a weight of 0.
    if context.total <= 0.0 {
        return shorter;
    }
    let seen = context.next.get(&symbol).copied().unwrap_or(0.0) / context.total;
    (1.0 - weight) * seen + weight * shorter
}

/// Returns the state of the longest known end of the letters and the next one.
fn next(names: &BTreeMap<&Vec<Symbol>, u16>, letters: &[Symbol], symbol: Symbol) -> u16 {
    let mut longest = letters.to_vec();
    longest.push(symbol);
    while longest.len() > ORDER || !longest.is_empty() && !names.contains_key(&longest) {
        longest.remove(0);
    }
    names[&longest]
}

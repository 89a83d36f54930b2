//! Language models in the ARPA format, which SRILM, KenLM and other programs write: logarithms to the base 10 of the probabilities of
//! words, pairs and threes, and of the weights of what is shorter.

use std::collections::BTreeMap;
use std::f64::consts::LN_10;
use std::str::SplitAsciiWhitespace;

use super::counts::spelling;
use super::trie::Indices;
use super::{LineError, Words};
use crate::logarithm::exp;
use crate::model::lexicon::ROOT;

/// The token for the start of a sentence.
const START: &str = "<s>";
/// The most words in a row.
const ORDER: usize = 3;

/// Logarithms to the base 10 of a probability, and of the weight of what is shorter.
#[derive(Clone, Copy, Debug)]
struct Logarithms {
    probability: f32,
    weight: f32,
}

/// A model in the ARPA format, with words as numbers.
#[derive(Clone, Debug, Default)]
pub struct Arpa {
    words: Vec<(String, Logarithms)>,
    pairs: Vec<([usize; 2], Logarithms)>,
    threes: Vec<([usize; 3], Logarithms)>,
}

impl Arpa {
    /// Reads a model. What has more than three words is passed over.
    ///
    /// # Errors
    ///
    /// Fails at the first line that does not belong to the format.
    pub fn read(text: &str) -> Result<Self, LineError> {
        let mut arpa = Self::default();
        let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
        let mut order = 0;
        for (index, line) in text.lines().enumerate() {
            let at_line = |fault| LineError {
                line: index + 1,
                fault,
            };
            if let Some(section) = line.strip_prefix('\\') {
                let digits = section.trim_end().strip_suffix("-grams:");
                order = digits.map_or(0, |digits| digits.parse().unwrap_or(0));
            } else if (1..=ORDER).contains(&order) && !line.trim().is_empty() {
                let (tokens, logarithms) = entry(line, order).map_err(at_line)?;
                let number = |token| {
                    let found = numbers.get(token).copied();
                    found.ok_or_else(|| at_line("it has a word that is not among the 1-grams"))
                };
                match tokens {
                    [word, "", ""] => {
                        numbers.insert(word, arpa.words.len());
                        arpa.words.push((word.to_owned(), logarithms));
                    }
                    [before, word, ""] => {
                        let words = [number(before)?, number(word)?];
                        arpa.pairs.push((words, logarithms));
                    }
                    [earlier, before, word] => {
                        let words = [number(earlier)?, number(before)?, number(word)?];
                        arpa.threes.push((words, logarithms));
                    }
                }
            }
        }
        if arpa.words.is_empty() {
            return Err(LineError {
                line: text.lines().count().max(1),
                fault: "the text ends without 1-grams, so it is not a language model in the ARPA format",
            });
        }
        Ok(arpa)
    }

    /// Returns the probabilities of its words that are among the given ones, scaled to a sum of 1.
    pub fn alone(&self, words: &Words) -> BTreeMap<String, f64> {
        let mut alone: BTreeMap<String, f64> = BTreeMap::new();
        for (word, stored) in &self.words {
            let known = spelling(word).filter(|(key, _)| words.contains_key(key));
            if let Some((key, _)) = known {
                *alone.entry(key).or_default() += power(stored.probability);
            }
        }
        let total: f64 = alone.values().sum();
        for probability in alone.values_mut() {
            *probability /= total;
        }
        alone
    }
}

/// Returns the words of a line, and what it says of them.
fn entry(line: &str, order: usize) -> Result<([&str; ORDER], Logarithms), &'static str> {
    let number = |fields: &mut SplitAsciiWhitespace| {
        let value: Option<f32> = fields.next()?.parse().ok();
        value.filter(|value| value.is_finite())
    };
    let mut fields = line.split_ascii_whitespace();
    let probability = number(&mut fields).filter(|&value| value <= 0.0);
    let probability = probability.ok_or("it does not start with a logarithm of at most 0")?;
    let mut tokens = [""; ORDER];
    for token in &mut tokens[..order] {
        *token = fields.next().ok_or("it has too few words")?;
    }
    let weight = if fields.clone().next().is_some() {
        number(&mut fields)
            .ok_or("the weight at its end is not a number, or it has too many words")?
    } else {
        0.0
    };
    Ok((
        tokens,
        Logarithms {
            probability,
            weight,
        },
    ))
}

fn power(logarithm: f32) -> f64 {
    exp((f64::from(logarithm) * LN_10).clamp(-230.0, 230.0))
}

/// The probabilities of a model for the words of a lexicon, given by their nodes; the root is the start of a sentence.
#[derive(Debug, Default)]
pub struct Other {
    /// The probability of each word, and the weight of words alone after it.
    alone: BTreeMap<u32, (f64, f64)>,
    pairs: BTreeMap<(u32, u32), (f64, f64)>,
    threes: BTreeMap<(u32, u32, u32), f64>,
}

impl Other {
    /// Keeps the words of a lexicon. Of two spellings that differ in case only, the one in lower case counts.
    pub fn new(arpa: &Arpa, indices: &Indices) -> Self {
        let mut nodes: Vec<Option<u32>> = Vec::new();
        let mut spelled_lower: BTreeMap<u32, usize> = BTreeMap::new();
        for (index, (word, _)) in arpa.words.iter().enumerate() {
            let key = spelling(word).map(|(key, _)| key).unwrap_or_default();
            let found = indices.get(key.as_str()).copied();
            if let Some(found) = found.filter(|_| key == *word) {
                spelled_lower.insert(found, index);
            }
            nodes.push(if word == START { Some(ROOT) } else { found });
        }
        let node = |index: usize| {
            let found = nodes[index]?;
            let lower = spelled_lower.get(&found).copied().unwrap_or(index);
            (lower == index).then_some(found)
        };
        let both = |stored: &Logarithms| (power(stored.probability), power(stored.weight));
        let alone = arpa.words.iter().enumerate();
        let pairs = arpa.pairs.iter();
        let threes = arpa.threes.iter();
        Self {
            alone: alone
                .filter_map(|(index, (_, stored))| Some((node(index)?, both(stored))))
                .collect(),
            pairs: pairs
                .filter_map(|&([before, word], stored)| {
                    Some(((node(before)?, node(word)?), both(&stored)))
                })
                .collect(),
            threes: threes
                .filter_map(|&([earlier, before, word], stored)| {
                    let words = (node(earlier)?, node(before)?, node(word)?);
                    Some((words, power(stored.probability)))
                })
                .collect(),
        }
    }

    /// Returns `true` if the model has a word.
    pub fn has(&self, node: u32) -> bool {
        self.alone.contains_key(&node)
    }

    /// Returns the probability of a word by itself.
    pub fn alone(&self, word: u32) -> f64 {
        self.alone.get(&word).map_or(0.0, |alone| alone.0)
    }

    /// Returns the probability of a word after another one.
    pub fn pair(&self, before: u32, word: u32) -> f64 {
        match self.pairs.get(&(before, word)) {
            Some(pair) => pair.0,
            None => self.alone.get(&before).map_or(1.0, |alone| alone.1) * self.alone(word),
        }
    }

    /// Returns the probability of a word after two others.
    pub fn three(&self, earlier: u32, before: u32, word: u32) -> f64 {
        match self.threes.get(&(earlier, before, word)) {
            Some(&three) => three,
            None => {
                let weight = self
                    .pairs
                    .get(&(earlier, before))
                    .map_or(1.0, |pair| pair.1);
                weight * self.pair(before, word)
            }
        }
    }

    /// Returns the pairs that the model has.
    pub fn pairs(&self) -> impl Iterator<Item = (u32, u32)> {
        self.pairs.keys().copied()
    }

    /// Returns the threes that the model has.
    pub fn threes(&self) -> impl Iterator<Item = (u32, u32, u32)> {
        self.threes.keys().copied()
    }
}

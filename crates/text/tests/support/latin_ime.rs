//! A competitor of the decoder: a search in the lexicon with the published weights of LatinIME, the keyboard of Android, from which
//! AnySoftKeyboard and other open keyboards took their scoring.
//!
//! Taken over are the constants below (`scoring_params.cpp` of LatinIME, Apache-2.0) and their meaning: a hypothesis is a node of
//! the lexicon with a sum of costs, each error costs a constant, the place of a tap costs its squared distance from the key in key
//! widths, and a word costs the more the rarer it is, on a logarithmic scale from 0 to 1. The code is not taken over.
//!
//! Left out is what the published table does not contain: cheaper and dearer variants for first, last and doubled letters, the costs of
//! neighboring keys (here a letter costs its distance or a substitution, the lesser of both), the sweet spots of keys, surplus
//! spaces, completions, pairs of words, and the threshold below which the typed word stays. As with the other competitors, the
//! best word is always taken.

use ademan_text::{Keyboard, Tap};

use super::baselines::read_words;
use super::session::Phrase;

/// The most hypotheses that remain after a tap.
const LIVE_NODES: usize = 310;
/// The cost of a squared distance of one key width.
const DISTANCE: f32 = 0.1524;
/// The cost of the rarest word.
const LANGUAGE: f32 = 1.1214;
/// The cost of a letter without a tap.
const OMISSION: f32 = 0.467;
/// The cost of a tap without a letter.
const INSERTION: f32 = 0.7248;
/// The cost of two letters in the wrong order.
const TRANSPOSITION: f32 = 0.5608;
/// The cost of another letter.
const SUBSTITUTION: f32 = 0.3806;
/// The cost of two words without a space.
const MISSING_SPACE: f32 = 0.1;

/// A node of the lexicon.
#[derive(Default)]
struct Node {
    /// Keys of letters with the indices of their nodes.
    children: Vec<(usize, usize)>,
    /// The index of the word that ends here.
    word: Option<usize>,
}

/// A prefix of a word that explains the taps so far.
#[derive(Clone, Copy)]
struct Hypothesis {
    cost: f32,
    node: usize,
    /// The index of the word before it in [`Search::finished`], if a space is missing.
    before: Option<usize>,
}

impl Hypothesis {
    fn prefix(self) -> (usize, Option<usize>) {
        (self.node, self.before)
    }
}

/// The hypotheses that explain the same number of taps.
struct Level {
    live: Vec<Hypothesis>,
    /// The cost at and above which a hypothesis is dropped.
    limit: f32,
}

impl Level {
    fn push(&mut self, hypothesis: Hypothesis) {
        if hypothesis.cost >= self.limit {
            return;
        }
        self.live.push(hypothesis);
        if self.live.len() >= 4 * LIVE_NODES {
            self.prune();
        }
    }

    /// Keeps the cheapest hypotheses, each prefix once.
    fn prune(&mut self) {
        self.live.sort_unstable_by(|a, b| {
            let order = a.prefix().cmp(&b.prefix());
            order.then(a.cost.total_cmp(&b.cost))
        });
        self.live.dedup_by_key(|it| it.prefix());
        self.live.sort_unstable_by(|a, b| a.cost.total_cmp(&b.cost));
        self.live.truncate(LIVE_NODES);
        if self.live.len() == LIVE_NODES {
            self.limit = self.live[LIVE_NODES - 1].cost;
        }
    }
}

/// The lexicon with the weights.
pub struct LatinIme {
    /// The root first.
    nodes: Vec<Node>,
    /// Words with their costs.
    words: Vec<(String, f32)>,
    keyboard: Keyboard,
    /// The width of a letter key.
    width: f32,
}

impl LatinIme {
    /// Builds the lexicon from words and the natural logarithms of their probabilities. Leaves out words that the keyboard cannot type.
    pub fn new(words: Vec<(String, f32)>, keyboard: &Keyboard) -> Self {
        let probabilities = words.iter().map(|(_, log_probability)| *log_probability);
        let best = probabilities.clone().fold(f32::NEG_INFINITY, f32::max);
        let worst = probabilities.fold(f32::INFINITY, f32::min);
        let mut keys = keyboard.keys().iter();
        let letter = keys.find(|key| key.character.is_alphabetic());
        let mut lexicon = Self {
            nodes: vec![Node::default()],
            words: Vec::new(),
            keyboard: keyboard.clone(),
            width: letter.map_or(1.0, |key| key.size[0]),
        };
        for (word, log_probability) in words {
            let rarity = (best - log_probability) / (best - worst).max(f32::MIN_POSITIVE);
            lexicon.add(word, LANGUAGE * rarity);
        }
        lexicon
    }

    fn add(&mut self, word: String, cost: f32) {
        let letters = word.chars();
        let keys: Option<Vec<usize>> = letters.map(|it| self.keyboard.index(it)).collect();
        let mut node = 0;
        for key in keys.unwrap_or_default() {
            let mut children = self.nodes[node].children.iter();
            let known = children.find(|child| child.0 == key).map(|child| child.1);
            node = known.unwrap_or_else(|| {
                let child = self.nodes.len();
                self.nodes[node].children.push((key, child));
                self.nodes.push(Node::default());
                child
            });
        }
        if node > 0 {
            self.nodes[node].word = Some(self.words.len());
            self.words.push((word, cost));
        }
    }

    /// Returns the best word for taps, or words if spaces between them are missing; `None` without a word that fits.
    pub fn word(&self, taps: &[Tap]) -> Option<String> {
        let costs: Vec<Vec<f32>> = taps.iter().map(|tap| self.letters(tap)).collect();
        let level = || Level {
            live: Vec::new(),
            limit: f32::INFINITY,
        };
        let mut search = Search {
            lexicon: self,
            costs: &costs,
            levels: (0..=taps.len()).map(|_| level()).collect(),
            finished: Vec::new(),
        };
        search.levels[0].push(Hypothesis {
            cost: 0.0,
            node: 0,
            before: None,
        });
        for index in 0..taps.len() {
            search.step(index);
        }
        search.best()
    }

    /// Returns the cost of the letter of each key, if this tap was meant for it.
    fn letters(&self, tap: &Tap) -> Vec<f32> {
        let keys = self.keyboard.keys().iter();
        let cost = keys.map(|key| {
            let apart = |axis: usize| (tap.position[axis] - key.center[axis]) / self.width;
            (DISTANCE * (apart(0).powi(2) + apart(1).powi(2))).min(SUBSTITUTION)
        });
        cost.collect()
    }

    /// Reads a phrase: words end where the nearest key is no letter.
    pub fn read(&self, phrase: &Phrase) -> String {
        read_words(&self.keyboard, phrase, |taps, nearest| {
            self.word(taps).unwrap_or_else(|| nearest.to_owned())
        })
    }
}

/// The search for the word of some taps.
struct Search<'a> {
    lexicon: &'a LatinIme,
    /// The costs of letters for each tap.
    costs: &'a [Vec<f32>],
    /// The hypotheses by the number of taps that they explain.
    levels: Vec<Level>,
    /// Words after which a space is missing, each with the index of the word before it.
    finished: Vec<(usize, Option<usize>)>,
}

impl Search<'_> {
    /// Extends the hypotheses at a tap by this tap.
    fn step(&mut self, index: usize) {
        self.levels[index].prune();
        let live = std::mem::take(&mut self.levels[index].live);
        for from in live {
            self.explain(from, index);
            if let Some(word) = self.lexicon.nodes[from.node].word {
                self.begin_word(from, word, index);
            }
        }
    }

    fn explain(&mut self, from: Hypothesis, index: usize) {
        let nodes = &self.lexicon.nodes;
        let here = &self.costs[index];
        let to = |cost: f32, node: usize| Hypothesis {
            cost: from.cost + cost,
            node,
            before: from.before,
        };
        self.levels[index + 1].push(to(INSERTION, from.node));
        for &(key, child) in &nodes[from.node].children {
            self.levels[index + 1].push(to(here[key], child));
            for &(next_key, next) in &nodes[child].children {
                self.levels[index + 1].push(to(OMISSION + here[next_key], next));
                if let Some(behind) = self.costs.get(index + 1) {
                    let cost = TRANSPOSITION + here[next_key] + behind[key];
                    self.levels[index + 2].push(to(cost, next));
                }
            }
        }
    }

    /// Ends a word, and explains the tap by the first letter of another word: the space between them is missing.
    fn begin_word(&mut self, from: Hypothesis, word: usize, index: usize) {
        let lexicon = self.lexicon;
        let cost = from.cost + lexicon.words[word].1 + MISSING_SPACE;
        let before = Some(self.finished.len());
        self.finished.push((word, from.before));
        for &(key, child) in &lexicon.nodes[0].children {
            self.levels[index + 1].push(Hypothesis {
                cost: cost + self.costs[index][key],
                node: child,
                before,
            });
        }
    }

    /// Returns the text of the cheapest hypothesis that is a word, perhaps without its last letter.
    fn best(mut self) -> Option<String> {
        let LatinIme { nodes, words, .. } = self.lexicon;
        let last = self.levels.pop()?;
        let mut best: Option<(f32, usize, Option<usize>)> = None;
        for it in &last.live {
            let children = nodes[it.node].children.iter();
            let longer = children.map(|&(_, child)| (child, it.cost + OMISSION));
            for (node, cost) in longer.chain([(it.node, it.cost)]) {
                let Some(word) = nodes[node].word else {
                    continue;
                };
                let total = cost + words[word].1;
                if best.is_none_or(|(cheapest, ..)| total < cheapest) {
                    best = Some((total, word, it.before));
                }
            }
        }
        let (_, found, mut before) = best?;
        let mut text = words[found].0.clone();
        while let Some(index) = before {
            let (earlier, previous) = self.finished[index];
            text = format!("{} {text}", words[earlier].0);
            before = previous;
        }
        Some(text)
    }
}

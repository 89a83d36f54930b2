//! The search for the words of a path in the lexicon.

use arrayvec::ArrayVec;

use super::path::{MAX_SAMPLES, Samples, direction, distance};
use crate::keyboard::{Keyboard, Millimetres};
use crate::model::Model;
use crate::model::alphabet::{Symbol, plain};
use crate::model::bigrams::Row;
use crate::model::lexicon::ROOT;

/// The number of words that a search returns.
const WORDS: usize = 3;
/// The most letters of a word.
const MAX_LETTERS: usize = 32;
/// The standard deviation of a letter's point from its key, as a fraction of the width of a key.
const LETTER_DEVIATION: f32 = 0.4;
/// The standard deviation of the points between from the line between two keys, as a fraction of the width of a key.
const LINE_DEVIATION: f32 = 0.4;
/// The length of a path, in widths of a key, that is worth as much as one letter: neighboring points deviate together.
const LINE_LENGTH: f32 = 1.5;
/// The cost of a path at a right angle to a line, for the same length; the opposite direction costs twice as much.
const TURN: f32 = 3.0;
/// The log-probability of a word with an apostrophe, which the finger passes over.
const APOSTROPHE: f32 = -0.7;
/// The most that the log-probability of a word gains after the words before.
const GAIN: f32 = 8.0;
/// The costs up to which words are looked for, one after another until enough are found. Words that fit a path worse are not meant.
const LIMITS: [f32; 4] = [20.0, 35.0, 60.0, 100.0];
/// The most rows of one search: bounds its time.
const MAX_ROWS: u32 = 60_000;

/// A word that explains a path.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// The log-probability.
    pub score: f32,
    /// The node.
    pub node: u32,
    /// The letters.
    pub letters: ArrayVec<Symbol, MAX_LETTERS>,
}

/// The memory of the search for the words of a path.
#[derive(Clone, Debug)]
pub struct Swipes {
    /// By symbol, the index of the key of a letter among the keys of letters.
    keys: Vec<Option<u8>>,
    key_count: usize,
    apostrophe: Option<Symbol>,
    samples: Samples,
    /// By key and sample, the cost of a letter at that sample.
    at: Vec<f32>,
    /// By two keys and sample, the cost of a sample between two letters.
    along: Vec<f32>,
    /// By number of letters and sample, the lowest cost of the path until the sample, with the last letter there.
    rows: Vec<f32>,
    letters: ArrayVec<Symbol, MAX_LETTERS>,
    found: ArrayVec<Found, { WORDS + 1 }>,
    limit: f32,
    row_count: u32,
}

/// The parts of a search that do not change.
struct Context<'a, 'm> {
    model: &'a Model<'m>,
    language: f32,
    row: Row,
}

/// The place of a search: letters with a point of their own, and the key of the last one.
#[derive(Clone, Copy)]
struct Place {
    node: u32,
    depth: usize,
    key: usize,
    /// The lowest cost of the row.
    floor: f32,
}

impl Swipes {
    /// Makes room for the paths on a keyboard.
    pub fn new(model: &Model, keyboard: &Keyboard) -> Self {
        let mut known: Vec<usize> = Vec::new();
        let apostrophe = model.alphabet.symbol('\'');
        let letters = model.alphabet.letters().iter();
        // A letter of another layer has no key to pass over, but its plain letter may have one.
        let placed = |letter: char| {
            let index = keyboard.index(letter)?;
            keyboard.keys()[index].has_place().then_some(index)
        };
        let keys: Vec<Option<u8>> = letters
            .map(|&letter| {
                let key = placed(letter).or_else(|| placed(plain(letter)))?;
                if letter == '\'' {
                    return None;
                }
                let index = known.iter().position(|&other| other == key);
                let index = index.unwrap_or_else(|| {
                    known.push(key);
                    known.len() - 1
                });
                u8::try_from(index).ok()
            })
            .collect();
        let count = known.len();
        Self {
            keys,
            key_count: count,
            apostrophe,
            samples: Samples::default(),
            at: vec![0.0; count * MAX_SAMPLES],
            along: vec![0.0; count * count * MAX_SAMPLES],
            rows: vec![0.0; MAX_LETTERS * MAX_SAMPLES],
            letters: ArrayVec::new(),
            found: ArrayVec::new(),
            limit: 0.0,
            row_count: 0,
        }
    }

    /// Finds the words that best explain a path after the words of a row, the best first. `center` gives where a letter is aimed at.
    pub fn find(
        &mut self,
        (model, language, row): (&Model, f32, Row),
        path: &[Millimetres],
        (center, width): (impl Fn(char) -> Option<Millimetres>, f32),
    ) -> &[Found] {
        self.found.clear();
        self.samples.set(path);
        if self.samples.points.is_empty() {
            return &self.found;
        }
        self.set_costs(model, center, width);
        let context = Context {
            model,
            language,
            row,
        };
        self.row_count = 0;
        for limit in LIMITS {
            self.limit = limit;
            self.found.clear();
            self.letters.clear();
            self.search(&context);
            if self.found.len() == WORDS || self.row_count >= MAX_ROWS {
                break;
            }
        }
        &self.found
    }

    /// Fills the tables of costs for the samples.
    fn set_costs(
        &mut self,
        model: &Model,
        center: impl Fn(char) -> Option<Millimetres>,
        width: f32,
    ) {
        let mut centers = [[f32::NAN; 2]; u8::MAX as usize];
        for (&letter, key) in model.alphabet.letters().iter().zip(&self.keys) {
            let aimed = center(letter).or_else(|| center(plain(letter)));
            if let Some((key, aimed)) = key.zip(aimed) {
                centers[usize::from(key)] = aimed;
            }
        }
        let scale = |deviation: f32| 0.5 / (deviation * width).powi(2);
        let letter_scale = scale(LETTER_DEVIATION);
        let line_scale = scale(LINE_DEVIATION);
        let part = (self.samples.spacing / (LINE_LENGTH * width)).min(1.0);
        let centers = &centers[..self.key_count];
        for (from, &start) in centers.iter().enumerate() {
            for (sample, &point) in self.samples.points.iter().enumerate() {
                self.at[from * MAX_SAMPLES + sample] =
                    letter_scale * distance(start, point).powi(2);
            }
            for (to, &end) in centers.iter().enumerate() {
                let base = (from * self.key_count + to) * MAX_SAMPLES;
                let towards = direction(start, end);
                let samples = self.samples.points.iter().zip(&self.samples.directions);
                for (sample, (&point, along)) in samples.enumerate() {
                    let apart = line_scale * square_from_line(point, start, end);
                    let turned = 1.0 - (towards[0] * along[0] + towards[1] * along[1]);
                    self.along[base + sample] = part * (apart + TURN * turned);
                }
            }
        }
    }

    /// Returns the costs of the samples between two keys.
    fn between(&self, from: usize, to: usize) -> &[f32] {
        let base = (from * self.key_count + to) * MAX_SAMPLES;
        &self.along[base..base + self.samples.points.len()]
    }

    fn search(&mut self, context: &Context) {
        let lexicon = &context.model.lexicon;
        for node in lexicon.children(ROOT) {
            let contents = lexicon.node(node);
            let Some(key) = self.key(contents.symbol()) else {
                continue;
            };
            let floor = self.first_row(key);
            let place = Place {
                node,
                depth: 1,
                key,
                floor,
            };
            self.enter(context, place, contents.symbol());
        }
    }

    fn key(&self, symbol: Symbol) -> Option<usize> {
        self.keys
            .get(usize::from(symbol))
            .copied()
            .flatten()
            .map(usize::from)
    }

    /// Fills the row of a first letter. Returns its lowest cost.
    fn first_row(&mut self, key: usize) -> f32 {
        self.row_count += 1;
        let count = self.samples.points.len();
        let at = &self.at[key * MAX_SAMPLES..][..count];
        let line = &self.along[(key * self.key_count + key) * MAX_SAMPLES..][..count];
        let (mut before, mut floor) = (0.0, f32::INFINITY);
        for ((row, &here), &passed) in self.rows.iter_mut().zip(at).zip(line) {
            *row = before + here;
            floor = row.min(floor);
            before += passed;
        }
        floor
    }

    /// Fills the row of one more letter. Returns its lowest cost.
    fn next_row(&mut self, place: &Place, key: usize) -> f32 {
        self.row_count += 1;
        let count = self.samples.points.len();
        let base = (place.key * self.key_count + key) * MAX_SAMPLES;
        let line = &self.along[base..base + count];
        let at = &self.at[key * MAX_SAMPLES..][..count];
        let (known, rest) = self.rows.split_at_mut(place.depth * MAX_SAMPLES);
        let known = &known[(place.depth - 1) * MAX_SAMPLES..][..count];
        let next = &mut rest[..count];
        // The lowest cost of the samples before, with the last of them on the line or at the letter before.
        let mut before = f32::INFINITY;
        let mut floor = f32::INFINITY;
        for (((cell, &entered), &here), &passed) in next.iter_mut().zip(known).zip(at).zip(line) {
            // Both letters may be at one sample, as a finger cuts corners.
            *cell = here + before.min(entered);
            floor = cell.min(floor);
            before = entered.min(before + passed);
        }
        floor
    }

    /// Adds the word of a node whose row is filled, and searches the nodes below it.
    fn enter(&mut self, context: &Context, place: Place, symbol: Symbol) {
        let contents = context.model.lexicon.node(place.node);
        if place.floor - context.language * contents.best() > self.limit
            || self.letters.try_push(symbol).is_err()
        {
            return;
        }
        if let Some(alone) = contents.word().filter(|_| place.depth > 1) {
            self.add(context, &place, alone);
        }
        for node in context.model.lexicon.children(place.node) {
            let child = context.model.lexicon.node(node);
            if place.floor - context.language * child.best() > self.limit
                || self.row_count >= MAX_ROWS
            {
                continue;
            }
            let letter = child.symbol();
            let next = Place { node, ..place };
            match self.key(letter) {
                None if Some(letter) == self.apostrophe => self.enter(context, next, letter),
                None => {}
                Some(key) if key == place.key => self.enter(context, next, letter),
                Some(_) if place.depth == MAX_LETTERS => {}
                Some(key) => {
                    let floor = self.next_row(&place, key);
                    let depth = place.depth + 1;
                    let entered = Place {
                        node,
                        depth,
                        key,
                        floor,
                    };
                    self.enter(context, entered, letter);
                }
            }
        }
        self.letters.pop();
    }

    /// Adds the word that ends at a place, if it is among the best.
    fn add(&mut self, context: &Context, place: &Place, alone: f32) {
        let row = &self.rows[(place.depth - 1) * MAX_SAMPLES..];
        let (mut tail, mut cost) = (0.0, f32::INFINITY);
        let rest = self.between(place.key, place.key);
        for (&until, &after) in row.iter().zip(rest).rev() {
            cost = cost.min(until + tail);
            tail += after;
        }
        if cost - context.language * (alone + GAIN).min(0.0) > self.limit {
            return;
        }
        let mut likely = context.model.bigrams.after(context.row, place.node, alone);
        if self.letters.iter().any(|it| Some(*it) == self.apostrophe) {
            likely += APOSTROPHE;
        }
        let score = context.language * likely - cost;
        if -score > self.limit {
            return;
        }
        let index = self.found.partition_point(|other| other.score >= score);
        self.found.insert(
            index,
            Found {
                score,
                node: place.node,
                letters: self.letters.clone(),
            },
        );
        self.found.truncate(WORDS);
        if let [.., worst] = &self.found[..]
            && self.found.len() == WORDS
        {
            self.limit = self.limit.min(-worst.score);
        }
    }
}

/// Returns the squared distance of a point from the line between two others.
fn square_from_line(point: Millimetres, start: Millimetres, end: Millimetres) -> f32 {
    let line = [end[0] - start[0], end[1] - start[1]];
    let from = [point[0] - start[0], point[1] - start[1]];
    let square = line[0] * line[0] + line[1] * line[1];
    let t = if square > 0.0 {
        ((from[0] * line[0] + from[1] * line[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let [x, y] = [from[0] - t * line[0], from[1] - t * line[1]];
    x * x + y * y
}

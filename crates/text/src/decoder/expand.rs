//! The expansion of one hypothesis by a tap into its successors.

use super::beam::Beam;
use super::likelihoods::Likelihoods;
use super::marks::{JOINT, is_punctuation, joins_words, punctuation};
use super::token::{From, Next, Parent, Place, Token};
use super::{GAIN, Options};

use super::touches::{ROUNDING, SLACK, Touches};
use crate::logarithm::{NATS_PER_STEP, nats};
use crate::model::Model;
use crate::model::alphabet::Symbol;
use crate::model::bigrams::NO_ROW;
use crate::model::branches::{Branch, LAST, Letters, bit};
use crate::model::lexicon::{Case, OWN, ROOT};
use crate::model::spelling::START;

/// The log-probability of each character of a word with digits or signs.
pub const ANY_CHARACTER: f32 = -3.2;
/// The log-probability of a closing quotation mark or a letter right after punctuation.
const RARE: f32 = -3.0;
/// The log-probability of more punctuation right after punctuation.
const DOUBLE: f32 = -5.0;
/// The log-probability of a second space.
const SECOND_SPACE: f32 = -7.0;
/// The additional cost of a spurious tap on the space bar, which a thumb rests on.
const SPURIOUS_SPACE: f32 = -7.0;
/// The additional cost of a spurious tap that types a digit or a sign with no letter near it, such as a character with Shift.
const SPURIOUS_SIGN: f32 = -8.0;

/// The step of one tap.
pub struct Expansion<'a, 'm> {
    pub model: &'a Model<'m>,
    pub options: &'a Options,
    pub touches: &'a Touches,
    pub beam: &'a mut Beam,
    /// The likelihoods of the tap for the hypothesis that is expanded.
    pub likelihoods: Likelihoods<'a>,
    /// The hypothesis that is expanded.
    pub parent: Token,
    pub apostrophe: Option<Symbol>,
    /// The key that was typed, and its character.
    pub typed: (usize, char),
    /// `true` if the character is neither a letter, a space nor punctuation.
    pub is_sign: bool,
    /// The additional cost of a spurious tap.
    pub spurious: f32,
    /// The part of a score for each stored log-probability.
    pub weights: &'a [f32; 256],
    /// The steps of a stored log-probability for a unit of the score.
    pub steps_per_weight: f32,
}

/// Returns the part of a score for each stored log-probability.
pub fn weights(options: &Options) -> [f32; 256] {
    std::array::from_fn(|byte| options.language * nats(byte as u8))
}

/// Returns the additional cost of a spurious tap that typed a character.
pub fn spurious_cost(touches: &Touches, character: char) -> f32 {
    if character == ' ' {
        SPURIOUS_SPACE
    } else if touches.near().iter().all(|near| near.symbol.is_none()) {
        SPURIOUS_SIGN
    } else {
        0.0
    }
}

/// Returns the log-probability that a word that is not in the lexicon ends.
pub fn spelling_end(model: &Model, options: &Options, state: u16, is_typed: bool) -> f32 {
    let end = options.language * model.spelling.end(state);
    if is_typed {
        end.max(options.letter)
    } else {
        end
    }
}

/// Returns the steps of a stored log-probability for a unit of the score; infinite without a language.
pub fn steps_per_weight(options: &Options) -> f32 {
    1.0 / (options.language * NATS_PER_STEP)
}

impl Expansion<'_, '_> {
    /// Adds the successors of a hypothesis with the tap.
    pub fn expand(&mut self, index: usize, token: &Token) {
        self.parent = *token;
        self.likelihoods.assume(&token.hands);
        let partial = Next::after(token, Parent::Last(index as u16));
        let mut nothing = partial;
        nothing.score += self.options.insertion + self.touches.stray();
        nothing.score += self.spurious;
        self.beam.push(nothing);
        match token.place {
            Place::Word(_) => self.word(&partial),
            Place::Gap => self.gap(&partial),
            Place::Typed(state) => self.spelled(&partial, state, true),
            Place::Spelled(state) => self.spelled(&partial, state, false),
            Place::Verbatim => self.verbatim(&partial),
        }
    }

    /// Returns `true` if a hypothesis can still be kept with a likely tap.
    pub(super) fn is_open(&self, score: f32) -> bool {
        score + self.touches.likeliest() + SLACK > self.beam.limit()
    }

    fn language(&self, nats: f32) -> f32 {
        self.options.language * nats
    }

    pub(super) fn best(&self, node: u32) -> f32 {
        self.weighted(self.model.lexicon.branch(node).best)
    }

    /// Returns the part of a score for a stored log-probability.
    pub(super) fn weighted(&self, byte: u8) -> f32 {
        self.weights[usize::from(byte)]
    }

    fn word(&mut self, partial: &Next) {
        let node = partial.node();
        if !self.is_open(partial.score) {
            return;
        }
        self.letters(partial);
        if let Some(ended) = self.end(partial)
            && self.is_open(ended.score + self.options.missing_space)
        {
            self.missing_space(&ended, node);
        }
        if node == ROOT {
            self.unknown(partial);
            if self.is_sign && !joins_words(self.typed.1) {
                let mut sign = *partial;
                sign.score += self.options.verbatim - self.best(node);
                self.verbatim(&sign);
            }
        }
        self.skips(partial);
    }

    /// Uses the tap as the next letter of a word.
    pub(super) fn letters(&mut self, partial: &Next) {
        let node = partial.node();
        let branch = self.model.lexicon.branch(node);
        let base = partial.score - self.weighted(branch.best);
        let letters = self.reachable(base, &branch);
        self.letters_below(partial, base, (node, &branch), letters);
        if node == ROOT {
            let own = self.model.lexicon.branch(OWN);
            let own_letters = self.reachable(base, &own);
            self.letters_below(partial, base, (OWN, &own), own_letters);
        }
    }

    /// Returns the letters of the children of a node that the tap can mean, and maybe some more. `base` is the score without the part that
    /// stands for the word to come.
    pub(super) fn reachable(&self, base: f32, branch: &Branch) -> Letters {
        // No child has a likelier word.
        let most = base + self.weighted(branch.best);
        branch.letters & self.touches.reachable(self.beam.limit() - most)
    }

    /// Uses the tap as one of some letters of the children of a node.
    pub(super) fn letters_below(
        &mut self,
        partial: &Next,
        base: f32,
        (node, branch): (u32, &Branch),
        letters: Letters,
    ) {
        let mut own = letters & !bit(LAST);
        let mut likely = 0;
        // Which letters are likely cannot be predicted, so this loop does not branch.
        while own != 0 {
            let letter = own & own.wrapping_neg();
            let symbol = letter.trailing_zeros() as Symbol;
            let score = base + self.best(branch.child(symbol));
            let is_likely = score + self.touches.bound(symbol) > self.beam.limit();
            likely |= if is_likely { letter } else { 0 };
            own ^= letter;
        }
        while likely != 0 {
            let symbol = likely.trailing_zeros() as Symbol;
            likely &= likely - 1;
            self.letter(partial, base, branch.child(symbol), symbol);
        }
        if letters & bit(LAST) != 0 {
            for child in self.model.lexicon.last_children(node, branch) {
                let symbol = self.model.lexicon.node(child).symbol();
                self.letter(partial, base, child, symbol);
            }
        }
    }

    /// Uses the tap as the letter that leads to a node.
    fn letter(&mut self, partial: &Next, base: f32, child: u32, symbol: Symbol) {
        let score = base + self.best(child);
        if score + self.touches.bound(symbol) > self.beam.limit() {
            self.likely_letter(partial, score, child, symbol);
        }
    }

    /// Uses the tap as the letter that leads to a node, with the score before the tap.
    fn likely_letter(&mut self, partial: &Next, score: f32, child: u32, symbol: Symbol) {
        let Some((touch, key)) = self.likelihoods.of_letter(symbol) else {
            return;
        };
        if score + touch <= self.beam.limit() {
            return;
        }
        let mut next = *partial;
        next.score = score + touch;
        next.place = Place::Word(child);
        next.moved = self.moved_by(touch, key);
        let letter = self.model.alphabet.letter(symbol);
        next.emission = next.emission.with(letter, From::This, Case::Lower);
        self.beam.push(next);
    }

    /// Returns the key if a tap of it tells where the hands are: a tap far from its key is a slip and tells nothing.
    fn moved_by(&self, touch: f32, key: usize) -> Option<u8> {
        (touch > self.touches.anywhere()).then_some(key as u8)
    }

    /// Uses the tap as the end of a word. Returns the hypothesis with its word complete, if it can still be kept.
    pub(super) fn end(&mut self, partial: &Next) -> Option<Next> {
        let node = partial.node();
        if node == ROOT {
            let space = self.touches.space();
            if let Some(space) = space.filter(|_| self.parent.end != super::history::NONE) {
                let mut next = *partial;
                next.score += SECOND_SPACE + self.likelihoods.of_key(space);
                next.emission = next.emission.with(' ', From::This, Case::Lower);
                self.beam.push(next);
            }
            self.opening_mark(partial);
            self.joint(partial, self.best(ROOT), Case::Lower);
            return None;
        }
        let ended = self.ended(partial)?;
        let case = self.model.lexicon.node(node).case();
        self.separators(&ended, node, case);
        self.joint(&ended, 0.0, case);
        Some(ended)
    }

    /// Uses the tap as a mark before a word: one that opens, or any other if it was typed.
    fn opening_mark(&mut self, partial: &Next) {
        for near in 0..self.touches.marks().len() {
            let near = self.touches.marks()[near];
            let cost = match near.character {
                '\'' | '"' | '(' | '¿' | '¡' => 0.0,
                '-' if near.key == self.typed.0 => 0.0,
                mark if near.key == self.typed.0 && is_punctuation(mark) => DOUBLE,
                _ => continue,
            };
            let touch = self.likelihoods.of_key(near.key);
            let mut next = *partial;
            let mark = punctuation(self.options, near.character, self.parent.sentence);
            next.score += touch + mark + cost;
            next.emission = next.emission.with(near.character, From::This, Case::Lower);
            self.beam.push(next);
        }
    }

    /// Uses the tap as the sign that it typed, after a complete word, with its case, or at the start of a word. `expected` is the part
    /// of the score that stands for the word to come.
    fn joint(&mut self, partial: &Next, expected: f32, case: Case) {
        let (key, sign) = self.typed;
        if !self.is_sign || !joins_words(sign) {
            return;
        }
        let touch = self.likelihoods.of_key(key);
        let mut next = *partial;
        next.score += touch + JOINT + self.best(ROOT) - expected;
        next.place = Place::Word(ROOT);
        next.row = NO_ROW;
        next.emission = next.emission.with(sign, From::This, case);
        self.beam.push(next);
    }

    /// Returns the hypothesis with its word complete, or `None` if it is not a word, or too unlikely for the tap.
    fn ended(&self, partial: &Next) -> Option<Next> {
        let node = partial.node();
        let branch = self.model.lexicon.branch(node);
        if branch.word == 0 {
            return None;
        }
        let missing = self.options.missing_space + self.best(ROOT);
        let joint = if self.is_sign { JOINT } else { missing };
        let following = self
            .touches
            .separator()
            .max(missing.max(joint) + self.touches.likeliest());
        // Before the look-ups of the word and the pair: how likely they can be at most.
        let expected = self.weighted(branch.best);
        let likeliest = partial.score + (self.weighted(branch.word) - expected);
        if !self.is_sign && likeliest + following + SLACK + ROUNDING <= self.beam.limit() {
            return None;
        }
        let alone = self.model.lexicon.node(node).word()?;
        let most = partial.score + (self.language((alone + GAIN).min(0.0)) - expected);
        if most + following + SLACK <= self.beam.limit() {
            return None;
        }
        let word = self.model.bigrams.after(partial.row, node, alone);
        let mut ended = *partial;
        ended.score += self.language(word) - expected;
        Some(ended)
    }

    /// Uses the tap as a space or punctuation after a complete word.
    fn separators(&mut self, ended: &Next, node: u32, case: Case) {
        if ended.score + self.touches.separator() + SLACK <= self.beam.limit() {
            return;
        }
        if let Some(space) = self.touches.space() {
            let touch = self.likelihoods.of_key(space);
            let mut next = *ended;
            next.score += touch + self.best(ROOT);
            if next.score > self.beam.limit() {
                next.place = Place::Word(ROOT);
                next.row = match node {
                    ROOT => NO_ROW,
                    node => self.model.next_row(ended.row, node),
                };
                next.moved = self.moved_by(touch, space);
                next.emission = next.emission.with(' ', From::This, case);
                self.beam.push(next);
            }
        }
        for near in 0..self.touches.marks().len() {
            let near = self.touches.marks()[near];
            let touch = self.likelihoods.of_key(near.key);
            let mut next = *ended;
            next.score += touch + punctuation(self.options, near.character, self.parent.sentence);
            if next.score <= self.beam.limit() {
                continue;
            }
            next.place = Place::Gap;
            next.row = self.model.row_after(near.character);
            next.moved = self.moved_by(touch, near.key);
            next.emission = next.emission.with(near.character, From::This, case);
            self.beam.push(next);
        }
    }

    /// Starts a word that is not in the lexicon.
    fn unknown(&mut self, partial: &Next) {
        let mut start = *partial;
        start.score += self.options.unknown - self.best(ROOT);
        self.spell(&start, START, true);
    }

    /// Uses the tap as a letter of a word that is not in the lexicon.
    fn spell(&mut self, partial: &Next, state: u16, is_typed: bool) {
        if !self.is_open(partial.score) {
            return;
        }
        for near in 0..self.touches.near().len() {
            let near = self.touches.near()[near];
            let Some(symbol) = near.symbol else { continue };
            let touch = self.likelihoods.of_key(near.key);
            let is_same = near.key == self.typed.0;
            // Before the look-up of the letter: how likely it can be at most.
            let most = if is_same { 0.0 } else { self.options.other };
            if partial.score + (most + touch) <= self.beam.limit() {
                continue;
            }
            let (spelling, state) = self.model.spelling.letter(state, symbol);
            let spelling = self.language(spelling);
            let cost = if is_same {
                spelling.max(self.options.letter)
            } else {
                spelling + self.options.other
            };
            let mut next = *partial;
            next.score += cost + touch;
            next.place = if is_typed && is_same {
                Place::Typed(state)
            } else {
                Place::Spelled(state)
            };
            next.moved = self.moved_by(touch, near.key);
            next.emission = next.emission.with(near.character, From::This, Case::Lower);
            self.beam.push(next);
        }
    }

    fn spelled(&mut self, partial: &Next, state: u16, is_typed: bool) {
        self.spell(partial, state, is_typed);
        let mut ended = *partial;
        ended.score += self.spelling_end(state, is_typed);
        self.separators(&ended, ROOT, Case::Lower);
        self.joint(&ended, 0.0, Case::Lower);
        // A sign is typed on purpose only in a word that is meant as it was typed.
        if self.is_sign && is_typed && !joins_words(self.typed.1) {
            let mut sign = *partial;
            sign.score += self.options.verbatim;
            self.verbatim(&sign);
        }
    }

    fn spelling_end(&self, state: u16, is_typed: bool) -> f32 {
        spelling_end(self.model, self.options, state, is_typed)
    }

    /// Uses the tap as the typed character of a word with digits or signs.
    fn verbatim(&mut self, partial: &Next) {
        let (key, character) = self.typed;
        let touch = self.likelihoods.of_key(key);
        if character == ' ' || is_punctuation(character) {
            return self.separators(partial, ROOT, Case::Lower);
        }
        if joins_words(character) {
            return self.joint(partial, 0.0, Case::Lower);
        }
        let mut next = *partial;
        next.score += touch + ANY_CHARACTER;
        next.place = Place::Verbatim;
        next.emission = next.emission.with(character, From::This, Case::Lower);
        self.beam.push(next);
    }

    /// Continues after punctuation: with its space, more punctuation, or a letter.
    fn gap(&mut self, partial: &Next) {
        let mut start = *partial;
        start.place = Place::Word(ROOT);
        if let Some(space) = self.touches.space() {
            let touch = self.likelihoods.of_key(space);
            let mut next = start;
            next.score += touch + self.best(ROOT);
            next.emission = next.emission.with(' ', From::This, Case::Lower);
            self.beam.push(next);
        }
        for near in 0..self.touches.marks().len() {
            let near = self.touches.marks()[near];
            let is_quote = matches!(near.character, '\'' | '"');
            let cost = if is_quote { RARE } else { DOUBLE };
            let mut next = *partial;
            next.score += cost + self.likelihoods.of_key(near.key);
            next.emission = next.emission.with(near.character, From::This, Case::Lower);
            self.beam.push(next);
        }
        self.joint(&start, 0.0, Case::Lower);
        start.score += RARE + self.best(ROOT);
        self.letters(&start);
        self.unknown(&start);
        if self.is_sign && !joins_words(self.typed.1) {
            start.score += self.options.verbatim - self.best(ROOT);
            self.verbatim(&start);
        }
    }
}

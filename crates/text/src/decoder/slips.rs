//! The expansion of one hypothesis by a tap after an error: a letter or a space that was not tapped, or two letters in the wrong order.

use super::expand::Expansion;
use super::likelihoods::Likelihoods;
use super::token::{From, Next, Parent, Place, Token};
use super::touches::{ROUNDING, SLACK};
use crate::model::alphabet::Symbol;
use crate::model::branches::{Branch, LAST, bit};
use crate::model::lexicon::{Case, OWN, ROOT};

impl Expansion<'_, '_> {
    /// Continues as if a letter or an apostrophe had not been tapped.
    pub(super) fn skips(&mut self, partial: &Next) {
        let node = partial.node();
        let most = self.options.omission.max(self.options.silent);
        if !self.is_open(partial.score + most) {
            return;
        }
        let branch = self.model.lexicon.branch(node);
        let base = partial.score - self.weighted(branch.best);
        self.skips_below(partial, base, node, &branch);
        if node == ROOT {
            let own = self.model.lexicon.branch(OWN);
            self.skips_below(partial, base, OWN, &own);
        }
    }

    /// Continues as if the letter of a child of a node had not been tapped.
    fn skips_below(&mut self, partial: &Next, base: f32, node: u32, branch: &Branch) {
        let silent = self.apostrophe.map_or(0, bit);
        let open = self.most_open(base + self.options.omission);
        let likely = self.model.lexicon.branches.likely(branch, open);
        let mut letters = (likely | silent & branch.letters) & !bit(LAST);
        while letters != 0 {
            let symbol = letters.trailing_zeros() as Symbol;
            letters &= letters - 1;
            self.skip(partial, base, branch.child(symbol), symbol);
        }
        if likely & bit(LAST) != 0 {
            for child in self.model.lexicon.last_children(node, branch) {
                let symbol = self.model.lexicon.node(child).symbol();
                self.skip(partial, base, child, symbol);
            }
        }
    }

    /// Returns the largest stored log-probability of a word with which a hypothesis can still be kept, or a larger one.
    fn most_open(&self, score: f32) -> u8 {
        let room = score + self.touches.likeliest() + SLACK - self.beam.limit();
        // A conversion saturates.
        (room * self.steps_per_weight + 1.0) as u8
    }

    /// Continues at a node as if its letter had not been tapped.
    fn skip(&mut self, partial: &Next, base: f32, node: u32, symbol: Symbol) {
        let branch = self.model.lexicon.branch(node);
        let cost = if Some(symbol) == self.apostrophe {
            self.options.silent
        } else {
            self.options.omission
        };
        let expected = self.weighted(branch.best);
        let score = base + expected + cost;
        if !self.is_open(score) {
            return;
        }
        let unexpected = score - expected;
        let letters = self.reachable(unexpected, &branch);
        let word = unexpected + self.weighted(branch.word);
        let ends = branch.word != 0 && self.can_end(word);
        if letters == 0 && !ends {
            return;
        }
        let mut next = *partial;
        next.score = score;
        next.place = Place::Word(node);
        let letter = self.model.alphabet.letter(symbol);
        next.emission = next.emission.with(letter, From::None, Case::Lower);
        self.letters_below(&next, unexpected, (node, &branch), letters);
        if ends {
            self.end(&next);
        }
    }

    /// Returns `true` if the tap may end the word of a hypothesis with this score at most.
    fn can_end(&self, score: f32) -> bool {
        // A sign is judged where it is used.
        let following = self.touches.separator() + SLACK + ROUNDING;
        self.is_sign || score + following > self.beam.limit()
    }

    /// Uses the tap as the first letter of a word after a complete one, without a space.
    pub(super) fn missing_space(&mut self, ended: &Next, node: u32) {
        let mut ended = *ended;
        ended.score += self.options.missing_space + self.best(ROOT);
        if self.is_open(ended.score) {
            ended.place = Place::Word(ROOT);
            ended.row = self.model.next_row(ended.row, node);
            let case = self.model.lexicon.node(node).case();
            ended.emission = ended.emission.with(' ', From::None, case);
            self.letters(&ended);
        }
    }

    /// Adds the successors of a hypothesis from before the previous tap if the previous tap and this one came in the wrong order, with the
    /// likelihoods of the previous tap.
    pub fn transpose(&mut self, index: usize, token: &Token, previous: &mut Likelihoods) {
        let Place::Word(node) = token.place else {
            return;
        };
        let reachable = token.score + self.options.transposition + self.touches.likeliest();
        if !self.is_open(reachable) {
            return;
        }
        self.likelihoods.assume(&token.hands);
        previous.assume(&token.hands);
        let base = token.score + self.options.transposition - self.best(node);
        let lexicon = &self.model.lexicon;
        for first in lexicon.children(node) {
            let first_best = self.best(first);
            // Before the likelihood is computed: how likely it can be at most.
            if !self.is_open(base + self.touches.peak() + first_best) {
                continue;
            }
            let first_symbol = lexicon.node(first).symbol();
            let Some((touch, _)) = self.likelihoods.of_letter(first_symbol) else {
                continue;
            };
            let score = base + touch + first_best;
            if !self.is_open(score) {
                continue;
            }
            for second in lexicon.children(first) {
                let most = score + self.touches.peak() - first_best + self.best(second);
                if most <= self.beam.limit() {
                    continue;
                }
                let symbol = lexicon.node(second).symbol();
                let Some((second_touch, _)) = previous.of_letter(symbol) else {
                    continue;
                };
                let second_score = score + second_touch - first_best + self.best(second);
                if second_score <= self.beam.limit() {
                    continue;
                }
                let mut next = Next::after(token, Parent::BeforeLast(index as u16));
                next.score = second_score;
                next.place = Place::Word(second);
                let letter = |letter_symbol| self.model.alphabet.letter(letter_symbol);
                next.emission = next
                    .emission
                    .with(letter(first_symbol), From::This, Case::Lower)
                    .with(letter(symbol), From::Previous, Case::Lower);
                self.beam.push(next);
            }
        }
    }
}

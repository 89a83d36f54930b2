//! Words from the path of a finger.

use super::{CANDIDATES, Candidate, Decoder, Start};
use crate::keyboard::Millimetres;
use crate::model::bigrams::Row;
use crate::model::lexicon::Case;
use crate::swipe::Swipes;

/// The text before a word, as far as a decoder needs it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Before {
    row: Row,
    starts_sentence: bool,
}

impl<'m> Decoder<'m> {
    /// Makes room for the paths of swipes.
    #[must_use]
    pub fn with_swipes(mut self) -> Self {
        self.swipes = Some(Swipes::new(&self.model, &self.keyboard));
        self
    }

    /// Returns the words that a path over the keys of letters most probably means behind the last commit, the best first. None without
    /// [`with_swipes`](Self::with_swipes), or if no word is near the path. With `capital`, or at the start of a sentence, they start with
    /// a capital. Does not allocate.
    pub fn swipe(&mut self, path: &[Millimetres], capital: bool) -> &[Candidate] {
        self.found = 0;
        let Some(swipes) = &mut self.swipes else {
            return &[];
        };
        let keys = self.keyboard.keys();
        let is_letter = |character: char| self.model.alphabet.symbol(character).is_some();
        let letters = || keys.iter().filter(|key| is_letter(key.character));
        let narrowest = letters().map(|key| key.size[0].min(key.size[1]));
        let width = narrowest.fold(f32::INFINITY, f32::min);
        // A finger passes over a key where the person taps it.
        let center = |letter: char| {
            let index = self.keyboard.index(letter)?;
            Some(self.touch.spreads(&self.keyboard).nth(index)?.mean)
        };
        let context = (&self.model, self.options.language, self.row);
        let found = swipes.find(context, path, (center, width));
        let capital = capital || self.options.capitals && self.starts_sentence;
        for (candidate, word) in self.candidates.iter_mut().zip(found).take(CANDIDATES) {
            candidate.score = word.score;
            candidate.text.clear();
            let case = self.model.lexicon.node(word.node).case();
            for (index, &symbol) in word.letters.iter().enumerate() {
                let letter = self.model.alphabet.letter(symbol);
                let is_upper = match case {
                    Case::Lower => capital && index == 0,
                    Case::Title => index == 0,
                    Case::Upper => true,
                };
                if is_upper {
                    candidate.text.extend(letter.to_uppercase());
                } else {
                    candidate.text.push(letter);
                }
            }
            self.found += 1;
        }
        &self.candidates[..self.found]
    }

    /// Returns the candidates that were found last.
    pub(crate) fn last_candidates(&self) -> &[Candidate] {
        &self.candidates[..self.found]
    }

    /// Returns what is known of the text before the first tap.
    pub(crate) fn before(&self) -> Before {
        Before {
            row: self.row,
            starts_sentence: self.starts_sentence,
        }
    }

    /// Drops all taps, without learning, and goes on behind a known text.
    pub(crate) fn start_behind(&mut self, before: Before) {
        self.row = before.row;
        self.starts_sentence = before.starts_sentence;
        self.restart(Start::Anywhere);
    }
}

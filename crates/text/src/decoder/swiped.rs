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

    /// Returns the words that a path over the keys of letters most probably means after the last commit, the best first. None without
    /// [`with_swipes`](Self::with_swipes), or if no word is near the path. With `capital`, or at the start of a sentence, they start with
    /// a capital. Does not allocate.
    pub fn swipe(&mut self, path: &[Millimetres], capital: bool) -> &[Candidate] {
        self.found = 0;
        let Some(swipes) = &mut self.swipes else {
            return &[];
        };
        let keys = self.keyboard.keys();
        let is_letter = |character: char| self.model.alphabet.symbol(character).is_some();
        let letters = keys
            .iter()
            .filter(|key| key.has_place() && is_letter(key.character));
        let narrowest = letters.map(|key| key.size[0].min(key.size[1]));
        let width = narrowest.fold(f32::INFINITY, f32::min);
        // A finger passes over a key where the person taps it, as far as the hand has drifted.
        let center = |letter: char| {
            let index = self.keyboard.index(letter)?;
            if !keys[index].has_place() {
                return None;
            }
            let mean = self.touch.spreads(&self.keyboard).nth(index)?.mean;
            let drift = self.touch.hands.drift[usize::from(keys[index].hand.min(1))];
            Some([mean[0] + drift[0], mean[1] + drift[1]])
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

    /// Returns `true` if the text since the last commit starts a sentence.
    pub(crate) fn starts_sentence(&self) -> bool {
        self.starts_sentence
    }

    /// Drops all taps, without learning, and continues after a known text.
    pub(crate) fn start_after(&mut self, before: Before) {
        self.row = before.row;
        self.starts_sentence = before.starts_sentence;
        self.restart(Start::Anywhere);
    }
}

#[cfg(test)]
mod tests {
    use crate::decoder::fixture::{decoder, drifted, key};
    use crate::keyboard::{ELSEWHERE, Key};

    #[test]
    fn a_letter_of_another_layer_is_swiped_over_the_key_of_its_plain_letter() {
        let keys = [
            key('n', [19.0, 38.0]),
            key('i', [57.0, 0.0]),
            key('a', [-38.0, 19.0]),
            Key {
                size: [1.0; 2],
                ..key('ñ', [ELSEWHERE; 2])
            },
        ];
        let mut decoder = decoder("niña", &keys, drifted(0.0)).with_swipes();
        let path = [[19.0, 38.0], [57.0, 0.0], [19.0, 38.0], [-38.0, 19.0]];
        let found = decoder.swipe(&path, false);
        assert_eq!(found.first().map(|first| first.text.as_str()), Some("Niña"));
    }

    #[test]
    fn a_path_is_expected_where_the_hand_has_drifted_to() {
        let keys = [
            key('c', [0.0, 38.0]),
            key('v', [19.0, 38.0]),
            key('a', [-38.0, 19.0]),
            key('s', [-19.0, 19.0]),
            key('t', [19.0, 0.0]),
            key('y', [38.0, 0.0]),
        ];
        for (drift, word) in [(0.0, "Vsy"), (19.0, "Cat")] {
            // Each key of the second word is the right neighbor of a key of the first one.
            let mut decoder = decoder("cat\nvsy", &keys, drifted(drift)).with_swipes();
            let found = decoder.swipe(&[[19.0, 38.0], [-19.0, 19.0], [38.0, 0.0]], false);
            assert_eq!(found[0].text, word);
        }
    }
}

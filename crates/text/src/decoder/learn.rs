//! Learning from committed text: where keys are tapped, how often taps are missed or mean nothing, and how often words are
//! unknown.

use super::finish::Finished;
use super::marks::is_punctuation;
use super::token::Place;
use super::{Decoder, NONE, Start};
use crate::correction::ends_word;
use crate::keyboard::Millimetres;
use crate::model::bigrams::NO_ROW;
use crate::model::lexicon::ROOT;
use crate::model::{Model, ends_sentence};
use crate::touch::ErrorCounts;

/// The share of a word that is left after one more word: names, code and passwords come in groups.
const WORD_MEMORY: f32 = 0.95;
/// The number of words that the belief of the options is worth.
const PRIOR_WORDS: f32 = 12.0;
/// The most that a cost is changed by what was learned, in nats.
const MAX_CHANGE: f32 = 2.5;

/// The part of the last words that the lexicon lacks.
#[derive(Clone, Copy, Debug, Default)]
pub struct WordRates {
    words: f32,
    unknown: f32,
}

impl WordRates {
    fn learn(&mut self, is_unknown: bool) {
        self.words = self.words * WORD_MEMORY + 1.0;
        self.unknown = self.unknown * WORD_MEMORY + f32::from(u8::from(is_unknown));
    }

    /// Returns the log-probability of an unknown word, given the one that applied before.
    fn cost(&self, before: f32) -> f32 {
        let prior = before.exp();
        ((self.unknown + prior * PRIOR_WORDS) / (self.words + PRIOR_WORDS))
            .ln()
            .max(before)
    }
}

impl Decoder<'_> {
    /// Accepts the most probable text: learns from its taps, and starts again after it.
    pub fn commit(&mut self) {
        self.finish();
        let Some(best) = self.finished.first().copied() else {
            return self.start_anywhere();
        };
        let token = self.tokens[best.token];
        self.learn(&best);
        self.render(&best);
        learn_words(&mut self.words, &self.model, self.rendered.shown());
        self.touch.hands = token.hands;
        self.sentence = token.sentence;
        self.touches.learn(&self.keyboard, &self.touch);
        self.update_costs();
        let last = self.history.get(best.end).map(|entry| entry.character);
        match (token.place, last) {
            (Place::Gap, Some(mark)) if ends_sentence(mark) => self.starts_sentence = true,
            (Place::Word(ROOT), _) => {
                let starts = match self.model.row(ROOT) {
                    // A model without pairs of words does not know what starts a sentence.
                    NO_ROW => self.is_after_sentence(best.end),
                    row => token.row == row,
                };
                self.starts_sentence = self.starts_sentence && last.is_none() || starts;
            }
            _ => self.starts_sentence = false,
        }
        self.row = match best.word {
            Some(node) => self.model.next_row(token.row, node),
            None => token.row,
        };
        self.restart(match token.place {
            Place::Word(ROOT) => Start::Word,
            Place::Gap => Start::AfterMark,
            _ => Start::Anywhere,
        });
    }

    /// Returns `true` if the characters up to an end finish a sentence, whatever stands between it and the next word.
    fn is_after_sentence(&self, end: u32) -> bool {
        let entries = std::iter::successors(self.history.get(end), |entry| {
            self.history.get(entry.previous)
        });
        let is_between =
            |character: char| matches!(character, ' ' | '"' | '\'' | '(' | ')' | '¿' | '¡');
        let mut characters = entries.map(|entry| entry.character);
        let last = characters.find(|&character| !is_between(character));
        last.is_some_and(ends_sentence)
    }

    /// Accepts what was typed, and starts again after it.
    pub fn commit_typed(&mut self) {
        self.commit_text(None);
    }

    /// Continues after punctuation and a space, which follow the text of the last commit.
    pub(crate) fn commit_mark(&mut self, mark: char) {
        let mut encoded = [0; 4];
        self.commit_text(Some(mark.encode_utf8(&mut encoded)));
        self.restart(Start::Word);
    }

    /// Accepts a text, or what was typed, without learning from the taps, and starts again after it.
    pub fn commit_text(&mut self, text: Option<&str>) {
        self.touch.hands = self
            .tokens
            .first()
            .map_or(self.touch.hands, |token| token.hands);
        let text = text.unwrap_or(self.literal.text());
        learn_words(&mut self.words, &self.model, text);
        let start = match text.chars().next_back() {
            Some(' ') => Start::Word,
            Some(mark) if is_punctuation(mark) => Start::AfterMark,
            _ => Start::Anywhere,
        };
        let last = text.trim_end();
        self.starts_sentence = last.ends_with(ends_sentence);
        self.sentence = if self.starts_sentence {
            0
        } else {
            self.sentence.saturating_add(self.taps.len() as u16)
        };
        self.row = match last.chars().next_back() {
            Some(mark) if is_punctuation(mark) => self.model.row_after(mark),
            _ => {
                let word = last.rsplit(' ').next();
                let found = word.and_then(|word| self.model.find(word));
                found.map_or(NO_ROW, |found| self.model.row(found.node))
            }
        };
        self.update_costs();
        self.restart(start);
    }

    /// Learns where the keys were tapped that a text consists of.
    fn learn(&mut self, best: &Finished) {
        let drift = self.tokens[best.token].hands.drift;
        let mut end = best.end;
        let mut used = 0;
        let mut seen = ErrorCounts {
            taps: self.taps.len(),
            missed: usize::from(best.omitted.is_some()),
            ..ErrorCounts::default()
        };
        let mut next_tap = NONE;
        let mut later: Option<(u32, u8, Millimetres)> = None;
        while let Some(entry) = self.history.get(end) {
            end = entry.previous;
            match (entry.tap, entry.character) {
                (NONE, '\'') => {}
                (NONE, _) => seen.missed += 1,
                (tap, _) => {
                    used += 1;
                    seen.swapped += usize::from(tap > next_tap);
                    next_tap = tap;
                }
            }
            let Some(tap) = self.taps.get(entry.tap as usize) else {
                continue;
            };
            let plain = crate::model::alphabet::plain(entry.character);
            let own = self.keyboard.index(entry.character);
            let Some(index) = own.or_else(|| self.keyboard.index(plain)) else {
                continue;
            };
            let key = self.keyboard.keys()[index];
            if !key.has_place() {
                continue;
            }
            let shift: Millimetres = drift[usize::from(key.hand.min(1))];
            let residual: Millimetres =
                std::array::from_fn(|axis| tap.position[axis] - key.center[axis] - shift[axis]);
            // A slip to another key says nothing about where the key is felt.
            let inside = (0..2).all(|axis| residual[axis].abs() < 1.5 * key.size[axis]);
            if !inside {
                continue;
            }
            self.touch.learn(key.character, residual);
            let is_wide = key.size[0] > 2.0 * key.size[1];
            // Around the place where the person taps the key: an offset that all taps have is no scatter.
            let mean = self.touches.mean(index).filter(|_| !is_wide);
            let this = mean.map(|mean| {
                let scatter: Millimetres =
                    std::array::from_fn(|axis| tap.position[axis] - mean[axis] - shift[axis]);
                (entry.tap, key.hand, scatter)
            });
            if let (Some(first), Some(second)) = (this, later)
                && first.0 + 1 == second.0
            {
                let is_same_hand = first.1 == second.1;
                self.touch.learn_pair(is_same_hand, first.2, second.2);
            }
            later = this;
        }
        seen.spurious = seen.taps.saturating_sub(used);
        self.touch.learn_errors(seen);
    }

    /// Adapts the costs of errors and of unknown words to what was learned.
    pub(super) fn update_costs(&mut self) {
        let options = &self.options;
        let limited = |change: f32| change.clamp(-MAX_CHANGE, MAX_CHANGE);
        let errors = &self.touch.errors;
        let spurious = limited(errors.spurious_change(options.insertion));
        let missed = limited(errors.missed_change(options.omission));
        let swapped = limited(errors.swapped_change(options.transposition));
        self.costs = *options;
        self.costs.insertion = (options.insertion + spurious).min(0.0);
        self.costs.omission = (options.omission + missed).min(0.0);
        self.costs.transposition = (options.transposition + swapped).min(0.0);
        self.costs.missing_space = (options.missing_space + missed).min(0.0);
        self.costs.unknown = self.words.cost(options.unknown);
    }
}

fn learn_words(rates: &mut WordRates, model: &Model, text: &str) {
    for word in text.split(ends_word).filter(|word| !word.is_empty()) {
        rates.learn(model.find(word).is_none());
    }
}

#[cfg(test)]
mod tests {
    use crate::decoder::fixture::{decoder, drifted, key, row, tap};
    use crate::keyboard::{ELSEWHERE, Key};
    use crate::{Prior, TouchModel};

    #[test]
    fn a_character_of_another_layer_tells_nothing_about_the_hand() {
        let keys = [
            Key {
                size: [1.0; 2],
                ..key('ñ', [ELSEWHERE; 2])
            },
            key('u', [19.0, 0.0]),
            key(' ', [38.0, 0.0]),
        ];
        for drift in [0.0, 8.0] {
            let mut decoder = decoder("ñu", &keys, drifted(drift));
            for (character, right) in [('ñ', 0.0), ('u', drift), (' ', drift)] {
                tap(&mut decoder, character, right);
            }
            assert_eq!(decoder.best(), "Ñu ");
            decoder.commit();
            // The taps of `u`; a space is hit anywhere.
            assert_eq!(decoder.touch().person.taps, 1.0);
            assert_eq!(decoder.touch().hands.drift[0], [drift, 0.0]);
        }
    }

    #[test]
    fn successive_taps_of_a_hand_are_learned_but_not_across_a_space() {
        let mut keys = row("cat ");
        keys[2].hand = 1;
        keys[3].size[0] = 60.0;
        let mut decoder = decoder("cat", &keys, TouchModel::new(Prior::default()));
        for character in "cat cat ".chars() {
            tap(&mut decoder, character, 2.0);
        }
        assert_eq!(decoder.best(), "Cat cat ");
        decoder.commit();
        // `c` and `a`, `a` and `t` of each word.
        let learned = decoder.touch();
        assert!((learned.same_hand.pairs - 2.0).abs() < 0.01);
        assert!((learned.other_hand.pairs - 2.0).abs() < 0.01);
        assert!(learned.same_hand.correlation() > 0.5, "{learned:?}");
        decoder.start_anywhere();
        assert_eq!(decoder.touch().hands.scatter, [0.0; 2]);
    }

    #[test]
    fn an_offset_that_all_taps_have_is_no_correlation_of_successive_taps() {
        let mut keys = row("cat ");
        keys[3].center = [19.0, 19.0];
        keys[3].size[0] = 60.0;
        let touch = TouchModel::new(Prior {
            offset: [4.0, 0.0],
            ..Prior::default()
        });
        let mut decoder = decoder("cat", &keys, touch);
        // Each tap is on the other side of its place than the tap before.
        for (character, side) in "cat cat ".chars().zip([2.0, -2.0].into_iter().cycle()) {
            tap(&mut decoder, character, 4.0 + side);
        }
        assert_eq!(decoder.best(), "Cat cat ");
        decoder.commit();
        let learned = decoder.touch();
        assert!((learned.same_hand.pairs - 4.0).abs() < 0.1);
        assert!(learned.same_hand.correlation() < 0.0, "{learned:?}");
    }

    #[test]
    fn a_sentence_starts_after_a_period_in_a_model_without_pairs_of_words() {
        let touch = TouchModel::new(Prior::default());
        let mut decoder = decoder("cat", &row("cat ."), touch);
        for (text, shown) in [("cat. ", "Cat. "), ("cat ", "Cat "), ("cat ", "cat ")] {
            for character in text.chars() {
                tap(&mut decoder, character, 0.0);
            }
            assert_eq!(decoder.best(), shown);
            decoder.commit();
        }
    }
}

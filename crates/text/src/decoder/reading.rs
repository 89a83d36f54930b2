//! The texts that hypotheses stand for.

use super::candidate::Candidate;
use super::finish::{Finished, finish};
use super::render::SentenceStart;
use super::{CANDIDATES, Decoder, FINISHED, Start};
use crate::correction::ends_word;

impl Decoder<'_> {
    /// Returns the most probable text since the last commit.
    pub fn best(&mut self) -> &str {
        self.candidates()
            .first()
            .map_or("", |best| best.text.as_str())
    }

    /// Returns the most probable texts since the last commit, the best first. What was typed is always one of them, unless letters share
    /// keys.
    pub fn candidates(&mut self) -> &[Candidate] {
        self.finish();
        self.found = 0;
        for index in 0..self.finished.len() {
            if self.found == CANDIDATES {
                break;
            }
            let finished = self.finished[index];
            self.render(&finished);
            let text = self.rendered.shown();
            let is_new = self.candidates[..self.found]
                .iter()
                .all(|known| known.text != text);
            // A lone space says nothing about a letter.
            let is_empty = text.trim().is_empty() && !self.literal.text().trim().is_empty();
            if is_new && !is_empty {
                let candidate = &mut self.candidates[self.found];
                candidate.text.clear();
                candidate.text.push_str(text);
                candidate.score = finished.score;
                self.found += 1;
            }
        }
        if self.found == 0 || !self.keyboard.has_shared_keys() {
            self.add_literal();
        }
        &self.candidates[..self.found]
    }

    /// Returns the text to show. The most probable text that keeps what was typed since the last correction is shown unless another one is
    /// likelier by [`Options::margin`](super::Options::margin). Sentences and names start with capitals.
    pub fn reading(&mut self) -> &str {
        self.finish();
        let typed = self.typed_score();
        let Some(best) = self.finished.first().copied() else {
            return self.literal.text();
        };
        let margin = if self.keyboard.has_shared_keys() {
            // The typed letters are only the first ones of their keys.
            0.0
        } else {
            self.options.margin * self.literal.trust()
        };
        for index in 0..self.finished.len() {
            let finished = self.finished[index];
            if best.score - finished.score >= margin {
                break;
            }
            self.render(&finished);
            if self.literal.is_kept_by(self.rendered.shown()) {
                return self.rendered.shown();
            }
        }
        if best.score - typed < margin {
            return self.literal.text();
        }
        self.render(&best)
    }

    /// Returns `true` if the last tap ends a word in the most probable text, and is likelier a tap of the key that ends it than of
    /// the typed one: the hand lies beside the keys.
    pub(crate) fn ends_word_beside_its_key(&self) -> bool {
        // The tap may be the beginning of a swipe.
        if self.swipes.is_some() {
            return false;
        }
        let (Some(best), Some(last)) = (self.tokens.first(), self.taps.last()) else {
            return false;
        };
        let Some(meant) = self.history.get(best.end) else {
            return false;
        };
        // A lone space says nothing about a letter.
        let before = self.history.get(meant.previous);
        let is_after_word = before.is_some_and(|before| !ends_word(before.character));
        let is_last = meant.tap as usize + 1 == self.taps.len();
        if !is_last || !ends_word(meant.character) || !is_after_word {
            return false;
        }
        let keys = (self.keyboard.index(meant.character), self.typed_key(last));
        let (Some(meant_key), Some((typed_key, _))) = keys else {
            return false;
        };
        // After this tap, the scatter of the last tap is its own, as a tap of the meant key.
        let mut hands = best.hands;
        hands.lift();
        let likelihood = |key: usize| self.touches.of_key(key, &hands);
        likelihood(meant_key) > likelihood(typed_key)
    }

    /// Takes the text of a hypothesis, to which the field was corrected, for what was typed: the words after it are compared with
    /// it.
    pub(crate) fn follow(&mut self, shown: &str) {
        self.follow_known(shown);
        self.followed.clear();
        self.followed.push_str(shown);
        self.followed_taps = self.taps.len();
    }

    /// Uses the text of a hypothesis as what was typed, if one has it.
    pub(super) fn follow_known(&mut self, shown: &str) {
        for index in 0..self.finished.len() {
            let finished = self.finished[index];
            if self.render(&finished) == shown {
                let token = self.tokens[finished.token];
                let place = (token.row, token.sentence);
                return self.literal.follow(shown, finished.score, place);
            }
        }
    }

    /// Returns the text of a complete hypothesis.
    pub(super) fn render(&mut self, finished: &Finished) -> &str {
        let capital = self.options.capitals && self.starts_sentence;
        let is_after_mark = self.start == Start::AfterMark;
        let start = match (capital, is_after_mark) {
            (false, _) => SentenceStart::None,
            (true, false) => SentenceStart::Here,
            (true, true) => SentenceStart::AfterSpace,
        };
        self.rendered
            .text(&self.history, finished, &self.taps, start)
    }

    /// Adds the typed text to the candidates, in place of the last candidate if the list is full.
    fn add_literal(&mut self) {
        let typed = self.literal.text();
        let found = &self.candidates[..self.found];
        if found.iter().any(|candidate| candidate.text == typed) {
            return;
        }
        let score = self.typed_score();
        let last = self.found.min(CANDIDATES - 1);
        self.candidates[last].text.clear();
        self.candidates[last].text.push_str(self.literal.text());
        self.candidates[last].score = score;
        self.found = last + 1;
    }

    /// Returns the log-probability that what was typed is meant.
    pub fn typed_score(&self) -> f32 {
        self.literal.score(&self.model, &self.costs)
    }

    /// Collects the complete hypotheses, the best first.
    pub(super) fn finish(&mut self) {
        self.finished.clear();
        for (index, token) in self.tokens.iter().enumerate() {
            let full = self.finished.len() == FINISHED;
            let worst = self.finished.last().filter(|_| full);
            let worst = worst.map_or(f32::NEG_INFINITY, |worst| worst.score);
            finish(&self.model, &self.costs, index, token, worst, |found| {
                let better = |other: &Finished| other.score >= found.score;
                let place = self.finished.partition_point(better);
                if place < FINISHED {
                    self.finished.truncate(FINISHED - 1);
                    self.finished.insert(place, found);
                }
            });
        }
        // In the middle of a long word nothing may be complete. What was typed is no better then.
        if let (true, Some(token)) = (self.finished.is_empty(), self.tokens.first()) {
            self.finished.push(Finished::partial(0, token));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::decoder::fixture::{decoder, row};
    use crate::{Prior, Tap, TouchModel};

    #[test]
    fn a_tap_on_a_letter_ends_no_word_by_its_own_scatter() {
        let touch = TouchModel::new(Prior {
            same_hand: 0.6,
            pairs: 1e6,
            first_drift: 0.0,
            ..Prior::default()
        });
        let mut decoder = decoder("cat", &row("cat "), touch);
        // The last one is 8 mm from the middle of `t` and 11 mm from the middle of the space bar.
        for x in [0.0, 19.0, 38.0, 46.0] {
            decoder.tap(Tap::at(x, 0.0));
        }
        assert_eq!(decoder.best(), "Cat ");
        assert!(!decoder.ends_word_beside_its_key());
    }
}

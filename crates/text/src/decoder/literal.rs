//! The text as it was typed, with its own log-probability, so that a correction can be compared with it.

use super::Options;
use super::expand::{ANY_CHARACTER, spelling_end};
use super::marks::{JOINT, is_punctuation, joins_words, punctuation};
use super::touches::Touches;
use crate::correction::ends_word;
use crate::model::bigrams::{NO_ROW, Row};
use crate::model::lexicon::Prefix;
use crate::model::spelling::START;
use crate::model::{Model, ends_sentence};
use crate::touch::Hands;

/// The part of the margin that is left after a correction.
const CORRECTED_TRUST: f32 = 0.4;

/// The current word as the typed characters spell it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Word {
    /// The letters.
    prefix: Prefix,
    state: u16,
    /// The log-probability of the spelling.
    spelled: f32,
    /// `true` if the word has digits or signs.
    has_sign: bool,
}

const EMPTY: Word = Word {
    prefix: Prefix::EMPTY,
    state: START,
    spelled: 0.0,
    has_sign: false,
};

/// The typed text.
#[derive(Clone, Debug)]
pub struct Literal {
    text: String,
    /// The bytes of the text that another text gave.
    followed: usize,
    score: f32,
    row: Row,
    word: Word,
    is_empty: bool,
    /// The taps since the last sentence ended.
    sentence: u16,
}

impl Literal {
    pub fn new(capacity: usize) -> Self {
        Self {
            text: String::with_capacity(4 * capacity),
            followed: 0,
            score: 0.0,
            row: NO_ROW,
            word: EMPTY,
            is_empty: true,
            sentence: 0,
        }
    }

    pub fn clear(&mut self, row: Row, sentence: u16) {
        self.text.clear();
        self.followed = 0;
        self.score = 0.0;
        self.row = row;
        self.word = EMPTY;
        self.is_empty = true;
        self.sentence = sentence;
    }

    /// Continues after another text, between words, with its log-probability, the word before and the taps of its sentence.
    pub fn follow(&mut self, text: &str, score: f32, (row, sentence): (Row, u16)) {
        self.clear(row, sentence);
        self.text.push_str(text);
        self.followed = text.len();
        self.score = score;
    }

    /// Returns the part of the margin that a correction needs: a person whose text was corrected makes more errors.
    pub fn trust(&self) -> f32 {
        if self.followed > 0 {
            CORRECTED_TRUST
        } else {
            1.0
        }
    }

    /// Returns `true` if a text ends with what was typed since the last [`follow`](Self::follow), whatever its capitals.
    pub fn is_kept_by(&self, text: &str) -> bool {
        let typed = self.text[self.followed..].chars().rev();
        let lower = |letter: char| letter.to_lowercase().next();
        let mut other = text.chars().rev();
        let is_tail = typed.into_iter().all(|letter| {
            let found = other.next();
            found.and_then(lower) == lower(letter)
        });
        let before = other.next();
        is_tail
            && before.is_none_or(|before| {
                // No letter of the text that the other one gave joins what was typed.
                self.followed > 0 && ends_word(before)
            })
    }

    pub fn text(&self) -> &str {
        &self.text
    }

    /// Adds a typed character.
    pub fn push(
        &mut self,
        typed: (usize, char),
        shown: char,
        model: &Model,
        options: &Options,
        touches: &Touches,
        hands: &Hands,
    ) {
        let (key, character) = typed;
        self.text.push(shown);
        let sentence = self.sentence;
        self.sentence = if ends_sentence(character) {
            0
        } else {
            sentence.saturating_add(1)
        };
        self.score += touches.of_key(key, hands);
        if character == ' ' || is_punctuation(character) || joins_words(character) {
            let (language, node) = self.language(model, options);
            self.score += language;
            self.row = match character {
                sign if joins_words(sign) => NO_ROW,
                _ if self.is_empty => self.row,
                ' ' => node.map_or(NO_ROW, |node| model.next_row(self.row, node)),
                mark => model.row_after(mark),
            };
            self.score += match character {
                ' ' => 0.0,
                sign if joins_words(sign) => JOINT,
                mark => punctuation(options, mark, sentence),
            };
            self.word = EMPTY;
            self.is_empty = true;
            return;
        }
        let is_first = std::mem::take(&mut self.is_empty);
        let Some(symbol) = model.alphabet.symbol(character) else {
            self.word.prefix = Prefix::UNKNOWN;
            if !std::mem::replace(&mut self.word.has_sign, true) {
                self.word.spelled += options.verbatim;
            }
            self.word.spelled += ANY_CHARACTER;
            return;
        };
        if is_first {
            self.word.spelled += options.unknown;
        }
        self.word.prefix = self.word.prefix.with(symbol, &model.lexicon);
        if self.word.has_sign {
            self.word.spelled += ANY_CHARACTER;
        } else {
            let (spelling, state) = model.spelling.letter(self.word.state, symbol);
            self.word.spelled += (options.language * spelling).max(options.letter);
            self.word.state = state;
        }
    }

    /// Returns the log-probability of the current word, and its node.
    fn language(&self, model: &Model, options: &Options) -> (f32, Option<u32>) {
        if self.is_empty {
            return (0.0, None);
        }
        let unknown = if self.word.has_sign {
            self.word.spelled
        } else {
            self.word.spelled + spelling_end(model, options, self.word.state, true)
        };
        let known = model.lexicon.word(self.word.prefix).map(|(node, alone)| {
            let after = model.bigrams.after(self.row, node, alone);
            (options.language * after, node)
        });
        match known {
            Some((known, node)) if known > unknown => (known, Some(node)),
            _ => (unknown, None),
        }
    }

    /// Returns the log-probability of the text if it ended here.
    pub fn score(&self, model: &Model, options: &Options) -> f32 {
        self.score + self.language(model, options).0
    }
}

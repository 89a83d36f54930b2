//! The costs that the decoder gives to errors, in nats.

use serde::{Deserialize, Serialize};

/// The beliefs of the decoder: costs are log-probabilities, so 0 is free and −7 is one in a thousand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Options {
    /// The hypotheses that are kept after each tap.
    pub beam: usize,
    /// A hypothesis this much worse than the best one is dropped.
    pub width: f32,
    /// The weight of the language against the touches.
    pub language: f32,
    /// A letter was not tapped, before the rate of the person is known.
    pub omission: f32,
    /// A tap means nothing, before the rate of the person is known.
    pub insertion: f32,
    /// Another key was meant than its neighborhood, beside an even chance for each place of the keyboard.
    pub substitution: f32,
    /// Two letters were tapped in the wrong order.
    pub transposition: f32,
    /// A space was not tapped.
    pub missing_space: f32,
    /// An apostrophe was left out.
    pub silent: f32,
    /// A letter with a key of its own was typed on the key of its plain letter.
    pub plain: f32,
    /// A word that the lexicon has not, among words that it has.
    pub unknown: f32,
    /// A letter of such a word costs at most this, if it was typed.
    pub letter: f32,
    /// A letter of such a word is not the typed one.
    pub other: f32,
    /// Punctuation ends a word.
    pub punctuation: f32,
    /// A word with digits or signs starts.
    pub verbatim: f32,
    /// The least advantage of a correction over the typed word.
    pub margin: f32,
    /// Sentences start with a capital.
    pub capitals: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            beam: 200,
            width: 12.0,
            language: 0.85,
            omission: -6.0,
            insertion: -6.0,
            substitution: -9.0,
            transposition: -6.5,
            missing_space: -6.0,
            silent: -0.7,
            plain: -2.5,
            unknown: -6.5,
            letter: -3.6,
            other: -2.5,
            punctuation: -3.0,
            verbatim: -5.0,
            margin: 1.5,
            capitals: true,
        }
    }
}

/// The most hypotheses.
pub const MAX_BEAM: usize = 2_000;

impl Options {
    /// Returns options that can be used: costs at most 0, a beam of 1 to [`MAX_BEAM`].
    pub(crate) fn sane(mut self) -> Self {
        let default = Self::default();
        let costs = [
            (&mut self.omission, default.omission),
            (&mut self.insertion, default.insertion),
            (&mut self.substitution, default.substitution),
            (&mut self.transposition, default.transposition),
            (&mut self.missing_space, default.missing_space),
            (&mut self.silent, default.silent),
            (&mut self.plain, default.plain),
            (&mut self.unknown, default.unknown),
            (&mut self.letter, default.letter),
            (&mut self.other, default.other),
            (&mut self.punctuation, default.punctuation),
            (&mut self.verbatim, default.verbatim),
        ];
        for (cost, usual) in costs {
            *cost = if cost.is_finite() {
                cost.min(0.0)
            } else {
                usual
            };
        }
        let positive = [
            (&mut self.width, default.width),
            (&mut self.language, default.language),
            (&mut self.margin, default.margin),
        ];
        for (value, usual) in positive {
            *value = if value.is_finite() {
                value.max(0.0)
            } else {
                usual
            };
        }
        self.beam = self.beam.clamp(1, MAX_BEAM);
        self
    }
}

//! Hypotheses: what the taps until now may mean.

use crate::model::bigrams::Row;
use crate::model::lexicon::Case;
use crate::touch::Hands;

/// The place of a hypothesis in the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A node of the lexicon; the root between words.
    Word(u32),
    /// After punctuation, before its space.
    Gap,
    /// A state of the spelling, in a word that the lexicon may not have, as it was typed until now.
    Typed(u16),
    /// A state of the spelling, in such a word with letters of other keys than the typed ones.
    Spelled(u16),
    /// In a word with digits or signs.
    Verbatim,
}

/// A hypothesis.
#[derive(Clone, Copy, Debug)]
pub struct Token {
    /// The log-probability plus the log-probability of the likeliest word that it can become.
    pub score: f32,
    /// The place.
    pub place: Place,
    /// The word before.
    pub row: Row,
    /// The last character.
    pub end: u32,
    /// The taps since its last sentence ended.
    pub sentence: u16,
    /// The displacement of the hands that fits it.
    pub hands: Hands,
}

impl Token {
    /// Returns what makes two hypotheses one: the same place after the same word.
    pub fn key(&self) -> u64 {
        let place = match self.place {
            Place::Word(node) => u64::from(node),
            Place::Gap => 1 << 24,
            Place::Verbatim => 2 << 24,
            Place::Spelled(state) => 3 << 24 | u64::from(state),
            Place::Typed(state) => 4 << 24 | u64::from(state),
        };
        u64::from(self.row.0) << 32 | place
    }
}

/// The tap that means an emitted character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum From {
    /// The tap of this step.
    This,
    /// The one before.
    Previous,
    /// None: it was left out.
    None,
}

/// A character that a hypothesis adds.
#[derive(Clone, Copy, Debug)]
pub struct Emitted {
    pub character: char,
    pub from: From,
    pub case: Case,
}

/// The characters that a hypothesis adds with a tap.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    items: [Emitted; 3],
    count: u8,
}

impl Emission {
    /// No character.
    pub const NOTHING: Self = Self {
        items: [Emitted {
            character: ' ',
            from: From::None,
            case: Case::Lower,
        }; 3],
        count: 0,
    };

    /// Returns the emission with one more character.
    pub fn with(mut self, character: char, from: From, case: Case) -> Self {
        if let Some(item) = self.items.get_mut(usize::from(self.count)) {
            *item = Emitted {
                character,
                from,
                case,
            };
            self.count += 1;
        }
        self
    }

    /// Returns the characters.
    pub fn items(&self) -> &[Emitted] {
        &self.items[..usize::from(self.count)]
    }
}

/// A hypothesis after the tap of this step.
#[derive(Clone, Copy, Debug)]
pub struct Next {
    pub token: Token,
    pub emission: Emission,
}

//! Hypotheses: what the taps until now may mean.

use crate::model::bigrams::Row;
use crate::model::lexicon::{Case, ROOT, case_of};
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

impl Emitted {
    /// A bit of every packed character, so that none is 0.
    const PRESENT: u32 = 1 << 31;

    /// Returns the character with its notes in one number.
    fn packed(self) -> u32 {
        Self::PRESENT
            | (self.from as u32) << 23
            | (self.case as u32) << 21
            | u32::from(self.character)
    }

    fn unpacked(packed: u32) -> Option<Self> {
        (packed != 0).then(|| Self {
            character: char::from_u32(packed & 0x1f_ffff).unwrap_or(char::REPLACEMENT_CHARACTER),
            from: match packed >> 23 & 3 {
                0 => From::This,
                1 => From::Previous,
                _ => From::None,
            },
            case: case_of((packed >> 21 & 3) as u8),
        })
    }
}

/// The characters that a hypothesis adds with a tap, two at most, packed into one number: hypotheses are copied all the time.
#[derive(Clone, Copy, Debug)]
pub struct Emission(u64);

impl Emission {
    /// No character.
    pub const NOTHING: Self = Self(0);

    /// Returns the emission with one more character.
    pub fn with(self, character: char, from: From, case: Case) -> Self {
        debug_assert!(self.0 >> 32 == 0, "no tap adds three characters");
        let last = Emitted {
            character,
            from,
            case,
        };
        Self(self.0 << 32 | u64::from(last.packed()))
    }

    /// Returns the last character.
    pub fn last(self) -> Option<Emitted> {
        Emitted::unpacked(self.0 as u32)
    }

    /// Returns the characters.
    pub fn items(self) -> impl Iterator<Item = Emitted> {
        let packed = [(self.0 >> 32) as u32, self.0 as u32];
        packed.into_iter().filter_map(Emitted::unpacked)
    }
}

/// The hypothesis that another one continues, by its index.
#[derive(Clone, Copy, Debug)]
pub enum Parent {
    /// A hypothesis of the last step.
    Last(u16),
    /// A hypothesis of the step before the last one.
    BeforeLast(u16),
}

/// A hypothesis after the tap of this step, with what its [`Parent`] does not know: most of them are dropped.
#[derive(Clone, Copy, Debug)]
pub struct Next {
    pub score: f32,
    pub place: Place,
    pub row: Row,
    pub parent: Parent,
    /// The key of the tap, if the tap tells where the hands are.
    pub moved: Option<u8>,
    pub emission: Emission,
}

impl Next {
    /// Returns a hypothesis as it is before the tap.
    pub fn after(token: &Token, parent: Parent) -> Self {
        Self {
            score: token.score,
            place: token.place,
            row: token.row,
            parent,
            moved: None,
            emission: Emission::NOTHING,
        }
    }

    /// Returns the node of the lexicon; the root in words that are not in it.
    pub fn node(&self) -> u32 {
        match self.place {
            Place::Word(node) => node,
            _ => ROOT,
        }
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_emission_keeps_its_characters_and_their_notes() {
        assert_eq!(Emission::NOTHING.items().count(), 0);
        let left_out = Emission::NOTHING.with('ñ', From::None, Case::Title);
        let both = left_out.with('\u{10ffff}', From::Previous, Case::Upper);
        let notes: Vec<_> = both
            .items()
            .map(|item| (item.character, item.from, item.case))
            .collect();
        let last = ('\u{10ffff}', From::Previous, Case::Upper);
        assert_eq!(notes, [('ñ', From::None, Case::Title), last]);
        assert_eq!(left_out.last().map(|item| item.from), Some(From::None));
        let typed = Emission::NOTHING.with(' ', From::This, Case::Lower);
        assert_eq!(typed.last().map(|item| item.from), Some(From::This));
    }
}

//! The letters of a language.

use super::ModelError;
use super::bytes::u32_at;

/// The index of a letter in its alphabet.
pub type Symbol = u8;

/// The most letters of an alphabet; a node of the lexicon has six bits for its letter.
pub const MAX_SYMBOLS: usize = 60;

/// The lower-case letters that the words of a language consist of, with the apostrophe.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alphabet {
    letters: Vec<char>,
}

impl Alphabet {
    /// Makes an alphabet of sorted, distinct letters.
    pub(crate) fn new(letters: Vec<char>) -> Self {
        debug_assert!(letters.is_sorted() && letters.len() <= MAX_SYMBOLS);
        Self { letters }
    }

    /// Returns the number of letters.
    pub fn len(&self) -> usize {
        self.letters.len()
    }

    /// Returns `true` if there is no letter.
    pub fn is_empty(&self) -> bool {
        self.letters.is_empty()
    }

    /// Returns the letters in the order of their symbols.
    pub fn letters(&self) -> &[char] {
        &self.letters
    }

    /// Returns the symbol of a lower-case letter.
    pub fn symbol(&self, letter: char) -> Option<Symbol> {
        self.letters
            .binary_search(&letter)
            .ok()
            .map(|index| index as Symbol)
    }

    /// Returns the letter of a symbol.
    pub fn letter(&self, symbol: Symbol) -> char {
        self.letters
            .get(usize::from(symbol))
            .copied()
            .unwrap_or(char::REPLACEMENT_CHARACTER)
    }

    pub(crate) fn write(&self) -> Vec<u8> {
        let codes = self.letters.iter().map(|&letter| u32::from(letter));
        codes.flat_map(u32::to_le_bytes).collect()
    }

    pub(super) fn read(section: &[u8]) -> Result<Self, ModelError> {
        let count = section.len() / 4;
        let letters: Option<Vec<char>> = (0..count)
            .map(|index| char::from_u32(u32_at(section, index * 4)))
            .collect();
        let letters = letters.ok_or(ModelError::Damaged("a letter of the alphabet"))?;
        let increases = letters.windows(2).all(|pair| pair[0] < pair[1]);
        if count == 0 || count > MAX_SYMBOLS || !section.len().is_multiple_of(4) || !increases {
            return Err(ModelError::Damaged("the alphabet"));
        }
        Ok(Self { letters })
    }
}

/// Returns the plain letter on whose key an accented letter is typed where it has no key of its own.
pub fn plain(letter: char) -> char {
    match letter {
        'á' | 'à' | 'â' | 'ä' | 'ã' | 'å' => 'a',
        'é' | 'è' | 'ê' | 'ë' => 'e',
        'í' | 'ì' | 'î' | 'ï' => 'i',
        'ó' | 'ò' | 'ô' | 'ö' | 'õ' => 'o',
        'ú' | 'ù' | 'û' | 'ü' => 'u',
        'ý' | 'ÿ' => 'y',
        'ñ' => 'n',
        'ç' => 'c',
        other => other,
    }
}

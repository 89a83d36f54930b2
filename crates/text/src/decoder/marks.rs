//! Punctuation and signs between words.

use super::Options;
use crate::correction::ends_word;

/// A sign between two words, such as the `@` of an address.
pub const JOINT: f32 = -4.5;

/// Returns `true` if the character ends a word as a space does.
pub fn is_punctuation(character: char) -> bool {
    matches!(
        character,
        '.' | ',' | ';' | ':' | '!' | '?' | '-' | '(' | ')' | '"' | '¡' | '¿'
    )
}

/// Returns `true` for a sign that stands between words and is not part of one: words on both sides may be of the lexicon.
pub fn joins_words(character: char) -> bool {
    (ends_word(character) || character == '_') && !is_punctuation(character) && character != ' '
}

/// The taps of a sentence from which on its end becomes no likelier.
const LONG: usize = 56;
/// The log-odds of a period against a comma, by the taps of the sentence before it, eight by eight: three quarters of what the short
/// sentences have that the English model is made of (−1.7 to 3.8), a quarter of what the guides of this program have (−3.3 to −0.3).
const PERIODS: [f32; LONG / 8 + 1] = [-1.6, -1.8, -0.4, 0.3, 0.8, 1.4, 2.0, 2.7];

/// Returns the log-probability of punctuation after a word, by the number of taps of its sentence: the probability of a comma,
/// [`Options::punctuation`], plus the log-odds of the character against a comma.
pub fn punctuation(options: &Options, character: char, taps: u16) -> f32 {
    let end = PERIODS[usize::from(taps).min(LONG) / 8];
    options.punctuation
        + match character {
            '.' => end,
            ',' => 0.0,
            '?' => end - 2.1,
            '!' => end - 2.7,
            '-' => -2.0,
            _ => -3.3,
        }
}

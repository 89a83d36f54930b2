//! Multitap keys: the letters between which taps in a row choose.

use super::builder::LayoutBuilder;
use crate::device::{KeyAction, KeyCode, Multitap, MultitapId};
use crate::document::{DocumentError, Spanned};

/// The maximum number of letters of a key.
const MAX_LETTERS: usize = 12;

/// Adds the letters of a key, which blanks separate.
pub(super) fn build_multitap<'a>(
    builder: &mut LayoutBuilder<'a>,
    Spanned { text }: Spanned<'a>,
) -> Result<MultitapId, DocumentError> {
    let mut multitap = Multitap::default();
    for word in text.split_whitespace() {
        let letter = letter(builder, word)?;
        if multitap.letters.contains(&letter) {
            let message = format!("duplicate letter `{word}` of a multitap key");
            return Err(builder.error(word, message));
        }
        multitap.letters.push(letter);
        multitap.label += &builder.default_label(Some(letter), word);
    }
    let count = multitap.letters.len();
    if !(2..=MAX_LETTERS).contains(&count) {
        let message =
            format!("a multitap key has 2 to {MAX_LETTERS} letters, this one has {count}");
        return Err(builder.error(text, message));
    }
    builder.add_multitap(multitap, text)
}

/// Returns `true` if a text is a list of 2 to 12 letters of a multitap key.
pub fn is_multitap(letters: &str) -> bool {
    let is_letter = |word: &str| match word.parse::<KeyCode>() {
        Ok(code) => types_character(code),
        Err(_) => is_character(word),
    };
    let count = letters.split_whitespace().count();
    (2..=MAX_LETTERS).contains(&count) && letters.split_whitespace().all(is_letter)
}

/// Returns `true` if a key types a character, which a further tap can replace.
fn types_character(code: KeyCode) -> bool {
    let character = code.us_character(false);
    character.is_some_and(|character| !character.is_control())
}

/// Returns `true` if a word is one character.
fn is_character(word: &str) -> bool {
    let mut characters = word.chars();
    characters.next().is_some_and(|first| !first.is_control()) && characters.next().is_none()
}

/// Returns the action of a letter: a key that types a character, or a character that no key has as its name.
fn letter<'a>(builder: &mut LayoutBuilder<'a>, word: &'a str) -> Result<KeyAction, DocumentError> {
    let spanned = Spanned { text: word };
    let Ok(code) = word.parse::<KeyCode>() else {
        if is_character(word) {
            return Ok(KeyAction::Text(builder.text_id(spanned)?));
        }
        return Err(builder.key_code(spanned).expect_err("no name of a key"));
    };
    if !types_character(code) {
        let message = format!("`{code}` types no character, which a further tap could replace");
        return Err(builder.error(word, message));
    }
    Ok(KeyAction::Key(code))
}

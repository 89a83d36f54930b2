//! Keyboards whose keys have several letters each, such as the keypad of a phone.

mod support;

use ademan_text::{Key, Keyboard, Mode, Options};
use support::field::Field;
use support::phrases::phrases;

/// The letters of the keys of a phone from 2 to 9.
const PAD: [&str; 8] = ["abc", "def", "ghi", "jkl", "mno", "pqrs", "tuv", "wxyz"];
/// The distance of the keys in millimetres.
const PITCH: [f32; 2] = [30.0, 22.0];

/// Returns the keypad of a phone, with a key for the space below.
fn pad() -> Keyboard {
    let key = |character, place: usize| Key {
        character,
        center: [(place % 3) as f32 * PITCH[0], (place / 3) as f32 * PITCH[1]],
        size: [27.0, 19.0],
        hand: 0,
    };
    let letters = PAD
        .iter()
        .zip(1..)
        .flat_map(|(letters, place)| letters.chars().map(move |character| key(character, place)));
    Keyboard::new(letters.chain([key(' ', 10)]))
}

/// Returns the first letter of the key of a letter, which a tap of it types.
fn typed(letter: char) -> char {
    let key = PAD.iter().find(|letters| letters.contains(letter));
    key.and_then(|letters| letters.chars().next())
        .unwrap_or(letter)
}

fn types(field: &mut Field, text: &str) {
    for letter in text.chars() {
        let position = field.center(letter);
        field.tap(position, typed(letter));
    }
}

fn field() -> Field<'static> {
    let options = Options {
        capitals: false,
        ..Options::default()
    };
    Field::on(ademan_text::languages::ENGLISH, pad(), options)
}

#[test]
fn nineteen_of_twenty_words_are_read_from_one_tap_a_letter() {
    let Some(phrases) = phrases(true) else {
        println!("SKIPPED nineteen_of_twenty_words_are_read_from_one_tap_a_letter: no sentences");
        return;
    };
    let is_typed = |letter: &char| letter.is_ascii_lowercase() || *letter == ' ';
    let (mut words, mut right) = (0, 0);
    for phrase in phrases.iter().take(200) {
        let phrase: String = phrase.chars().filter(is_typed).collect();
        let mut field = field();
        types(&mut field, &phrase);
        types(&mut field, " ");
        let text = field.text.to_lowercase();
        for (meant, read) in phrase.split(' ').zip(text.split(' ')) {
            words += 1;
            right += usize::from(meant == read);
        }
    }
    assert!(words > 1_000, "{words}");
    assert!(right * 20 >= words * 19, "{right} of {words}");
}

#[test]
fn each_letter_shows_the_likeliest_word_and_a_backspace_deletes_one() {
    let mut field = field();
    types(&mut field, "hello");
    assert_eq!(field.text, "hello");
    // It undoes no correction: what was typed is no word.
    field.backspace();
    assert_eq!(field.text, "hell");
    types(&mut field, "o ");
    assert_eq!(field.text, "hello ");
    for left in ["hello", "hell", "hel"] {
        field.backspace();
        assert_eq!(field.text, left);
    }
    types(&mut field, "p ");
    assert_eq!(field.text, "help ");
}

#[test]
fn the_first_letters_of_the_keys_are_a_word_like_any_other() {
    let mut field = field();
    // They spell `gap`.
    types(&mut field, "he has ");
    assert_eq!(field.text, "he has ");
}

#[test]
fn a_candidate_takes_the_place_of_the_word() {
    let mut field = field();
    types(&mut field, "home");
    let candidates = field.candidates();
    for word in ["good", "home"] {
        assert!(candidates.iter().any(|it| it == word), "{candidates:?}");
    }
    let other = candidates.iter().position(|it| *it != field.text);
    let other = other.expect("another word");
    field.accept(other);
    assert_eq!(field.text, format!("{} ", candidates[other]));
}

#[test]
fn without_corrections_the_first_letters_are_shown_and_are_no_candidate() {
    let mut field = field();
    field.corrector.set_mode(Mode::Suggest);
    types(&mut field, "home");
    assert_eq!(field.text, "gmmd");
    let candidates = field.candidates();
    assert_eq!(candidates.len(), 3);
    assert!(candidates.iter().all(|it| it != "gmmd"), "{candidates:?}");
}

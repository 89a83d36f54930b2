//! The capitals of corrected words.

mod support;

use ademan_text::Mode;
use support::field::Field;

#[test]
fn capitals_that_were_typed_stay() {
    let mut field = Field::new(Mode::Auto);
    field.types("Teh HELLO WRoLD cAt HELOL ");
    assert_eq!(field.text, "The HELLO World cAt HELLO ");
}

#[test]
fn a_word_in_capitals_has_no_other_letters_and_a_first_capital_stays_first() {
    for (typed, corrected) in [
        ("of WISDM ", "of WISDOM "),
        ("the QICK cat ", "the QUICK cat "),
        ("of HELL ", "of HELLO "),
        ("I DNO'T ", "I DON'T "),
        ("of Hte cat ", "of The cat "),
        ("of Orld ", "of World "),
    ] {
        let mut field = Field::new(Mode::Auto);
        field.types(typed);
        assert_eq!(field.text, corrected);
    }
}

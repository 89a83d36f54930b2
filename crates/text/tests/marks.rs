//! Marks and signs that were typed on purpose, among words that are corrected.

mod support;

use ademan_text::correction::Restored;
use ademan_text::languages::{ENGLISH, SPANISH};
use ademan_text::{Corrector, Mode, Options};
use support::field::{Field, english};
use support::simulated::{full_keyboard, keyboard};

fn field(language: &[u8], capitals: bool) -> Field<'_> {
    let options = Options {
        capitals,
        ..Options::default()
    };
    Field::on(language, full_keyboard(), options)
}

/// Returns what a field has after a text that was tapped in the middle of the keys.
fn typed(language: &[u8], text: &str, capitals: bool) -> String {
    let mut field = field(language, capitals);
    field.types(text);
    field.text
}

fn check(language: &[u8], cases: &[(&str, &str)]) {
    let read = |(text, _): &(&str, &str)| typed(language, text, false);
    let wrong: Vec<_> = cases
        .iter()
        .map(|case| (*case, read(case)))
        .filter(|((_, expected), found)| found != expected)
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn marks_that_open_stay_while_words_after_them_are_corrected() {
    check(
        ENGLISH,
        &[
            ("see (the cat) and teh dog ", "see (the cat) and the dog "),
            ("he said \"teh cat\" now ", "he said \"the cat\" now "),
            ("it is -5 and teh dog ", "it is -5 and the dog "),
            ("we saw 'teh cat' here ", "we saw 'the cat' here "),
        ],
    );
    check(
        SPANISH,
        &[
            ("hola ¡qeu bien! ", "hola ¡que bien! "),
            ("dijo ¿qeu quieres? ", "dijo ¿que quieres? "),
        ],
    );
}

#[test]
fn signs_inside_addresses_and_code_stay() {
    check(
        ENGLISH,
        &[
            ("ana@mail.com ", "ana@mail.com "),
            ("user@example.com ", "user@example.com "),
            ("he/she adn they ", "he/she and they "),
            ("key=value adn so ", "key=value and so "),
            ("user_name adn so ", "user_name and so "),
            ("#news adn so ", "#news and so "),
            ("https://example.com/ ", "https://example.com/ "),
            ("baz(qux) adn so ", "baz(qux) and so "),
            ("pages 5-6 adn so ", "pages 5-6 and so "),
            ("x<y adn so ", "x<y and so "),
        ],
    );
}

#[test]
fn a_correction_does_not_lower_the_margin_of_the_words_after_it() {
    for word in ["git", "nuria"] {
        let alone = typed(ENGLISH, &format!("the old cat and {word} is "), false);
        let after = typed(ENGLISH, &format!("teh old cat and {word} is "), false);
        assert_eq!(alone, after);
        // A Backspace inside the word changes nothing.
        let mut field = field(ENGLISH, false);
        field.types(&format!("teh old cat and {word}x"));
        field.backspace();
        field.types(" is ");
        assert_eq!(field.text, alone);
    }
}

#[test]
fn the_spanish_conjunction_before_an_o_is_a_word() {
    check(
        SPANISH,
        &[
            ("siete u ocho ", "siete u ocho "),
            ("uno u otro ", "uno u otro "),
            ("mujer u hombre ", "mujer u hombre "),
        ],
    );
}

#[test]
fn plurals_and_forms_of_spanish_verbs_are_words_with_their_accents() {
    check(
        SPANISH,
        &[
            (
                "me preguntaron cuando llegaria ",
                "me preguntaron cuando llegaría ",
            ),
            ("dos platanos ", "dos plátanos "),
            ("no se si podre ir ", "no sé si podré ir "),
        ],
    );
}

#[test]
fn a_capital_follows_a_mark_and_a_space_only() {
    for (text, shown) in [
        ("write to gmail.com now ", "Write to gmail.com now "),
        ("it is done. the cat ", "It is done. The cat "),
        ("he said \"stop.\" the cat ", "He said \"stop.\" The cat "),
        ("really? yes. ", "Really? Yes. "),
    ] {
        assert_eq!(typed(ENGLISH, text, true), shown);
    }
}

#[test]
fn a_capital_of_a_swiped_word_follows_a_mark_that_is_final_and_a_space() {
    let mut field = Field::on(english(), keyboard(), Options::default());
    let decoder = field.corrector.decoder().clone().with_swipes();
    field.corrector = Corrector::new(decoder, Mode::Auto, Restored::default());
    let rest = "cat sat the cat sat the cat sat the wisdom of the world.";
    field.types(&format!("the {rest}"));
    assert_eq!(field.corrector.decoder().taps(), 0, "it is final");
    field.types(" ");
    field.swipes("quick");
    assert_eq!(field.text, format!("The {rest} Quick "));
    field.backspace();
    assert_eq!(field.text, format!("The {rest} "));
}

#[test]
fn words_that_a_correction_leaves_as_they_are_may_be_corrected_later() {
    let mut field = field(ENGLISH, false);
    field.types("teh cat adn ");
    field.backspace();
    let mut words: Vec<&str> = field.corrector.restored().words().collect();
    words.sort_unstable();
    assert!(!words.contains(&"cat") && !words.is_empty(), "{words:?}");
}

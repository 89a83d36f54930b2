//! The beliefs of the decoder about a person and a sentence.

mod support;

use ademan_text::correction::Restored;
use ademan_text::{Decoder, Mode, Model, Options, Prior, Tap, TouchModel};
use support::field::{Field, english};
use support::simulated::keyboard;

#[test]
fn letters_in_the_wrong_order_are_learned_and_become_more_or_less_likely() {
    let learned = |typed: &str| {
        let mut field = Field::new(Mode::Auto);
        for _ in 0..20 {
            field.types(typed);
        }
        let errors = field.corrector.decoder().touch().errors;
        (
            errors.swapped,
            errors.swapped_change(Options::default().transposition),
        )
    };
    let (none, rarer) = learned("the quick fox. ");
    assert_eq!(none, 0.0);
    assert!(rarer < -0.5, "{rarer}");
    let (some, likelier) = learned("teh qiuck fox. ");
    assert!((10.0..=40.0).contains(&some), "{some}");
    assert!(likelier > 1.0, "{likelier}");
}

#[test]
fn a_tap_between_period_and_comma_ends_a_long_sentence_and_no_short_one() {
    let keyboard = keyboard();
    let center =
        |character: char| keyboard.keys()[keyboard.index(character).expect("a key")].center;
    let [comma, period] = [center(','), center('.')];
    let between = std::array::from_fn(|axis| (comma[axis] + period[axis]) / 2.0);
    let read = |text: &str| {
        let model = Model::from_bytes(english()).expect("a model");
        let touch = TouchModel::new(Prior::default());
        let mut decoder = Decoder::new(model, keyboard.clone(), touch, Options::default());
        for [x, y] in text.chars().map(center).chain([between]) {
            decoder.tap(Tap::at(x, y));
        }
        decoder.best().to_owned()
    };
    assert_eq!(read("hello"), "Hello,");
    assert_eq!(
        read("the cat sat of the wisdom of the world"),
        "The cat sat of the wisdom of the world."
    );
    // A sentence before it does not count.
    let sentence = "the cat sat of the wisdom of the world. hello";
    assert_eq!(
        read(sentence),
        "The cat sat of the wisdom of the world. Hello,"
    );
}

#[test]
fn an_error_that_is_never_believed_is_not_free() {
    let never = -1_000.0;
    let options = Options {
        omission: never,
        insertion: never,
        transposition: never,
        missing_space: never,
        ..Options::default()
    };
    let mut field = Field::with(Mode::Auto, Restored::default(), options);
    // Each of them is an error of one of these kinds.
    for typed in ["teh ", "wisdm ", "wisdxom ", "worldof "] {
        field.types(typed);
        assert!(field.text.ends_with(typed), "{}", field.text);
    }
    let mut usual = Field::new(Mode::Auto);
    usual.types("teh ");
    assert_eq!(usual.text, "the ");
}

#[test]
fn the_rest_of_a_word_is_no_unknown_word() {
    let mut field = Field::new(Mode::Auto);
    for _ in 0..15 {
        // An arrow, for example.
        field.corrector.leave();
        field.types("nif ");
    }
    field.text.clear();
    field.types("helo ");
    assert_eq!(field.text, "hello ");
}

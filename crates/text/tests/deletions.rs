//! Backspaces and candidates after long texts.

mod support;

use ademan_text::Mode;
use support::field::Field;

#[test]
fn a_backspace_in_an_endless_word_leaves_the_rest_of_it_alone() {
    for mode in [Mode::Suggest, Mode::Auto] {
        let mut field = Field::new(mode);
        field.types(&"x".repeat(85));
        field.backspace();
        assert_eq!(field.text, "x".repeat(84));
        let taps = field.corrector.decoder().taps();
        assert_eq!(taps, 0, "none is decoded again");
        assert!(field.corrector.is_inside_word());
        let word = "x".repeat(84) + "teh ";
        field.types("teh ");
        assert_eq!(field.text, word, "the rest of a word is no word");
        field.types("teh ");
        let next = if mode == Mode::Auto { "the " } else { "teh " };
        assert_eq!(field.text, word + next);
    }
}

#[test]
fn a_backspace_in_the_last_word_of_a_text_that_is_not_final_takes_its_tap_back() {
    let mut field = Field::new(Mode::Auto);
    let sentence = "the cat sat ".repeat(4) + "the cat of ";
    assert_eq!(sentence.len(), 59);
    field.types(&sentence);
    field.types("wisdmox");
    field.backspace();
    assert_eq!(field.corrector.decoder().taps(), 65);
    field.types(" ");
    assert_eq!(field.text, sentence + "wisdom ");
}

#[test]
fn the_rest_of_a_corrected_word_that_is_deleted_into_is_left_alone() {
    let mut field = Field::new(Mode::Auto);
    field.types("teh c");
    assert_eq!(field.text, "the c");
    for left in ["the ", "the", "th"] {
        field.backspace();
        assert_eq!(field.text, left);
    }
    assert!(field.corrector.is_inside_word());
    // The taps that are left are a `t` and an `e`.
    field.types("at ");
    assert_eq!(field.text, "that ");
    field.types("teh ");
    assert_eq!(field.text, "that the ");
}

#[test]
fn a_capital_that_was_set_does_not_end_the_correction_of_its_word() {
    let mut field = Field::new(Mode::Auto);
    field.types("i c");
    assert_eq!(field.text, "I c");
    for left in ["I ", "I"] {
        field.backspace();
        assert_eq!(field.text, left);
    }
    assert!(field.corrector.knows_word());
}

#[test]
fn the_rest_of_a_word_after_a_candidate_that_is_out_of_reach_is_left_alone() {
    let mut field = Field::new(Mode::Suggest);
    let typed = "teh wisdom of the world wisdom of the world hel";
    field.types(typed);
    let candidates = field.candidates();
    assert!(candidates[0].starts_with("the "), "{candidates:?}");
    assert!(field.corrector.accept(0).is_empty(), "more than 84 edits");
    field.corrector.set_mode(Mode::Auto);
    field.types("teh ");
    assert_eq!(field.text, format!("{typed}teh "));
    field.types("teh ");
    assert_eq!(field.text, format!("{typed}teh the "));
}

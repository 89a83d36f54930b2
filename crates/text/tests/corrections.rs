//! Corrections as a text field shows them.

mod support;

use ademan_text::build::Builder;
use ademan_text::correction::Restored;
use ademan_text::{Corrector, Mode, Options, SwipePath, Tap};
use support::field::{Field, english};
use support::simulated::{PITCH, keyboard};

#[test]
fn a_word_is_corrected_at_its_end_in_one_burst() {
    let mut field = Field::new(Mode::Auto);
    field.types("teh");
    assert_eq!(field.text, "teh", "letters are typed at once");
    field.types(" ");
    assert_eq!(field.text, "the ");
    assert_eq!(
        field.edits,
        1 + 3 + 3,
        "the space, and the tail that differs"
    );
    field.types("qiuck ");
    assert_eq!(field.text, "the quick ");
}

#[test]
fn spaces_are_moved_and_apostrophes_and_names_are_set() {
    for (typed, shown) in [
        ("the wisdomof the ", "the wisdom of the "),
        ("the wis dom of ", "the wisdom of "),
        ("i dont ", "I don't "),
        ("the helo world ", "the hello world "),
    ] {
        let mut field = Field::new(Mode::Auto);
        field.types(typed);
        assert_eq!(field.text, shown);
    }
}

#[test]
fn one_backspace_restores_what_was_typed_and_the_word_is_not_changed_again() {
    let mut field = Field::new(Mode::Auto);
    field.types("teh ");
    field.backspace();
    assert_eq!(field.text, "teh ");
    field.types("teh teh, ");
    assert_eq!(field.text, "teh teh teh, ");
    assert!(field.corrector.restored().words().eq(["teh"]));
    // The knowledge can be stored.
    let stored = field.corrector.restored().clone();
    let mut restored = Field::with(Mode::Auto, stored, Options::default());
    restored.types("teh ");
    assert_eq!(restored.text, "teh ");
    // A second Backspace deletes as usual.
    restored.backspace();
    assert_eq!(restored.text, "teh");
    restored.types(" hlelo ");
    assert_eq!(restored.text, "teh hello ");
}

#[test]
fn a_backspace_inside_a_word_takes_its_tap_back() {
    let mut field = Field::new(Mode::Auto);
    field.types("teh wordl");
    field.backspace();
    field.backspace();
    field.types("ld ");
    assert_eq!(field.text, "the world ");
    field.types("helx");
    for _ in 0..4 {
        field.backspace();
    }
    field.types("cta ");
    assert_eq!(field.text, "the world cat ");
}

#[test]
fn text_that_is_deleted_into_is_left_alone() {
    let mut field = Field::new(Mode::Auto);
    field.types("teh cat ");
    field.backspace();
    field.backspace();
    assert_eq!(field.text, "the ca");
    field.types("hte ");
    assert_eq!(field.text, "the cahte ", "the rest of a word is no word");
    field.types("hte ");
    assert_eq!(field.text, "the cahte the ");
}

#[test]
fn literal_mode_passes_every_press_on() {
    let mut field = Field::new(Mode::Literal);
    let typed = "teh WISDOMof  x1!;é \u{1f600} qiuck.";
    for character in typed.chars() {
        field.tap([3.0, 3.0], character);
        assert_eq!(field.edits, 1);
    }
    assert_eq!(field.text, typed);
    assert!(field.corrector.candidates().is_empty());
    assert!(field.corrector.accept(0).is_empty());
    field.backspace();
    assert_eq!(field.edits, 1);
}

#[test]
fn suggest_mode_changes_only_what_is_accepted() {
    let mut field = Field::new(Mode::Suggest);
    field.types("teh ");
    assert_eq!(field.text, "teh ");
    let candidates = field.candidates();
    assert_eq!(candidates[0], "the ");
    assert!(candidates.contains(&"teh ".to_owned()), "{candidates:?}");
    field.accept(0);
    assert_eq!(field.text, "the ");
    field.backspace();
    assert_eq!(field.text, "teh ");
}

#[test]
fn an_accepted_candidate_is_followed_by_a_space_and_not_changed_by_what_follows() {
    for mode in [Mode::Suggest, Mode::Auto] {
        let mut field = Field::new(mode);
        field.types("teh");
        let index = field.candidates().iter().position(|one| one == "the");
        field.accept(index.expect("the word"));
        assert_eq!(field.text, "the ");
        field.types("cat ");
        assert_eq!(field.text, "the cat ");
        field.types("wrdl");
        let candidates = field.candidates();
        let typed = candidates.iter().position(|one| one.ends_with("wrdl"));
        field.accept(typed.expect("it is one"));
        assert_eq!(field.text, "the cat wrdl ");
        field.types("cat ");
        assert_eq!(field.text, "the cat wrdl cat ");
    }
}

#[test]
fn a_candidate_that_is_taken_back_inside_a_word_leaves_the_rest_of_the_word_alone() {
    let mut field = Field::auto(ademan_text::languages::ENGLISH);
    field.types("th");
    field.accept(1);
    assert!(field.text.ends_with(' '), "{}", field.text);
    field.backspace();
    assert_eq!(field.text, "th");
    field.types("eir ");
    assert_eq!(field.text, "their ");
    let restored = field.corrector.restored();
    assert_eq!(restored.words().len(), 0, "the beginning of a word");
    field.types("teh ");
    assert_eq!(field.text, "their the ");
}

#[test]
fn the_rest_of_a_word_after_the_cursor_is_not_corrected() {
    let mut field = Field::new(Mode::Auto);
    field.types("cat");
    field.corrector.leave();
    field.types("hte teh ");
    assert_eq!(field.text, "cathte the ");
    field.types("te");
    field.corrector.start_line();
    field.types("teh ");
    assert_eq!(field.text, "cathte the tethe ");
    assert_eq!(field.corrector.shown(), "the ");
}

#[test]
fn a_pause_drops_what_is_pending() {
    let mut field = Field::new(Mode::Auto);
    field.types("te");
    field.corrector.reset();
    field.types("h ");
    assert_eq!(field.text, "teh ", "half a word is not corrected");
    field.types("teh ");
    assert_eq!(field.text, "teh the ");
    field.corrector.reset();
    field.backspace();
    assert_eq!(
        field.text, "teh the",
        "a Backspace after a pause only deletes"
    );
}

#[test]
fn numbers_signs_and_unknown_words_are_left_alone() {
    for bytes in [english(), ademan_text::languages::ENGLISH] {
        let mut field = Field::auto(bytes);
        let typed = "xk47 1984 a-b zyzzogeton 3.14 kubectl 10-12 blorft, ";
        field.types(typed);
        assert_eq!(field.text, typed);
    }
}

#[test]
fn sentences_start_with_a_capital_if_asked_to() {
    let mut field = Field::on(english(), keyboard(), Options::default());
    for character in "hello world. the cat ".chars() {
        let [x, y] = field.center(character);
        Field::apply(&mut field.text, field.corrector.press(Tap::at(x, y)));
    }
    assert_eq!(field.text, "Hello world. The cat ");
}

#[test]
fn accents_are_set_by_likelihood() {
    let mut builder = Builder::new();
    builder
        .words("cómo\t5\ncomo\t50\nestá\t40\nniño\t10")
        .expect("a list");
    let sentence = "¿cómo está?\nalto como él\n";
    builder.text(&sentence.repeat(5));
    let bytes = builder.build().expect("a model");
    let mut field = Field::auto(&bytes);
    field.types("como esta ");
    assert_eq!(field.text, "cómo está ");
    let mut other_field = Field::auto(&bytes);
    other_field.types("alto como el nino ");
    assert_eq!(other_field.text, "alto como él niño ");
}

#[test]
fn a_long_text_stays_in_step() {
    let mut field = Field::new(Mode::Auto);
    for _ in 0..200 {
        field.types("the cta ");
    }
    assert_eq!(field.text, "the cat ".repeat(200));
    // A word without an end.
    let mut endless_field = Field::new(Mode::Auto);
    let endless = "x".repeat(2_000);
    endless_field.types(&endless);
    endless_field.types(" teh ");
    assert_eq!(endless_field.text, endless + " the ");
}

#[test]
fn a_sentence_after_a_committed_one_is_corrected() {
    let mut field = Field::new(Mode::Auto);
    // Long enough that the decoder commits at the period, in front of the space.
    let sentence = "the quick brown fox and the lazy dog and the quick brown fox.";
    field.types(sentence);
    assert_eq!(field.corrector.decoder().taps(), 0, "it is committed");
    field.types(" teh dog ");
    assert_eq!(field.text, format!("{sentence} the dog "));
    // After a pause, too.
    field.types("the fox.");
    field.corrector.reset();
    field.types(" qiuck dog ");
    assert_eq!(
        field.text,
        format!("{sentence} the dog the fox. quick dog ")
    );
}

#[test]
fn a_letter_after_a_sentence_has_no_empty_candidate() {
    let mut field = Field::new(Mode::Suggest);
    field.types("the cat. ");
    field.corrector.reset();
    // Far from the space bar, and near it: a space that was missed offers no word.
    for (letter, has_candidates) in [("a", true), ("c", false)] {
        field.types(letter);
        let candidates = field.corrector.candidates();
        assert_eq!(!candidates.is_empty(), has_candidates, "{letter}");
        assert!(candidates.iter().all(|it| !it.text.trim().is_empty()));
        field.corrector.reset();
    }
}

#[test]
fn a_quotation_mark_after_a_comma_stays() {
    let mut field = Field::new(Mode::Auto);
    field.types("the fox,' the dog ");
    assert_eq!(field.text, "the fox,' the dog ");
}

#[test]
fn what_was_corrected_stays_while_no_word_is_complete() {
    let options = Options {
        beam: 1,
        ..Options::default()
    };
    let mut field = Field::with(Mode::Auto, Restored::default(), options);
    field.types("thr w");
    assert_eq!(field.text, "the w");
    // An `o` that hit the hyphen: the only hypothesis is in the middle of `world`.
    let [x, y] = field.center('o');
    field.tap([x, y - 0.4 * PITCH], '-');
    assert_eq!(field.text, "the w-");
    field.types("rld ");
    assert_eq!(field.text, "the world ");
}

#[test]
fn the_first_letter_after_unknown_text_is_no_space() {
    let mut field = Field::auto(ademan_text::languages::ENGLISH);
    field.corrector.reset();
    field.types("n2a ");
    assert_eq!(field.text, "n2a ");
    field.corrector.start_line();
    field.types("vut ");
    assert_eq!(field.text, "n2a but ");
}

#[test]
fn lines_are_learned_from() {
    let mut field = Field::new(Mode::Auto);
    let known = |at: &Field| at.corrector.decoder().touch().person.taps;
    field.types("the cat");
    assert_eq!(known(&field), 0.0);
    field.corrector.reset();
    let at_pause = known(&field);
    assert!(at_pause > 5.0, "{at_pause}");
    field.types(" the cat sat");
    field.corrector.start_word();
    assert!(known(&field) > at_pause + 5.0, "{}", known(&field));
    assert_eq!(field.text, "the cat the cat sat");
    // Nothing is learned from a line that stays although another text is more probable.
    let mut other = Field::new(Mode::Suggest);
    for leave in [Corrector::reset, Corrector::start_word] {
        other.types("teh");
        leave(&mut other.corrector);
        assert_eq!(known(&other), 0.0);
    }
}

#[test]
fn a_copy_reads_on_as_the_original_does() {
    let mut field = Field::new(Mode::Auto);
    field.types("the wisdom of teh ");
    let mut copy = field.corrector.clone();
    for character in "wrold ".chars() {
        let tap = Tap {
            position: field.center(character),
            typed: Some(character),
        };
        assert_eq!(copy.press(tap), field.corrector.press(tap));
    }
    assert_eq!(copy.shown(), "the wisdom of the world ");
}

#[test]
fn a_swiped_word_replaces_its_letter_and_one_backspace_deletes_all_of_it() {
    for mode in [Mode::Suggest, Mode::Auto] {
        let mut field = Field::new(mode);
        field.types("the ");
        field.swipes("quick");
        assert_eq!(field.text, "the quick ");
        // The word has the same first letter, so it stays.
        assert_eq!(field.edits, 5);
        field.backspace();
        assert_eq!(field.text, "the ");
        field.backspace();
        assert_eq!(field.text, "the");
    }
}

#[test]
fn a_swipe_that_starts_beside_its_first_letter_replaces_it() {
    let mut field = Field::new(Mode::Auto);
    field.swipes("quick");
    field.backspace();
    assert_eq!(field.text, "");
    // `w` is beside `q`.
    let mut path = SwipePath::default();
    for letter in "wuick".chars() {
        let index = field.keyboard.index(letter).expect("a key");
        path.push(field.keyboard.keys()[index].center);
    }
    field.types("w");
    let edits = field.corrector.swipe(path.points());
    Field::apply(&mut field.text, edits);
    assert_eq!(field.text, "quick ");
}

#[test]
fn a_candidate_replaces_a_swiped_word_and_is_context_for_the_next() {
    let mut field = Field::new(Mode::Auto);
    field.swipes("cat");
    let candidates = field.candidates();
    assert_eq!(candidates[0], "cat");
    assert!(candidates.len() > 1, "{candidates:?}");
    field.accept(1);
    assert_eq!(field.text, format!("{} ", candidates[1]));
    field.backspace();
    assert_eq!(field.text, "");
}

#[test]
fn a_swipe_after_a_word_without_a_space_gets_one_and_keeps_a_typed_capital() {
    let mut field = Field::new(Mode::Auto);
    field.types("cat");
    field.swipes("Sat");
    assert_eq!(field.text, "cat Sat ");
    field.backspace();
    assert_eq!(field.text, "cat");
}

#[test]
fn a_swipe_that_is_taken_back_inside_a_word_leaves_the_rest_of_the_word_alone() {
    for is_left in [false, true] {
        let mut field = Field::new(Mode::Auto);
        field.types("cat");
        if is_left {
            field.corrector.leave();
        }
        field.swipes("quick");
        field.backspace();
        assert_eq!(field.text, "cat");
        field.types("hte hte ");
        assert_eq!(field.text, "cathte the ");
    }
}

#[test]
fn taps_after_a_swipe_are_corrected_and_a_reset_drops_its_candidates() {
    let mut field = Field::new(Mode::Auto);
    field.swipes("the");
    field.types("wisdim ");
    assert_eq!(field.text, "the wisdom ");
    field.swipes("cat");
    field.corrector.reset();
    let before = field.text.clone();
    field.backspace();
    assert_eq!(field.edits, 1);
    assert_eq!(field.text, before.trim_end());
    assert!(field.corrector.candidates().is_empty());
}

#[test]
fn a_literal_corrector_swipes_nothing() {
    let mut field = Field::new(Mode::Literal);
    field.swipes("quick");
    assert_eq!(field.text, "q");
}

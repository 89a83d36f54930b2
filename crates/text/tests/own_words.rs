//! The words of the person: what is never changed, and what slips are corrected to.

mod support;

use ademan_text::correction::Restored;
use ademan_text::{Mode, Options};
use support::field::{Field, english};
use support::simulated::keyboard;

fn field(words: &[&str]) -> Field<'static> {
    let words: Vec<String> = words.iter().map(|&word| word.to_owned()).collect();
    Field::with(Mode::Auto, Restored::from(words), Options::default())
}

/// Types a word whose last tap is hardly on the key beside the one that is meant.
fn slip(field: &mut Field, start: &str, [typed, meant]: [char; 2]) {
    field.types(start);
    let [own, other] = [field.center(typed), field.center(meant)];
    let position = std::array::from_fn(|axis| 0.52 * own[axis] + 0.48 * other[axis]);
    field.tap(position, typed);
    field.types(" ");
}

#[test]
fn slips_become_words_of_the_person() {
    for (typed, without, with) in [
        ("hello nuris ", "hello nuris ", "hello Nuria "),
        ("the rockey of ", "the rockey of ", "the rocket of "),
        ("the rocet of ", "the rocet of ", "the rocket of "),
        ("hello nurai ", "hello nurai ", "hello Nuria "),
    ] {
        let mut plain = field(&[]);
        plain.types(typed);
        assert_eq!(plain.text, without);
        let mut own = field(&["Nuria", "rocket"]);
        own.types(typed);
        assert_eq!(own.text, with);
    }
}

#[test]
fn words_of_the_person_are_candidates_and_can_be_swiped() {
    let mut typing = field(&["nuria"]);
    typing.types("the nuri");
    let candidates = typing.candidates();
    assert!(
        candidates.iter().any(|one| one.ends_with("nuria")),
        "{candidates:?}"
    );
    let mut swiping = field(&["nuria"]);
    swiping.types("the ");
    swiping.swipes("nuria");
    assert_eq!(swiping.text, "the nuria ");
}

#[test]
fn a_word_that_is_brought_back_is_one_of_the_person() {
    let mut field = field(&[]);
    field.types("the quic ");
    assert_eq!(field.text, "the quick ");
    field.backspace();
    slip(&mut field, "of qui", ['v', 'c']);
    assert_eq!(field.text, "the quic of quic ");
}

#[test]
fn an_unknown_word_is_one_of_the_person_after_its_third_use() {
    let mut field = field(&[]);
    let more = "the wisdom of the world and the cat sat. the wisdom of the world. ";
    field.types("the rocket of rocket. ");
    field.types(more);
    assert_eq!(field.corrector.restored().words().len(), 0);
    field.types("the rocket of ");
    // It is final after some more text.
    field.types(more);
    assert!(field.corrector.restored().words().eq(["rocket"]));
    field.text.clear();
    slip(&mut field, "of rocke", ['y', 't']);
    assert!(field.text.ends_with("f rocket "), "{}", field.text);
}

#[test]
fn a_word_that_starts_sentences_is_learned_without_their_capital() {
    let mut field = Field::on(english(), keyboard(), Options::default());
    let more = "the wisdom of the world and the cat sat. the wisdom of the world. ";
    for _ in 0..3 {
        field.types("rocket of the world. ");
        field.types(more);
    }
    assert!(field.text.contains("Rocket of "), "{}", field.text);
    let learned: Vec<&str> = field.corrector.restored().words().collect();
    // The lexicon of the test lacks `and`.
    assert_eq!(learned, ["rocket", "and"]);
}

#[test]
fn what_was_learned_is_forgotten() {
    let mut field = field(&["Nuria"]);
    for _ in 0..30 {
        field.types("the wisdom of the world ");
    }
    assert!(field.corrector.decoder().touch().person.taps > 100.0);
    field.corrector.forget();
    let touch = field.corrector.decoder().touch();
    assert!(touch.person.taps == 0.0 && touch.errors.taps == 0.0);
    assert!(touch.keys.iter().all(|key| key.sums.taps == 0.0));
    field.text.clear();
    field.types("hello nuris ");
    assert_eq!(field.text, "hello nuris ");
}

#[test]
fn another_layout_takes_the_words_over() {
    let before = field(&["nuria"]);
    let mut after = field(&["rocket"]);
    after.corrector.take_over(&before.corrector);
    after.types("hello nuris ");
    assert_eq!(after.text, "hello nuria ");
    assert!(after.corrector.restored().words().eq(["nuria"]));
}

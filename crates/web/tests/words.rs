//! The text decoder in the session of the page.

use std::time::Duration;

use ademan_core::command::TextMode;
use ademan_core::document::Document;
use ademan_text::filter::Language;
use ademan_web::{HandState, PageSession};
use serde_json::{Value, json};

const FRAME: Duration = Duration::from_micros(16_667);

fn session(layout: &str, mode: TextMode) -> PageSession {
    let text = Document::shipped(layout).expect("a shipped layout").text;
    let mut session = PageSession::new(&text).expect("a valid layout");
    let english = Language::load("en", |_| unreachable!("it comes with the crate"));
    let english = english.expect("a shipped language");
    session.use_decoder(Box::new(move |given, wanted| {
        english.filter(given, wanted, false, true)
    }));
    session.set_text_mode(mode);
    session
}

/// Keeps the candidates of lines.
fn hear(lines: &str, told: &mut Option<Value>) {
    for line in lines.lines() {
        let object: Value = serde_json::from_str(line).expect("an object");
        if object["kind"] == "candidates" {
            *told = Some(object);
        }
    }
}

/// Lets frames pass, and keeps the candidates that the page is told last.
fn pass(session: &mut PageSession, frames: usize, told: &mut Option<Value>) {
    for _ in 0..frames {
        hear(&session.advance(FRAME), told);
    }
}

/// Types a text and returns the candidates that are shown at its end.
fn type_text(session: &mut PageSession, text: &str) -> Value {
    assert_eq!(session.type_text(text), []);
    let mut told = None;
    loop {
        pass(session, 1, &mut told);
        if session.hand_state() == HandState::Resting {
            return told.expect("candidates");
        }
    }
}

#[test]
fn a_word_is_corrected_at_its_end_and_not_in_the_literal_mode() {
    for (mode, expected) in [
        (TextMode::Auto, "the quick "),
        (TextMode::Suggest, "thw quick "),
        (TextMode::Literal, "thw quick "),
    ] {
        let mut session = session("qwerty-flat", mode);
        type_text(&mut session, "thw quick ");
        assert_eq!(session.text(), expected, "{mode:?}");
    }
}

#[test]
fn the_hand_types_one_tap_a_letter_where_the_decoder_finds_them() {
    for (mode, expected) in [
        (TextMode::Auto, "hello world "),
        // The first letter of each key, until a candidate is taken.
        (TextMode::Suggest, "gdjjm wmpjd "),
    ] {
        let mut session = session("phone-words", mode);
        type_text(&mut session, "hello world ");
        assert_eq!(session.text(), expected, "{mode:?}");
    }
}

#[test]
fn a_candidate_is_taken_while_the_hand_rests_and_after_another_layout() {
    let mut session = session("qwerty-flat", TextMode::Suggest);
    let other = Document::shipped("qwerty-arc").expect("a shipped layout");
    for _ in 0..2 {
        session.clear_text();
        let told = type_text(&mut session, "quicl");
        assert_eq!(told["mode"], "suggest");
        let words = told["words"].as_array().expect("words");
        let number = words.iter().position(|word| word == "quick");
        let number = number.unwrap_or_else(|| panic!("{words:?}"));
        session.choose(u8::try_from(number + 1).expect("one of three"));
        let mut choice_told = None;
        pass(&mut session, 3, &mut choice_told);
        assert_eq!(session.text(), "quick ");
        session.set_layout(&other.text);
    }
}

#[test]
fn a_layout_with_few_letters_has_no_decoder_and_the_mode_stays_for_the_next_one() {
    let mut session = session("chords-bend", TextMode::Auto);
    let mut told = None;
    pass(&mut session, 1, &mut told);
    assert_eq!(told, None, "nothing has changed");
    let keyboard = Document::shipped("qwerty-flat").expect("a shipped layout");
    session.set_layout(&keyboard.text);
    assert_eq!(type_text(&mut session, "thw ")["mode"], "auto");
    assert_eq!(session.text(), "the ");
    let chords = Document::shipped("chords-bend").expect("a shipped layout");
    hear(&session.set_layout(&chords.text), &mut told);
    assert_eq!(
        told,
        Some(json!({"kind": "candidates", "mode": null, "words": []}))
    );
}

#[test]
fn a_pause_of_the_hand_drops_candidates() {
    let mut session = session("qwerty-flat", TextMode::Suggest);
    type_text(&mut session, "quicl");
    session.release();
    let mut told = None;
    pass(&mut session, 1, &mut told);
    assert_eq!(told.take().expect("news")["words"], json!([]));
    session.choose(1);
    pass(&mut session, 3, &mut told);
    assert_eq!(session.text(), "quicl");
}

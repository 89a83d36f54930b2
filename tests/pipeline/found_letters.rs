//! Multitap keys whose letters the text decoder finds from the words, one tap a letter.

use ademan::capture::Hc11Format;
use ademan::command::CommandOrigin;
use ademan::text::TextModeSchema;

use super::swipes::setup;
use super::text::{Typed, play, spanish};
use crate::support::press::glove_format_at;

fn types(mode: TextModeSchema, text: &str, format: &Hc11Format) -> String {
    let setup = setup("phone-pad", Some(mode));
    let typist = setup.typist(text, format, 0.0, 0).expect("a text");
    play(&setup, typist, |_, _, _| {}).text
}

/// Performs a script on a pad with keys for the modes and the candidates, at a rate at which taps in a row are in time.
fn performs(script: &str) -> String {
    let setup = setup("phone-words", None);
    let hand = setup.scripted(script, &glove_format_at(115_200), 0.0, 0);
    play(&setup, hand.expect("a script"), |_, _, _| {}).text
}

#[test]
fn one_tap_is_one_letter_however_fast_the_taps_follow() {
    let text = "the cab is at home ";
    for baud in [9_600, 115_200] {
        assert_eq!(
            types(TextModeSchema::Auto, text, &glove_format_at(baud)),
            text
        );
    }
    // Nothing is replaced before a candidate is taken.
    let first_letters = types(TextModeSchema::Suggest, text, &glove_format_at(115_200));
    assert_eq!(first_letters, "tgd aaa gp at gmmd ");
}

#[test]
fn a_word_with_an_accent_is_found_where_the_output_has_none() {
    // A keyboard of the kernel has no `ó`.
    let setup = spanish("phone-pad", "uinput");
    let typist = setup.typist("la cancion ", &glove_format_at(115_200), 0.0, 0);
    let typed = play(&setup, typist.expect("a text"), |_, _, _| {});
    assert_eq!(typed.text, "la cancion ");
}

#[test]
fn keys_with_signs_choose_by_taps_in_a_row() {
    let text = "hello, moon. ";
    assert_eq!(
        types(TextModeSchema::Auto, text, &glove_format_at(115_200)),
        text
    );
}

#[test]
fn the_keys_of_the_modes_switch_between_words_and_letters() {
    let found = performs("tap words; tap 2; tap 2; tap 2; tap Space");
    assert_eq!(found.chars().count(), 4, "{found}");
    assert_ne!(found, "c ");
    assert_eq!(
        performs("tap letters; tap 2; tap 2; tap 2; tap Space"),
        "c "
    );
    assert_eq!(performs("tap 2; tap 2; tap 2; tap Space"), "c ");
}

#[test]
fn a_candidate_takes_the_place_of_a_word() {
    let hello = "tap words; tap 4; tap 3; tap 5; tap 5; tap 6";
    assert_eq!(performs(&format!("{hello}; tap candidate-1")), "hello ");
    let second = performs(&format!("{hello}; tap candidate-2"));
    assert!(second.ends_with(' ') && second != "hello ", "{second}");
}

#[test]
fn each_sign_of_a_key_replaces_the_one_before_and_the_space_of_a_candidate() {
    let hello = "tap words; tap 4; tap 3; tap 5; tap 5; tap 6; tap candidate-1";
    let signs = |taps: usize| performs(&(hello.to_owned() + &"; tap 1".repeat(taps)));
    let expected = ["hello. ", "hello, ", "hello/", "hello'", "hello-", "hello1"];
    assert_eq!([1, 2, 3, 4, 5, 6].map(signs), expected);
}

#[test]
fn after_text_that_is_not_known_taps_in_a_row_choose() {
    let setup = setup("phone-words", Some(TextModeSchema::Auto));
    let script = "tap 4; tap 3; wait 3000; tap 2; tap 2; tap 2";
    let hand = setup.scripted(script, &glove_format_at(115_200), 0.0, 0);
    let mut is_paused = false;
    let Typed { text, .. } = play(
        &setup,
        hand.expect("a script"),
        |presses, pipeline, events| {
            // The first two letters, of which the second one changes the first.
            if presses >= 2 && !is_paused {
                is_paused = true;
                pipeline.pause(CommandOrigin::Client, events);
                pipeline.resume(CommandOrigin::Client);
            }
        },
    );
    assert!(text.ends_with('c'), "{text}");
}

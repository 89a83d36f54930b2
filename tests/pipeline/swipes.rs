//! Swiped words in the whole pipeline: a simulated hand moves over a shipped board, under the oracle.

use std::ops::Range;

use ademan::capture::{CaptureError, Channels, Hc11Format, Sample, Source, SourceEvent};
use ademan::hand::{Finger, Side};
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use ademan::text::{TextModeSchema, TextSetup};
use ademan::time::Timestamp;

use super::text::{Typed, play, spanish};
use crate::support::checked::CheckedPipeline;

/// Loads a shipped layout, with a text decoder in this mode.
pub fn setup(layout: &str, mode: Option<TextModeSchema>) -> LoadedSetup {
    let setup = Setup {
        layout: layout.into(),
        text: mode.map(|mode| TextSetup {
            mode: Some(mode),
            ..TextSetup::default()
        }),
        ..Setup::default()
    };
    setup.load_files().expect("the shipped layout")
}

fn performs(layout: &str, mode: Option<TextModeSchema>, script: &str) -> Typed {
    let setup = setup(layout, mode);
    let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
    play(&setup, hand.expect("a script"), |_, _, _| {})
}

fn types(layout: &str, mode: TextModeSchema, text: &str, noise: f64, seed: u64) -> Typed {
    let setup = setup(layout, Some(mode));
    let hand = setup.typist(text, &Hc11Format::default(), noise, seed);
    play(&setup, hand.expect("a text"), |_, _, _| {})
}

const QUICK: &str = "press Q; slide 114 0; slide 19 0; slide -80.75 -38; slide 85.5 19; lift";

#[test]
fn a_swiped_word_is_typed_when_the_finger_is_lifted() {
    for mode in [TextModeSchema::Suggest, TextModeSchema::Auto] {
        let typed = performs("qwerty-swipe", Some(mode), QUICK);
        assert_eq!(typed.text, "quick ");
    }
    let typed = performs(
        "qwerty-swipe",
        Some(TextModeSchema::Auto),
        &format!("{QUICK}; tap Backspace"),
    );
    assert_eq!(typed.text, "");
}

#[test]
fn a_space_after_a_swiped_word_is_not_doubled() {
    let script = format!("{QUICK}; tap Space; tap F; tap O; tap X; tap Space");
    let typed = performs("qwerty-swipe", Some(TextModeSchema::Auto), &script);
    assert_eq!(typed.text, "quick fox ");
}

#[test]
fn the_rest_of_a_word_after_a_swiped_word_that_cannot_be_typed_is_not_corrected() {
    // A keyboard of the kernel has no `á` for `más`.
    let setup = spanish("qwerty-swipe", "uinput");
    let script = "press M; slide -123.5 19; slide 19 0; lift; tap Q; tap E; tap U; tap Space";
    let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
    let typed = play(&setup, hand.expect("a script"), |_, _, _| {});
    assert_eq!(typed.text, "mqeu ");
}

#[test]
fn only_the_first_key_is_pressed_without_swipes() {
    for (layout, mode) in [
        ("qwerty-swipe", Some(TextModeSchema::Literal)),
        ("qwerty-words", Some(TextModeSchema::Auto)),
    ] {
        assert_eq!(performs(layout, mode, QUICK).text, "q", "{layout}");
    }
}

#[test]
fn taps_on_a_board_with_swipes_are_the_same_events() {
    let text = "teh quick brown fox jumps over the lazy dog and all is well too ";
    for mode in [TextModeSchema::Literal, TextModeSchema::Auto] {
        for (noise, seed) in [(0.0, 0), (2.0, 1), (2.0, 2)] {
            let with = types("qwerty-swipe", mode, text, noise, seed);
            let without = types("qwerty-words", mode, text, noise, seed);
            assert!(with.text.len() > 40, "{with:?}");
            assert_eq!(with, without, "{mode:?} {noise}");
        }
    }
}

/// A hand of which some channels are not known for some time.
pub struct Hiding<S> {
    pub hand: S,
    pub channels: Vec<usize>,
    pub hidden: Range<Timestamp>,
}

impl<S: Source> Source for Hiding<S> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let mut event = self.hand.next()?;
        if let SourceEvent::Reading(reading) = &mut event
            && self.hidden.contains(&reading.time)
            && let Sample::Channels(channels) = &mut reading.sample
        {
            for &channel in &self.channels {
                channels.counts[channel] = Channels::UNKNOWN;
            }
        }
        Ok(event)
    }

    fn name(&self) -> &str {
        self.hand.name()
    }
}

#[test]
fn a_finger_that_is_hidden_in_the_midst_of_a_swipe_ends_it() {
    let setup = setup("qwerty-swipe", Some(TextModeSchema::Auto));
    let rows = setup.glove.as_ref().expect("a glove").map.rows();
    let of_index = rows
        .iter()
        .filter(|row| row.dof.finger() == Some(Finger::Index));
    let channels: Vec<usize> = of_index.map(|row| row.channel).collect();
    for (hidden_ms, text) in [(0, "quick "), (50, "quick "), (150, "q")] {
        let hand = setup.scripted(QUICK, &Hc11Format::default(), 0.0, 0);
        let from = Timestamp(1_600_000);
        let hand = Hiding {
            hand: hand.expect("a script"),
            channels: channels.clone(),
            hidden: from..Timestamp(from.0 + hidden_ms * 1000),
        };
        let typed = play(&setup, hand, |_, _, _| {});
        assert_eq!(typed.text, text, "hidden for {hidden_ms} ms");
    }
}

fn has_candidates(pipeline: &CheckedPipeline) -> bool {
    let state = pipeline.text_state().expect("a decoder");
    !state.candidates.is_empty()
}

#[test]
fn a_hand_that_is_lost_does_not_end_the_swipe_of_the_other_one() {
    let one_hand = setup("qwerty-swipe", Some(TextModeSchema::Auto));
    let two_hands = Setup {
        other_hand: Some(OtherHand::default()),
        ..one_hand.setup.clone()
    };
    let two_hands = two_hands.load_files().expect("the shipped layout");
    // The press of the first letter, and the midst of the swipe.
    for readings in [1, 30] {
        for (side, text) in [(Side::Left, "quick "), (Side::Right, "q")] {
            let hand = one_hand.scripted(QUICK, &Hc11Format::default(), 0.0, 0);
            let mut readings_since_press = 0;
            let mut is_lost = false;
            let typed = play(
                &two_hands,
                hand.expect("a script"),
                |presses, pipeline, events| {
                    readings_since_press += usize::from(presses > 0);
                    if readings_since_press == readings {
                        assert!(has_candidates(pipeline), "{side} {readings}");
                        pipeline.lose(Some(side), None, events);
                        is_lost = true;
                    }
                    let is_shown = is_lost && has_candidates(pipeline);
                    assert!(!is_shown, "{side} {readings}: of forgotten text");
                },
            );
            assert_eq!(typed.text, text, "{side} after {readings} readings");
        }
    }
}

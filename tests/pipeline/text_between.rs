//! The text decoder where words meet something else: the space that a candidate has brought, another mode, profile or layout, and
//! keys for another keymap.

use std::time::Duration;

use ademan::capture::Hc11Format;
use ademan::command::{Command, CommandOrigin, TextMode};
use ademan::device::Events;
use ademan::document::Document;
use ademan::setup::{LoadedSetup, ProfileSetup, Setup};
use ademan::text::{TextModeSchema, TextSetup};
use ademan::time::Timestamp;

use super::swipes::Hiding;
use super::text::play;
use crate::support::checked::CheckedPipeline;
use crate::support::wearer::load_layout;

fn load(mode: TextModeSchema) -> LoadedSetup {
    let setup = Setup {
        layout: "qwerty-words".into(),
        profiles: vec![ProfileSetup {
            name: "other".into(),
            text: None,
            layout: "qwerty-flat".into(),
        }],
        text: Some(TextSetup {
            mode: Some(mode),
            ..TextSetup::default()
        }),
        ..Setup::default()
    };
    setup.load_files().expect("the shipped layouts")
}

/// Performs a script, and calls `change` once after a number of presses.
fn performs(
    setup: &LoadedSetup,
    script: &str,
    after: usize,
    mut change: impl FnMut(&mut CheckedPipeline, &mut Events),
) -> String {
    let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
    let mut is_changed = false;
    let typed = play(
        setup,
        hand.expect("a script"),
        |presses, pipeline, events| {
            if presses == after && !is_changed {
                is_changed = true;
                change(pipeline, events);
            }
        },
    );
    assert!(is_changed || after == usize::MAX, "{typed:?}");
    typed.text
}

fn suggests(script: &str) -> String {
    let setup = load(TextModeSchema::Suggest);
    performs(&setup, script, usize::MAX, |_, _| {})
}

#[test]
fn a_mark_takes_the_space_that_a_candidate_has_brought() {
    let take = "tap H; tap E; tap candidate-3";
    let taken = suggests(take);
    let word = taken.strip_suffix(' ').expect("a space");
    let then = |keys: &str| suggests(&format!("{take}; {keys}"));
    assert_eq!(then("tap Period; tap A"), format!("{word}. a"));
    // The person may type the space, too.
    assert_eq!(then("tap Comma; tap Space; tap A"), format!("{word}, a"));
    assert_eq!(
        then("tap Period; tap Backspace; tap A"),
        format!("{word}.a")
    );
    let question = "tap ShiftLeft; tap Slash; tap A";
    assert_eq!(then(question), format!("{word}? a"));
}

#[test]
fn a_space_after_a_candidate_that_ends_with_a_mark_is_typed() {
    let sentence =
        "tap T; tap E; tap H; tap Space; tap C; tap A; tap T; tap Period; tap candidate-1";
    let taken = suggests(sentence);
    assert!(taken.ends_with("cat."), "{taken}");
    let more = suggests(&format!("{sentence}; tap Space; tap T"));
    assert_eq!(more, format!("{taken} t"));
}

#[test]
fn a_candidate_is_not_typed_while_backspace_repeats() {
    let setup = load(TextModeSchema::Suggest);
    let script = "tap W; tap H; tap A; press Backspace; wait 800; lift";
    let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
    let mut deleted_at = None;
    let mut is_taken = false;
    let typed = play(
        &setup,
        hand.expect("a script"),
        |presses, pipeline, events| {
            let time = pipeline.time();
            if presses == 4 {
                deleted_at.get_or_insert(time);
            }
            let held = deleted_at.map_or(Duration::ZERO, |start| time.since(start));
            if held > Duration::from_millis(400) && !is_taken {
                is_taken = true;
                let first = Command::Candidate { number: 1 };
                let origin = CommandOrigin::Client;
                pipeline.execute(&first, origin, events).expect("it is one");
            }
        },
    );
    assert!(is_taken);
    // A desktop has deleted more letters by then.
    assert_eq!(typed.text, "wh");
}

const HALF: &str = "tap C; tap O; tap N; wait 1500; tap T; tap E; tap H; tap Space";
const WORD: &str = "wait 300; tap T; tap E; tap H; tap Space";

#[test]
fn the_rest_of_a_word_is_not_corrected_after_a_change_of_the_mode() {
    let to_auto = |pipeline: &mut CheckedPipeline, events: &mut Events| {
        let command = Command::Text {
            mode: TextMode::Auto,
        };
        let origin = CommandOrigin::Client;
        pipeline.execute(&command, origin, events).expect("a mode");
    };
    let setup = load(TextModeSchema::Literal);
    let half = format!("{HALF}; {WORD}");
    assert_eq!(performs(&setup, &half, 3, to_auto), "conteh the ");
    let whole = format!("tap A; tap Space; wait 1500; {WORD}");
    assert_eq!(performs(&setup, &whole, 2, to_auto), "a the ");
}

#[test]
fn the_rest_of_a_word_is_not_corrected_after_a_change_of_the_profile() {
    let setup = load(TextModeSchema::Auto);
    let script = format!("{HALF}; {WORD}");
    let text = performs(&setup, &script, 3, |pipeline, events| {
        pipeline.switch_profile(1, events);
    });
    assert_eq!(text, "conteh the ");
}

#[test]
fn the_rest_of_a_word_is_not_corrected_after_a_profile_without_a_decoder() {
    // With a Shift that is down while it is touched, at the place that the script taps.
    let board = include_str!("../../layouts/keyboards/spanish-flat.ron");
    let board = board.replace("ShiftLeft", "ShiftRight");
    let board = board.replace("IntlBackslash", "ShiftLeft");
    let folder = tempfile::tempdir().expect("a folder");
    let other_layout = folder.path().join("other.ron");
    std::fs::write(&other_layout, board).expect("a file");
    let setup = Setup {
        profiles: vec![ProfileSetup {
            name: "other".into(),
            text: None,
            layout: other_layout.to_string_lossy().into_owned(),
        }],
        ..load(TextModeSchema::Auto).setup
    };
    let setup = setup.load_files().expect("the shipped layouts");
    let typed = |between: &str| {
        let last = "wait 1500; tap T; tap E; tap H; tap Space";
        let script = format!("tap A; tap Space; wait 1500; {between}; {last}; {WORD}");
        let other = 2..2 + between.matches("tap").count();
        let hand = setup.scripted(&script, &Hc11Format::default(), 0.0, 0);
        let mut profile = 0;
        let played = play(
            &setup,
            hand.expect("a script"),
            |presses, pipeline, events| {
                let wanted = usize::from(other.contains(&presses));
                if std::mem::replace(&mut profile, wanted) != wanted {
                    pipeline.switch_profile(wanted, events);
                }
            },
        );
        played.text
    };
    assert_eq!(typed("tap C; tap O; tap N"), "a conteh the ");
    assert_eq!(typed("tap C; tap Space"), "a c the the ");
    // A modifier alone types nothing.
    assert_eq!(typed("tap C; tap Space; tap ShiftLeft"), "a c the the ");
}

#[test]
fn a_hand_that_leaves_the_view_in_a_word_drops_it() {
    let setup = load(TextModeSchema::Auto);
    let rows = setup.glove.as_ref().expect("a glove").map.rows();
    let of_fingers = rows.iter().filter(|row| row.dof.finger().is_some());
    let channels: Vec<usize> = of_fingers.map(|row| row.channel).collect();
    let script = format!("tap T; tap E; wait 1500; tap H; tap Space; {WORD}");
    let scripted = || {
        let hand = setup.scripted(&script, &Hc11Format::default(), 0.0, 0);
        hand.expect("a script")
    };
    let mut second_press = None;
    let seen = play(&setup, scripted(), |presses, pipeline, _| {
        if presses == 2 {
            second_press.get_or_insert(pipeline.time());
        }
    });
    assert_eq!(seen.text, "the the ");
    // In the wait after the second letter.
    let from = second_press.expect("two letters").0 + 700_000;
    let hiding = Hiding {
        hand: scripted(),
        channels,
        hidden: Timestamp(from)..Timestamp(from + 300_000),
    };
    let hidden = play(&setup, hiding, |_, _, _| {});
    assert_eq!(hidden.text, "teh the ");
}

#[test]
fn a_layout_that_is_replaced_hands_over_half_a_word_and_what_was_learned() {
    let setup = load(TextModeSchema::Auto);
    let replace = |pipeline: &mut CheckedPipeline, events: &mut Events| {
        let mut instance = setup.layout_instance(&setup.layout).expect("a layout");
        pipeline.replace_profile(0, &mut instance, &setup.layout, events);
    };
    let half = format!("{HALF}; {WORD}");
    assert_eq!(performs(&setup, &half, 3, replace), "conteh the ");
    // One Backspace restores a word, which is not changed again.
    let restored = "tap T; tap E; tap H; tap Space; tap Backspace; wait 1500; tap A; tap Space";
    let hand = setup.scripted(restored, &Hc11Format::default(), 0.0, 0);
    let alone = play(&setup, hand.expect("a script"), |_, _, _| {});
    assert_eq!(alone.text, "teh a ");
    let presses = alone.events.matches("KeyDown").count();
    let again = format!("{restored}; wait 1500; {WORD}");
    assert_eq!(performs(&setup, &again, presses, replace), "teh a teh ");
}

#[test]
fn a_layout_file_that_states_another_mode_sets_it_and_a_mode_that_was_chosen_is_kept_otherwise() {
    let shipped = Document::shipped("qwerty-flat").expect("a shipped layout");
    let with_mode = |mode: &str| {
        let first = format!("Layout(text: {mode}, ");
        shipped.text.replacen("Layout(", &first, 1)
    };
    let setup = Setup {
        text: Some(TextSetup::default()),
        ..Setup::default()
    };
    let loaded = load_layout(&with_mode("Literal"), setup);
    let reload = |pipeline: &mut CheckedPipeline, mode: &str| {
        let layout = loaded.layout.with_text(&with_mode(mode));
        let layout = layout.expect("a valid layout");
        let mut instance = loaded.layout_instance(&layout).expect("a layout");
        pipeline.replace_profile(0, &mut instance, &layout, &mut Events::new());
        pipeline.text_state().expect("a decoder").mode
    };
    let mut pipeline = CheckedPipeline::new(&loaded);
    let chosen = Command::Text {
        mode: TextMode::Suggest,
    };
    let outcome = pipeline.execute(&chosen, CommandOrigin::Client, &mut Events::new());
    assert_eq!(outcome, Ok(()));
    assert_eq!(reload(&mut pipeline, "Literal"), TextMode::Suggest);
    assert_eq!(reload(&mut pipeline, "Auto"), TextMode::Auto);
}

#[test]
fn words_are_not_corrected_on_a_board_for_another_keymap() {
    for layout in ["spanish-flat", "azerty-flat", "qwertz-flat"] {
        let setup = Setup {
            layout: layout.into(),
            ..load(TextModeSchema::Auto).setup
        };
        let setup = Setup {
            profiles: Vec::new(),
            ..setup
        };
        let loaded = setup.load_files().expect("a shipped layout");
        let instance = loaded.layout_instance(&loaded.layout).expect("a layout");
        assert!(instance.filter().is_none(), "{layout}");
        let note = loaded.text_note().expect("a message");
        assert!(note.contains("another keymap"), "{note}");
    }
    for layout in [
        "qwerty-flat",
        "qwerty-words",
        "dvorak-flat",
        "qwerty-two-flat",
        "qwerty-swipe",
    ] {
        let setup = Setup {
            layout: layout.into(),
            profiles: Vec::new(),
            ..load(TextModeSchema::Auto).setup
        };
        assert_eq!(setup.load_files().expect("a layout").text_note(), None);
    }
}

//! The text decoder in the whole pipeline: a simulated hand types with it, under the oracle.

use std::path::Path;

use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::command::{Command, CommandOrigin, TextMode};
use ademan::device::Events;
use ademan::document::Document;
use ademan::layout::Layout;
use ademan::pipeline::{CommandError, SourceRole};
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use ademan::sim::UsTextField;
use ademan::text::{TextModeSchema, TextSetup};

use crate::support::checked::CheckedPipeline;
use crate::support::wearer::load_layout;

fn setup(text: Option<TextModeSchema>) -> LoadedSetup {
    let setup = Setup {
        text: text.map(|mode| TextSetup {
            mode: Some(mode),
            ..TextSetup::default()
        }),
        ..Setup::default()
    };
    setup.load_files().expect("the shipped layout")
}

/// Loads a shipped layout with Spanish words that are corrected, for an output.
pub fn spanish(layout: &str, output: &str) -> LoadedSetup {
    let setup = Setup {
        layout: layout.into(),
        text: Some(TextSetup {
            mode: Some(TextModeSchema::Auto),
            language: "es".into(),
            ..TextSetup::default()
        }),
        output: output.into(),
        ..Setup::default()
    };
    setup.load_files().expect("the shipped layout")
}

/// The text and the events of a hand.
#[derive(Debug, Default, PartialEq)]
pub struct Typed {
    pub text: String,
    /// All events, as words.
    pub events: String,
}

/// Plays a hand, and calls `each` after each reading with the number of presses and characters so far.
pub fn play(
    setup: &LoadedSetup,
    mut hand: impl Source,
    mut each: impl FnMut(usize, &mut CheckedPipeline, &mut Events),
) -> Typed {
    let mut pipeline = CheckedPipeline::new(setup);
    let mut field = UsTextField::new();
    let mut typed = Typed::default();
    let mut presses = 0;
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        let mut events = Events::new();
        let _ = pipeline.step(&reading, &mut events);
        presses += events.iter().filter(|event| event.kind.is_press()).count();
        each(presses, &mut pipeline, &mut events);
        for event in &events {
            field.handle(event);
            typed.events += &format!("{event:?}\n");
        }
    }
    assert!(!pipeline.has_pressed(), "a key stays down");
    typed.text = field.text().to_owned();
    typed
}

fn typist(setup: &LoadedSetup, text: &str, noise: f64, seed: u64) -> impl Source + use<> {
    let format = Hc11Format::default();
    setup.typist(text, &format, noise, seed).expect("a text")
}

fn types(text: Option<TextModeSchema>, line: &str) -> Typed {
    let setup = setup(text);
    play(&setup, typist(&setup, line, 0.0, 0), |_, _, _| {})
}

#[test]
fn words_are_corrected_at_their_end() {
    let typed = types(Some(TextModeSchema::Auto), "teh quikc brown fox ");
    assert_eq!(typed.text, "the quick brown fox ");
}

#[test]
fn literal_and_no_decoder_are_the_same_events_and_suggest_the_same_text() {
    let line = "teh quikc brown fox ";
    let without = types(None, line);
    assert_eq!(without.text, line);
    assert_eq!(types(Some(TextModeSchema::Literal), line), without);
    assert_eq!(types(Some(TextModeSchema::Suggest), line).text, line);
}

#[test]
fn passwords_and_numbers_are_left_alone() {
    for line in ["xk47vq9zt ", "1984 3.14 zyzzogeton kubectl ", "qz7, b2c; "] {
        assert_eq!(types(Some(TextModeSchema::Auto), line).text, line);
    }
}

#[test]
fn a_pause_in_a_word_drops_it() {
    let setup = setup(Some(TextModeSchema::Auto));
    let mut is_paused = false;
    let typed = play(
        &setup,
        typist(&setup, "teh teh teh teh teh ", 0.0, 0),
        |presses, pipeline, events| {
            if presses == 2 && !is_paused {
                is_paused = true;
                pipeline.pause(CommandOrigin::Client, events);
                pipeline.resume(CommandOrigin::Client);
            }
        },
    );
    // Text typed before the pause stays, and text after it is lost until the hand was clear.
    assert!(typed.text.starts_with("te"), "{typed:?}");
    assert!(!typed.text.starts_with("the"), "{typed:?}");
}

#[test]
fn a_candidate_replaces_the_typed_word_and_adds_a_space() {
    let setup = setup(Some(TextModeSchema::Suggest));
    let mut seen = Vec::new();
    let typed = play(
        &setup,
        typist(&setup, "wrold of", 0.0, 0),
        |presses, pipeline, events| {
            if presses == 5 && seen.is_empty() {
                let state = pipeline.text_state().expect("a decoder");
                seen = state.candidates.iter().map(|it| it.to_string()).collect();
                let number = seen.iter().position(|it| it == "world").expect("it is one");
                let number = number as u8 + 1;
                let command = Command::Candidate { number };
                pipeline
                    .execute(&command, CommandOrigin::Client, events)
                    .unwrap();
            }
        },
    );
    assert!(seen.contains(&"wrold".to_owned()), "{seen:?}");
    assert_eq!(typed.text, "world of");
}

#[test]
fn a_candidate_that_no_word_has_is_refused() {
    let mut pipeline = CheckedPipeline::new(&setup(Some(TextModeSchema::Suggest)));
    let candidate = Command::Candidate { number: 1 };
    assert_eq!(
        pipeline.execute(&candidate, CommandOrigin::Client, &mut Events::new()),
        Err(CommandError::NoCandidate(1))
    );
}

/// Performs a script on a board with keys for candidates, in the mode `suggest`.
fn performs(script: &str) -> String {
    let setup = Setup {
        layout: "qwerty-words".into(),
        ..setup(Some(TextModeSchema::Suggest)).setup
    };
    let setup = setup.load_files().expect("the shipped layout");
    let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
    play(&setup, hand.expect("a script"), |_, _, _| {}).text
}

const TAKE: &str = "tap H; tap E; tap candidate-3";

#[test]
fn after_ten_seconds_a_candidate_is_not_taken_back_and_a_space_is_typed() {
    let taken = performs(TAKE);
    assert!(taken.len() > 3 && taken.ends_with(' '), "{taken}");
    let soon = |keys: &str| performs(&format!("{TAKE}; wait 400; {keys}"));
    assert_eq!(soon("tap Backspace"), "he");
    assert_eq!(soon("tap Space; tap A"), format!("{taken}a"));
    let late = |keys: &str| performs(&format!("{TAKE}; wait 11000; {keys}"));
    assert_eq!(late("tap Backspace"), taken.trim_end());
    assert_eq!(late("tap Space; tap A"), format!("{taken} a"));
}

#[test]
fn a_key_without_a_candidate_brings_no_space() {
    assert_eq!(performs("tap candidate-1; tap Space; tap A"), " a");
    let twice = performs(&format!("{TAKE}; tap candidate-3; tap Space; tap A"));
    assert_eq!(twice, performs(TAKE) + "a");
}

/// Performs a script with a left hand that types and a right hand that only points. Returns the text, the keys that were suppressed,
/// and the mode at the end.
fn performs_beside_a_pointer(script: &str) -> (String, u64, TextMode) {
    let mut layout = Document::shipped("qwerty-two-flat").unwrap().text;
    for (side, first) in [("left", "Escape"), ("right", "ShiftRight")] {
        let first = format!("(code: \"{first}\"");
        let keys = format!(
            r#"(action: Command("candidate 1"), name: "{side}-candidate", at_mm: (-30, -57), size_mm: Box(26, 17)),
               (action: Command("text auto"), name: "{side}-auto", at_mm: (30, -57), size_mm: Box(26, 17)),"#
        );
        layout = layout.replacen(&first, &(keys + &first), 1);
    }
    let source = |text: &str| Some(text.parse().expect("a source"));
    let setup = Setup {
        source: source("serial:/dev/right"),
        role: Some(SourceRole::Pointer),
        other_hand: Some(OtherHand {
            source: source("serial:/dev/left"),
            ..OtherHand::default()
        }),
        ..setup(Some(TextModeSchema::Suggest)).setup
    };
    let setup = load_layout(&layout, setup);
    let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
    let mut end = (0, TextMode::Literal);
    let typed = play(&setup, hand.expect("a script"), |_, pipeline, _| {
        let mode = pipeline.text_state().expect("a decoder").mode;
        end = (pipeline.suppressed().keys_by_role, mode);
    });
    (typed.text, end.0, end.1)
}

#[test]
fn a_candidate_is_typed_by_a_hand_that_may_type() {
    let script = "tap J; tap W; tap E; tap left-candidate; wait 400; tap \"Space left\"; tap A";
    let end = performs_beside_a_pointer(script);
    // Only the letter of the other hand is suppressed.
    assert_eq!(end, ("we a".to_owned(), 1, TextMode::Suggest));
}

#[test]
fn a_hand_that_only_points_takes_no_candidate_and_changes_no_mode() {
    let script = "tap W; tap E; tap right-candidate; wait 400; tap right-auto; wait 400; tap A";
    let end = performs_beside_a_pointer(script);
    assert_eq!(end, ("wea".to_owned(), 2, TextMode::Suggest));
}

#[test]
fn the_mode_changes_while_the_hand_types_and_needs_a_decoder() {
    let auto = Command::Text {
        mode: TextMode::Auto,
    };
    let literal = setup(Some(TextModeSchema::Literal));
    let typed = play(
        &literal,
        typist(&literal, "teh teh ", 0.0, 0),
        |presses, pipeline, events| {
            if presses == 4 && pipeline.text_state().unwrap().mode == TextMode::Literal {
                pipeline
                    .execute(&auto, CommandOrigin::Client, events)
                    .unwrap();
            }
        },
    );
    assert_eq!(typed.text, "teh the ");
    let mut without = CheckedPipeline::new(&setup(None));
    assert_eq!(
        without.execute(&auto, CommandOrigin::Client, &mut Events::new()),
        Err(CommandError::NoTextDecoder)
    );
}

#[test]
fn accents_that_no_key_types_are_written_where_the_output_takes_text() {
    let typed = |output: &str| {
        let setup = spanish("qwerty-flat", output);
        let hand = typist(&setup, "la cancion de mi corazon ", 0.0, 1);
        play(&setup, hand, |_, _, _| {}).text
    };
    for output in ["transcript", "transcript,desktop,uinput", "ime:uinput"] {
        assert_eq!(typed(output), "la canción de mi corazón ", "{output}");
    }
    // A keyboard of the kernel has no characters, and two outputs have no common order.
    for output in ["uinput", "uinput,desktop", "transcript,uinput,ime"] {
        assert_eq!(typed(output), "la cancion de mi corazon ", "{output}");
    }
}

#[test]
fn the_rest_of_a_word_after_a_candidate_that_cannot_be_typed_is_not_corrected() {
    // A keyboard of the kernel has no `ó`.
    let setup = spanish("qwerty-flat", "uinput");
    let mut is_taken = false;
    let hand = typist(&setup, "cancionqeu qeu ", 0.0, 0);
    let typed = play(&setup, hand, |presses, pipeline, events| {
        if presses == 7 && !is_taken {
            is_taken = true;
            let state = pipeline.text_state().expect("a decoder");
            let index = state.candidates.iter().position(|it| it == "canción");
            let number = index.expect("it is one") as u8 + 1;
            let command = Command::Candidate { number };
            pipeline
                .execute(&command, CommandOrigin::Client, events)
                .unwrap();
        }
    });
    assert_eq!(typed.text, "cancionqeu que ");
}

#[test]
fn a_language_or_letters_that_are_missing_leave_keys_as_they_are() {
    let load = |language: &str, layout: &str| {
        let text = TextSetup {
            mode: Some(TextModeSchema::Auto),
            language: language.into(),
            ..TextSetup::default()
        };
        let setup = Setup {
            text: Some(text),
            layout: layout.into(),
            ..Setup::default()
        };
        let setup = setup.load_files().expect("it runs all the same");
        let has_decoder = setup.pipeline().text_state().is_some();
        (has_decoder, setup.text_note())
    };
    let folder = tempfile::tempdir().unwrap();
    let damaged = folder.path().join("damaged.adm");
    std::fs::write(&damaged, "ADEMTEXT and more").unwrap();
    for (language, layout, message) in [
        (
            "em",
            "qwerty-flat",
            "unknown language `em`, did you mean `en`?",
        ),
        (
            "missing.adm",
            "qwerty-flat",
            "cannot read the language model missing.adm",
        ),
        (
            damaged.to_str().unwrap(),
            "qwerty-flat",
            "cannot use the language model",
        ),
        ("en", "numpad", "no layout has letters"),
        ("en", "chords-bend", "letters of chords are not corrected"),
    ] {
        let (has_decoder, note) = load(language, layout);
        assert!(!has_decoder, "{language} {layout}");
        let note = note.expect("a message");
        assert!(note.contains(message), "{note}");
    }
    assert_eq!(load("es", "qwerty-flat"), (true, None));
}

/// Writes a layout that comes with the program with a further field, and returns the path.
fn write_layout(folder: &Path, name: &str, field: &str) -> String {
    let path = folder.join(format!("{name}.ron"));
    let layout = Document::shipped(name).unwrap().text;
    let boards = format!("{field}, boards:");
    std::fs::write(&path, layout.replacen("boards:", &boards, 1)).unwrap();
    path.display().to_string()
}

#[test]
fn the_mode_of_a_layout_counts_where_the_person_states_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_layout(folder.path(), "qwerty-flat", "text: Auto");
    let line = "teh quikc brown fox ";
    let typed = |text: Option<TextSetup>| {
        let setup = Setup {
            layout: path.clone(),
            text,
            ..Setup::default()
        };
        let loaded = setup.load_files().expect("a layout");
        play(&loaded, typist(&loaded, line, 0.0, 0), |_, _, _| {}).text
    };
    let corrected = "the quick brown fox ";
    assert_eq!(typed(None), corrected);
    assert_eq!(typed(Some(TextSetup::default())), corrected);
    let literal = TextSetup {
        mode: Some(TextModeSchema::Literal),
        ..TextSetup::default()
    };
    assert_eq!(typed(Some(literal)), line);
}

#[test]
fn the_mode_of_a_layout_without_letters_changes_nothing_and_a_message_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let load = |field: &str| {
        let setup = Setup {
            layout: write_layout(folder.path(), "numpad", field),
            ..Setup::default()
        };
        setup.load_files().expect("it runs all the same")
    };
    let auto = load("text: Auto");
    assert!(auto.pipeline().text_state().is_none());
    let note = auto.text_note().expect("a message");
    assert!(note.contains("no layout has letters"), "{note}");
    let literal = load("text: Literal");
    assert_eq!(literal.setup.text, None);
    assert_eq!(literal.text_note(), None);
}

#[test]
fn a_layout_states_its_mode_in_words() {
    let layout = |field: &str| {
        let text = format!(
            "Layout(name: \"a\", {field}boards: [(pose: (anchor: elbow), keys: [(code: \"A\", at_mm: (0, 0))])])"
        );
        Layout::parse(&text, "a.ron")
    };
    let modes = ["", "text: Literal, ", "text: Suggest, ", "text: Auto, "];
    assert_eq!(
        modes.map(|field| layout(field).expect("a layout").text_mode),
        [
            None,
            Some(TextMode::Literal),
            Some(TextMode::Suggest),
            Some(TextMode::Auto)
        ]
    );
    let error = layout("text: Automatic, ")
        .expect_err("no mode")
        .to_string();
    assert!(error.contains("unknown value `Automatic`"), "{error}");
}

#[test]
fn a_multitap_key_replaces_its_letter_and_takes_no_correction_back() {
    let layout = Document::shipped("qwerty-flat").unwrap().text;
    let key = "keys: [(action: Multitap(\"Period Comma\"), name: \"signs\", at_mm: (0, 60)),";
    let setup = Setup {
        text: Some(TextSetup {
            mode: Some(TextModeSchema::Auto),
            ..TextSetup::default()
        }),
        ..Setup::default()
    };
    let setup = load_layout(&layout.replacen("keys: [", key, 1), setup);
    let script = "tap T; tap E; tap H; tap signs; tap signs; tap Space";
    let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
    let typed = play(&setup, hand.expect("a script"), |_, _, _| {});
    assert_eq!(typed.text, "the, ");
}

/// Wrong characters of a text, as the edit distance to what was meant.
pub fn distance(typed: &str, meant: &str) -> usize {
    let meant: Vec<char> = meant.chars().collect();
    let mut row: Vec<usize> = (0..=meant.len()).collect();
    for (line, left) in typed.chars().enumerate() {
        let mut corner = std::mem::replace(&mut row[0], line + 1);
        for (column, right) in meant.iter().enumerate() {
            let changed = corner + usize::from(left != *right);
            corner = row[column + 1];
            row[column + 1] = changed.min(row[column] + 1).min(corner + 1);
        }
    }
    row[meant.len()]
}

#[test]
fn a_noisy_glove_types_fewer_wrong_characters() {
    let line = "the weather was very nice so we went for a long walk in the park and then had some coffee with our friends ";
    let mut wrong = [0; 2];
    for (index, text) in [None, Some(TextModeSchema::Auto)].into_iter().enumerate() {
        let setup = setup(text);
        for seed in 0..8 {
            let typed = play(&setup, typist(&setup, line, 2.0, seed), |_, _, _| {});
            wrong[index] += distance(&typed.text.to_lowercase(), line);
        }
    }
    let characters = 8 * line.len();
    println!(
        "wrong of {characters} at 2 counts: literal {}, auto {}",
        wrong[0], wrong[1]
    );
    assert!(wrong[1] <= wrong[0], "{wrong:?}");
}

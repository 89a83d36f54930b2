//! What does not go out, however it is asked for: more presses than a person makes, keys that act on the system,
//! and what the role of its source does not allow.

use std::fs;

use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::device::{EventKind, Events};
use ademan::document::Document;
use ademan::layout::Layout;
use ademan::pipeline::{Pipeline, SourceRole};
use ademan::pipeline::{PipelineState, Suppressed};
use ademan::setup::{LoadedSetup, OtherHand, Setup};

fn assemble(setup: Setup) -> LoadedSetup {
    setup.load_files().expect("a setup")
}

/// Lets a hand type a text; what goes out, a word an event.
fn type_with(assembly: &LoadedSetup, pipeline: &mut Pipeline, text: &str) -> Vec<String> {
    let hand = assembly.typist(text, &Hc11Format::default(), 0.0, 0);
    let mut hand = hand.expect("it can be typed");
    let mut written = Vec::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        let mut events = Events::new();
        pipeline.step(&reading, &mut events).expect("an able hand");
        written.extend(events.iter().filter_map(|event| match event.kind {
            EventKind::KeyDown(key) => Some(format!("{key}")),
            EventKind::KeyUp(key) => Some(format!("/{key}")),
            _ => None,
        }));
    }
    written
}

#[test]
fn after_more_presses_than_may_be_everything_is_let_go_of_and_the_run_pauses() {
    let assembly = assemble(Setup {
        max_presses_per_second: Some(1),
        ..Setup::default()
    });
    let mut pipeline = assembly.pipeline();
    assert_eq!(type_with(&assembly, &mut pipeline, "hot"), ["H", "/H"]);
    assert_eq!(pipeline.state(), PipelineState::Paused);
    assert!(pipeline.is_paused());
    assert_eq!(pipeline.suppressed().rate_limited, 1);
}

#[test]
fn a_press_that_is_withheld_takes_the_modifier_with_it() {
    let assembly = assemble(Setup {
        max_presses_per_second: Some(1),
        ..Setup::default()
    });
    let mut pipeline = assembly.pipeline();
    let written = type_with(&assembly, &mut pipeline, "H");
    assert_eq!(written, ["ShiftLeft", "/ShiftLeft"]);
    assert_eq!(pipeline.suppressed().rate_limited, 1);
}

#[test]
fn a_source_at_this_machine_may_press_as_fast_as_anybody_types_and_one_on_the_network_may_not() {
    let limit = |source: &str| {
        let assembly = assemble(Setup {
            source: Some(source.parse().expect("a source")),
            ..Setup::default()
        });
        let mut pipeline = assembly.pipeline();
        let text = "the quick brown fox jumps over the lazy dog";
        type_with(&assembly, &mut pipeline, text);
        assert_eq!(
            pipeline.suppressed().rate_limited,
            0,
            "{source}: at the pace of a person"
        );
        let (_, rights) = assembly.sources().next().expect("there is one");
        rights.rate_limit.per_second
    };
    assert_eq!(limit("serial:/dev/ttyUSB0"), 60);
    assert_eq!(limit("tcp:10.0.0.7:4001"), 20);
}

/// The roles of the sources of a setup.
fn roles(setup: &str) -> Vec<SourceRole> {
    let setup: Setup = Document::new("setup.ron", setup).parse().expect("a setup");
    let assembly = assemble(setup);
    assembly.sources().map(|(_, rights)| rights.role).collect()
}

#[test]
fn a_source_on_the_network_is_a_pointer_unless_the_setup_says_more_and_any_other_is_both() {
    for source in [
        "serial:/dev/x",
        "file:x",
        "recording:x",
        "typist:x",
        "script:x",
    ] {
        let setup = format!("Setup(source: \"{source}\")");
        assert_eq!(roles(&setup), [SourceRole::Both], "{source}");
    }
    assert_eq!(roles("Setup()"), [SourceRole::Both], "not named yet");
    let tcp = r#"source: "tcp:box:4001""#;
    assert_eq!(roles(&format!("Setup({tcp})")), [SourceRole::Pointer]);
    for role in SourceRole::ALL {
        let setup = format!("Setup({tcp}, role: {role:?})");
        assert_eq!(roles(&setup), [role]);
    }
    assert_eq!(
        roles(&format!(
            "Setup({tcp}, role: Keys, other_hand: ({tcp}, role: Both))"
        )),
        [SourceRole::Keys, SourceRole::Both]
    );
    assert_eq!(
        roles(&format!("Setup({tcp}, role: Keys, other_hand: ({tcp}))")),
        [SourceRole::Keys, SourceRole::Pointer],
        "the role of one source is not that of the other"
    );
}

#[test]
fn a_role_that_is_none_and_one_of_no_source_are_refused() {
    let document = Document::new("setup.ron", "Setup(role: Boht)");
    let error = document.parse::<Setup>().expect_err("no role").to_string();
    assert!(error.contains("did you mean `Both`?"), "{error}");
    let setup = Setup {
        other_hand: Some(OtherHand {
            role: Some(SourceRole::Pointer),
            ..OtherHand::default()
        }),
        ..Setup::default()
    };
    let error = setup.load_files().expect_err("whose role?").to_string();
    assert_eq!(
        error,
        "`role` of `other_hand` is that of its own `source`, and it names none: both hands have the role of the \
         first source"
    );
}

#[test]
fn a_hand_on_the_network_that_types_types_nothing_unless_it_may() {
    let type_as = |role| {
        let assembly = assemble(Setup {
            source: Some("tcp:10.0.0.7:4001".parse().expect("a source")),
            role,
            ..Setup::default()
        });
        let mut pipeline = assembly.pipeline();
        let typed = type_with(&assembly, &mut pipeline, "Hi");
        assert_eq!(pipeline.state(), PipelineState::Running);
        (typed.len(), pipeline.suppressed())
    };
    let (typed, withheld) = type_as(None);
    assert_eq!((typed, withheld.keys_by_role), (0, 3));
    assert_eq!(withheld.total(), 3);
    for role in [SourceRole::Keys, SourceRole::Both] {
        assert_eq!(type_as(Some(role)), (6, Suppressed::default()));
    }
}

#[test]
fn a_limit_that_makes_no_sense_is_refused() {
    for wrong in [0, 1001] {
        let setup = Setup {
            max_presses_per_second: Some(wrong),
            ..Setup::default()
        };
        let error = setup
            .load_files()
            .expect_err("it makes no sense")
            .to_string();
        assert_eq!(
            error,
            format!("`max_presses_per_second` is 1 to 1000, not {wrong}")
        );
    }
}

#[test]
fn a_layout_with_keys_of_the_system_is_used_only_by_a_setup_that_allows_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("menu.ron");
    let board = include_str!("../../layouts/keyboards/qwerty-flat.ron");
    let with_meta = board.replace(" G H J ", " G MetaLeft J ");
    assert_ne!(board, with_meta);
    fs::write(&path, with_meta).expect("room on the disk");
    let file = path.display().to_string();
    let mut setup = Setup {
        layout: file.clone(),
        ..Setup::default()
    };
    let error = setup.clone().load_files().expect_err("a key of the system");
    assert_eq!(
        error.to_string(),
        format!(
            "{file}: its key `MetaLeft` acts on the system and not just on one program; take it out, or allow \
             such keys with `allow_system_keys: true` in the setup"
        )
    );
    // Also when it takes the place of one that is in force.
    let layout = Layout::load(&file).expect("the layout itself is right");
    assert!(assemble(Setup::default()).controls(&layout).is_err());
    setup.allow_system_keys = true;
    let assembly = assemble(setup);
    assert!(assembly.controls(&layout).is_ok());
}

//! Suppressed events: presses beyond the rate limit, system keys, and events that the role of a source does not allow.

use std::fs;

use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::command::{Command, CommandOrigin};
use ademan::device::{EventKind, Events};
use ademan::document::Document;
use ademan::files::Load;
use ademan::layout::Layout;
use ademan::pipeline::{CommandError, Pipeline, PipelineState, SourceRole, Suppressed};
use ademan::setup::{LoadedSetup, OtherHand, Setup};

use crate::support::wearer::load_layout;

fn load(setup: Setup) -> LoadedSetup {
    setup.load_files().expect("a valid setup")
}

/// Types a text and returns the presses, and the releases with a slash.
fn type_with(setup: &LoadedSetup, pipeline: &mut Pipeline, text: &str) -> Vec<String> {
    let hand = setup.typist(text, &Hc11Format::default(), 0.0, 0);
    play(hand.expect("the layout has all keys"), pipeline)
}

/// Plays a hand and returns the presses, and the releases with a slash.
fn play(mut hand: impl Source, pipeline: &mut Pipeline) -> Vec<String> {
    let mut keys = Vec::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        let mut events = Events::new();
        pipeline
            .step(&reading, &mut events)
            .expect("an accepted reading");
        keys.extend(events.iter().filter_map(|event| match event.kind {
            EventKind::KeyDown(key) => Some(format!("{key}")),
            EventKind::KeyUp(key) => Some(format!("/{key}")),
            _ => None,
        }));
    }
    keys
}

#[test]
fn presses_beyond_the_rate_limit_release_everything_and_pause() {
    let setup = load(Setup {
        max_presses_per_second: Some(1),
        ..Setup::default()
    });
    let mut pipeline = setup.pipeline();
    assert_eq!(type_with(&setup, &mut pipeline, "hot"), ["H", "/H"]);
    assert_eq!(pipeline.state(), PipelineState::Paused);
    assert!(pipeline.is_paused());
    assert_eq!(pipeline.suppressed().rate_limited, 1);
}

#[test]
fn a_quick_sweep_over_a_slider_with_many_taps_stays_within_the_rate_limit() {
    let layout = r#"Layout(name: "t", boards: [(
        pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
        sliders: [(name: "S", at_mm: (0, 0), length_mm: 100, width_mm: 20, initial: 0, grab: Relative,
            output: Taps(increase: Key("A"), decrease: Key("B"), steps: 400))],
    )])"#;
    for max_presses_per_second in [None, Some(20)] {
        let setup = Setup {
            max_presses_per_second,
            ..Setup::default()
        };
        let setup = load_layout(layout, setup);
        let sweep = "press S -40 0; slide 80 0; lift; wait 3000";
        let hand = setup.scripted(sweep, &Hc11Format::default(), 0.0, 0);
        let mut pipeline = setup.pipeline();
        let keys = play(hand.expect("a script"), &mut pipeline);
        assert_eq!(pipeline.state(), PipelineState::Running);
        assert_eq!(pipeline.suppressed(), Suppressed::default());
        let taps = keys.iter().filter(|key| *key == "A").count();
        assert!((20..100).contains(&taps), "{keys:?}");
        assert_eq!(keys.len(), 2 * taps, "{keys:?}");
    }
}

#[test]
fn a_suppressed_press_releases_its_modifier() {
    let setup = load(Setup {
        max_presses_per_second: Some(1),
        ..Setup::default()
    });
    let mut pipeline = setup.pipeline();
    let keys = type_with(&setup, &mut pipeline, "H");
    assert_eq!(keys, ["ShiftLeft", "/ShiftLeft"]);
    assert_eq!(pipeline.suppressed().rate_limited, 1);
}

#[test]
fn a_letter_and_the_backspace_that_replaces_the_letter_before_are_one_press() {
    let setup = load(Setup {
        layout: "phone-pad".into(),
        max_presses_per_second: Some(3),
        ..Setup::default()
    });
    let script = "tap 2; wait 100; tap 2; wait 100; tap 2";
    let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
    let mut pipeline = setup.pipeline();
    let keys = play(hand.expect("a script"), &mut pipeline).join(" ");
    assert_eq!(
        keys,
        "A /A Backspace /Backspace B /B Backspace /Backspace C /C"
    );
    assert_eq!(pipeline.suppressed().rate_limited, 0);
}

#[test]
fn the_rate_limit_is_60_for_a_local_source_and_20_on_the_network() {
    let limit = |source: &str| {
        let setup = load(Setup {
            source: Some(source.parse().expect("a source")),
            ..Setup::default()
        });
        let mut pipeline = setup.pipeline();
        let text = "the quick brown fox jumps over the lazy dog";
        type_with(&setup, &mut pipeline, text);
        assert_eq!(
            pipeline.suppressed().rate_limited,
            0,
            "{source}: typed at the rate of a person"
        );
        let (_, permissions) = setup.sources().next().expect("one source");
        permissions.rate_limit.per_second
    };
    assert_eq!(limit("serial:/dev/ttyUSB0"), 60);
    assert_eq!(limit("tcp:10.0.0.7:4001"), 20);
}

/// Roles of the sources of a setup.
fn roles(setup: &str) -> Vec<SourceRole> {
    let setup: Setup = Document::new("setup.ron", setup).parse().expect("a setup");
    let setup = load(setup);
    setup
        .sources()
        .map(|(_, permissions)| permissions.role)
        .collect()
}

#[test]
fn the_default_role_is_both_and_pointer_on_the_network() {
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
    assert_eq!(roles("Setup()"), [SourceRole::Both], "no source");
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
        "each source has its own role"
    );
}

#[test]
fn an_unknown_role_and_a_role_without_a_source_are_refused() {
    let document = Document::new("setup.ron", "Setup(role: Boht)");
    let error = document
        .parse::<Setup>()
        .expect_err("an unknown role")
        .to_string();
    assert!(error.contains("did you mean `Both`?"), "{error}");
    let setup = Setup {
        other_hand: Some(OtherHand {
            role: Some(SourceRole::Pointer),
            ..OtherHand::default()
        }),
        ..Setup::default()
    };
    let role_error = setup
        .load_files()
        .expect_err("a role without a source")
        .to_string();
    assert_eq!(
        role_error,
        "`other_hand` has a `role` but no `source`; set the `role` of the first source, which provides both hands"
    );
}

#[test]
fn the_person_allows_keys_while_the_session_runs_and_a_layout_cannot() {
    let setup = load(Setup {
        source: Some("tcp:10.0.0.7:4001".parse().expect("a source")),
        ..Setup::default()
    });
    let mut pipeline = setup.pipeline();
    let execute = |commanded: &mut Pipeline, command, origin| {
        commanded.execute(&command, origin, &mut Events::new())
    };
    let refused = execute(&mut pipeline, Command::AllowKeys, CommandOrigin::Layout);
    assert_eq!(refused, Err(CommandError::Permission));
    assert!(type_with(&setup, &mut pipeline, "a").is_empty());
    for (command, typed) in [
        (Command::AllowKeys, &["A", "/A"][..]),
        (Command::ForbidKeys, &[]),
    ] {
        let mut allowed = setup.pipeline();
        execute(&mut allowed, Command::AllowKeys, CommandOrigin::Client).expect("it is allowed");
        execute(&mut allowed, command, CommandOrigin::Client).expect("it is allowed");
        assert_eq!(type_with(&setup, &mut allowed, "a"), typed, "{command:?}");
    }
}

#[test]
fn keys_of_a_source_on_the_network_are_suppressed_unless_its_role_allows_them() {
    let type_as = |role| {
        let setup = load(Setup {
            source: Some("tcp:10.0.0.7:4001".parse().expect("a source")),
            role,
            ..Setup::default()
        });
        let mut pipeline = setup.pipeline();
        let typed = type_with(&setup, &mut pipeline, "Hi");
        assert_eq!(pipeline.state(), PipelineState::Running);
        (typed.len(), pipeline.suppressed())
    };
    let (typed, suppressed) = type_as(None);
    assert_eq!((typed, suppressed.keys_by_role), (0, 3));
    assert_eq!(suppressed.total(), 3);
    for role in [SourceRole::Keys, SourceRole::Both] {
        assert_eq!(type_as(Some(role)), (6, Suppressed::default()));
    }
}

#[test]
fn a_rate_limit_out_of_range_is_refused() {
    for limit in [0, 1001] {
        let setup = Setup {
            max_presses_per_second: Some(limit),
            ..Setup::default()
        };
        let error = setup
            .load_files()
            .expect_err("a limit out of range")
            .to_string();
        assert_eq!(
            error,
            format!("`max_presses_per_second` is 1 to 1000, not {limit}")
        );
    }
}

#[test]
fn system_keys_need_the_permission_of_the_setup() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("menu.ron");
    let board = include_str!("../../layouts/keyboards/qwerty-flat.ron");
    let with_meta = board.replace(" G H J ", " G MetaLeft J ");
    assert_ne!(board, with_meta);
    fs::write(&path, with_meta).expect("a writable file");
    let file = path.display().to_string();
    let mut setup = Setup {
        layout: file.clone(),
        ..Setup::default()
    };
    let error = setup.clone().load_files().expect_err("a system key");
    assert_eq!(
        error.to_string(),
        format!(
            "{file}: the key `MetaLeft` acts on the system; remove it, or set `allow_system_keys: true` in the setup"
        )
    );
    // A layout that replaces another one is checked too.
    let layout = Layout::load(&file).expect("a valid layout");
    let refused = load(Setup::default()).layout_instance(&layout);
    assert!(refused.is_err_and(|refusal| refusal.to_string() == error.to_string()));
    setup.allow_system_keys = true;
    let setup = load(setup);
    assert!(setup.layout_instance(&layout).is_ok());
}

//! Two hands on one keyboard, and several layouts in one setup, through the whole pipeline.

use ademan::command::CommandOrigin;
use ademan::device::Events;
use ademan::document::Document;
use ademan::estimate::{Estimate, JointAngles};
use ademan::hand::Side;
use ademan::pipeline::SourceRole;
use ademan::pipeline::{HandLoss, PipelineState};
use ademan::setup::{LoadedSetup, OtherHand, ProfileSetup, ReplaySettings, Setup};
use ademan::time::Timestamp;

use crate::wearer::Wearer;

/// Returns a wearer of two gloves whose hands rest above F and J.
fn both_hands(setup: Setup) -> Wearer {
    let mut wearer = Wearer::new(Setup {
        other_hand: Some(setup.other_hand.unwrap_or_default()),
        layout: "qwerty-two-flat".into(),
        ..setup
    });
    wearer.go(Side::Left, "F", false);
    wearer.go(Side::Right, "J", false);
    wearer.hold_still(400);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer
}

#[test]
fn one_hand_holds_shift_while_the_other_types() {
    let mut wearer = both_hands(Setup::default());
    wearer.go(Side::Left, "ShiftLeft", false);
    wearer.hold_still(150);
    wearer.go(Side::Left, "ShiftLeft", true);
    wearer.hold_still(150);
    wearer.tap(Side::Right, "J");
    wearer.tap(Side::Right, "K");
    wearer.go(Side::Left, "ShiftLeft", false);
    wearer.hold_still(150);
    wearer.tap(Side::Left, "F");
    assert_eq!(
        wearer.transcript(),
        "+ShiftLeft +J -J +K -K -ShiftLeft +F -F"
    );
}

#[test]
fn a_hand_touches_only_boards_for_its_side() {
    let loaded = both_hands(Setup::default()).loaded;
    let board_of = |key: &str| {
        let target = loaded.layout.key(key).expect("a key").face.target;
        loaded.layout.scene.target(target).expect("a target").0
    };
    let right = loaded
        .arm
        .forward(&Estimate::new(Timestamp(0), JointAngles::default()));
    let left = loaded.arm.clone().for_side(Side::Left);
    let left = left.forward(&Estimate::new(Timestamp(0), JointAngles::default()));
    for (key, seen, unseen) in [("F", left, right), ("J", right, left)] {
        assert!(board_of(key).world_from_surface(&seen).is_some(), "{key}");
        assert!(board_of(key).world_from_surface(&unseen).is_none(), "{key}");
    }
}

#[test]
fn a_missing_hand_releases_its_keys_and_the_other_one_continues() {
    let mut wearer = both_hands(Setup::default());
    wearer.go(Side::Left, "F", true);
    wearer.go(Side::Right, "J", true);
    wearer.hold_still(150);
    assert_eq!(wearer.transcript(), "+F +J");
    wearer.shown[Side::Left.index()] = None;
    wearer.hold_still(220);
    assert_eq!(wearer.transcript(), "-F");
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    assert_eq!(wearer.pipeline.stalls(), 1);
    wearer.go(Side::Right, "J", false);
    wearer.hold_still(150);
    wearer.tap(Side::Right, "K");
    assert_eq!(wearer.transcript(), "-J +K -K");
    wearer.go(Side::Left, "F", true);
    wearer.hold_still(1_000);
    assert_eq!(wearer.transcript(), "", "the finger appears in a key");
    wearer.go(Side::Left, "F", false);
    wearer.hold_still(150);
    wearer.tap(Side::Left, "F");
    assert_eq!(wearer.transcript(), "+F -F");
    wearer.shown = [None, None];
    wearer.time_ms += 300;
    wearer.go(Side::Right, "J", false);
    wearer.hold_still(10);
    assert_eq!(
        wearer.pipeline.state(),
        PipelineState::Stalled,
        "both were gone"
    );
}

#[test]
fn output_is_not_armed_while_one_of_two_hands_is_on_a_key() {
    let mut wearer = Wearer::new(Setup {
        other_hand: Some(OtherHand::default()),
        layout: "qwerty-two-flat".into(),
        ..Setup::default()
    });
    wearer.go(Side::Left, "F", true);
    wearer.go(Side::Right, "J", false);
    wearer.hold_still(1_000);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.go(Side::Left, "F", false);
    wearer.hold_still(200);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.hold_still(200);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    assert_eq!(wearer.transcript(), "");
}

#[test]
fn one_hand_types_while_the_other_is_not_tracked() {
    let mut wearer = both_hands(Setup::default());
    wearer.shown[Side::Left.index()] = None;
    wearer.hold_still(1_000);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer.tap(Side::Right, "J");
    assert_eq!(wearer.transcript(), "+J -J");
}

#[test]
fn each_hand_has_the_role_of_its_source() {
    let mut wearer = both_hands(Setup {
        source: Some("tcp:box:4001".parse().expect("a source")),
        other_hand: Some(OtherHand {
            source: Some("serial:/dev/x".parse().expect("a source")),
            ..OtherHand::default()
        }),
        ..Setup::default()
    });
    wearer.tap(Side::Right, "J");
    wearer.tap(Side::Left, "F");
    wearer.tap(Side::Right, "K");
    assert_eq!(wearer.transcript(), "+F -F");
    assert_eq!(wearer.pipeline.suppressed().keys_by_role, 2);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
}

#[test]
fn a_hand_beyond_the_rate_limit_touches_nothing_until_it_is_resumed_and_the_other_types() {
    let mut wearer = both_hands(Setup {
        max_presses_per_second: Some(2),
        ..Setup::default()
    });
    for _ in 0..3 {
        wearer.tap(Side::Left, "F");
    }
    assert_eq!(wearer.pipeline.suppressed().rate_limited, 1);
    assert!(wearer.pipeline.lost_hands()[Side::Left.index()]);
    assert_eq!(
        wearer.pipeline.hand_losses(),
        [Some(HandLoss::TooFast), None]
    );
    for key in ["J", "K"] {
        wearer.hold_still(1_000);
        wearer.tap(Side::Right, key);
        wearer.tap(Side::Left, "F");
    }
    assert_eq!(wearer.transcript(), "+F -F +J -J +K -K");
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer.pipeline.resume(CommandOrigin::Client);
    wearer.hold_still(1_000);
    wearer.tap(Side::Left, "F");
    assert_eq!(wearer.transcript(), "+F -F");
}

#[test]
fn a_hold_of_a_pointer_source_is_not_typed_by_the_other_hand() {
    let board = Document::shipped("qwerty-two-flat").expect("it is shipped");
    let row = "at_mm: (-42.75, -19), keys: \"N M Comma";
    assert!(board.text.contains(row));
    let board = board
        .text
        .replace(row, "at_mm: (-23.75, -19), keys: \"M Comma");
    let keys = "keys: [\n (code: \"N\", hold: (code: \"ControlRight\"), hold_after_ms: 250, at_mm: (-42.75, -19)),
                (code: \"ShiftRight\"";
    let board = board.replace("keys: [\n                (code: \"ShiftRight\"", keys);
    let typed = |role| {
        let setup = Setup {
            source: Some("tcp:box:4001".parse().expect("a source")),
            role,
            other_hand: Some(OtherHand {
                source: Some("serial:/dev/x".parse().expect("a source")),
                ..OtherHand::default()
            }),
            ..Setup::default()
        };
        let mut wearer = Wearer::with_layout(&board, setup);
        wearer.go(Side::Left, "F", false);
        wearer.go(Side::Right, "N", false);
        wearer.hold_still(400);
        // A hold that starts with a key of the other hand, and one that starts after its time.
        wearer.go(Side::Right, "N", true);
        wearer.hold_still(150);
        wearer.tap(Side::Left, "F");
        wearer.go(Side::Right, "N", false);
        wearer.hold_still(150);
        wearer.tap(Side::Right, "ShiftRight");
        wearer.tap(Side::Left, "F");
        (
            wearer.transcript(),
            wearer.pipeline.suppressed().keys_by_role,
        )
    };
    let both = "+ControlRight +F -F -ControlRight +ShiftRight +F -F -ShiftRight";
    assert_eq!(typed(Some(SourceRole::Both)), (both.into(), 0));
    assert_eq!(typed(None), ("+F -F +F -F".into(), 2));
}

#[test]
fn two_gloves_for_the_same_hand_are_rejected() {
    let setup = Setup {
        other_hand: Some(OtherHand {
            glove: Some("unam-hc11".into()),
            ..OtherHand::default()
        }),
        ..Setup::default()
    };
    assert_eq!(
        setup.load_files().unwrap_err().to_string(),
        "both gloves are for the right hand, `other_hand` needs a glove for the left hand"
    );
}

/// Returns a setup with two layouts, and the temporary folder of their files.
fn setup_of(main: &str, other: &str) -> (tempfile::TempDir, Setup) {
    let folder = tempfile::tempdir().expect("a folder");
    let layout = |name: &str, keys: &str| {
        let path = folder.path().join(name);
        let text = format!(
            "Layout(name: \"{name}\", boards: [(pose: (anchor: elbow, bearing_deg: 35, \
             forward_mm: 300, height_mm: -45), keys: [{keys}])])"
        );
        std::fs::write(&path, text).expect("a file");
        path.display().to_string()
    };
    let setup = Setup {
        layout: layout("main.ron", main),
        profiles: vec![ProfileSetup {
            name: "other".into(),
            text: None,
            layout: layout("other.ron", other),
        }],
        ..Setup::default()
    };
    (folder, setup)
}

const MAIN: &str = r#"(code: "A", at_mm: (-20, 0)), (action: Command("profile other"), name: "other", at_mm: (0, 0)),
    (action: Command("next-profile"), name: "next", at_mm: (20, 0))"#;
const OTHER: &str = r#"(code: "B", at_mm: (0, 0)), (action: Command("profile main"), name: "main", at_mm: (20, 0))"#;

#[test]
fn a_key_activates_another_layout_and_the_finger_must_leave_first() {
    let (_folder, setup) = setup_of(MAIN, OTHER);
    let mut wearer = Wearer::new(setup);
    wearer.go(Side::Right, "A", false);
    wearer.hold_still(400);
    wearer.tap(Side::Right, "A");
    wearer.go(Side::Right, "other", false);
    wearer.hold_still(150);
    wearer.go(Side::Right, "other", true);
    wearer.hold_still(500);
    assert_eq!(
        wearer.transcript(),
        "+A -A profile other",
        "not B, which is at the same position now"
    );
    assert_eq!(wearer.pipeline.active_profile(), 1);
    wearer.tap(Side::Right, "B");
    wearer.tap(Side::Right, "main");
    assert_eq!(wearer.pipeline.active_profile(), 0);
    wearer.tap(Side::Right, "next");
    assert_eq!(wearer.pipeline.active_profile(), 1);
    assert_eq!(wearer.transcript(), "+B -B profile main next-profile");
}

#[test]
fn held_keys_are_released_before_a_layout_change() {
    let (_folder, setup) = setup_of(MAIN, OTHER);
    let mut wearer = Wearer::new(setup);
    wearer.go(Side::Right, "A", false);
    wearer.hold_still(400);
    wearer.go(Side::Right, "A", true);
    wearer.hold_still(150);
    let mut events = Events::new();
    wearer.pipeline.switch_profile(1, &mut events);
    wearer.write(&events);
    wearer.hold_still(500);
    assert_eq!(wearer.transcript(), "+A -A");
    wearer.pipeline.switch_profile(7, &mut events);
    assert_eq!(
        wearer.pipeline.active_profile(),
        1,
        "there is no such profile"
    );
}

#[test]
fn an_unknown_profile_is_rejected_by_name() {
    let (_folder, setup) = setup_of(&MAIN.replace("profile other", "profile othre"), OTHER);
    let error = setup.load_files().unwrap_err().to_string();
    let end = "unknown profile `othre`, did you mean `other`?; add it to `profiles` of the setup";
    assert!(error.ends_with(end), "{error}");
    let (_other_folder, mut twice) = setup_of(MAIN, OTHER);
    twice.profiles[0].name = "main".into();
    let twice_error = twice.load_files().unwrap_err().to_string();
    let expected =
        "`profiles`: the name `main` is the name of the first layout; choose another one";
    assert_eq!(twice_error, expected);
}

#[test]
fn a_setup_with_two_hands_and_profiles_survives_a_recording() {
    let (_folder, mut setup) = setup_of(MAIN, OTHER);
    setup.other_hand = Some(OtherHand::default());
    let loaded = setup.load_files().expect("a setup");
    let recorded = loaded.recorded_setup();
    let again = LoadedSetup::from_recording(&recorded, &ReplaySettings::default())
        .expect("it was recorded");
    let texts = |each: &LoadedSetup| -> Vec<String> {
        each.layouts().map(|layout| layout.text.clone()).collect()
    };
    assert_eq!(texts(&again), texts(&loaded));
    assert_eq!(again.setup, loaded.setup);
    let glove = Document::shipped("unam-hc11-left").expect("it is shipped");
    assert_eq!(
        recorded.get("other-glove").map(|entry| &entry.text),
        Some(&glove.text)
    );
}

#[test]
fn a_key_pauses_and_resumes_without_side_effects() {
    let keys = r#"(code: "A", at_mm: (-20, 0)), (action: Command("toggle-pause"), name: "pause", at_mm: (0, 0)),
        (code: "ShiftLeft", latch: OneShot, at_mm: (20, 0))"#;
    let (_folder, setup) = setup_of(keys, OTHER);
    let mut wearer = Wearer::new(setup);
    wearer.go(Side::Right, "A", false);
    wearer.hold_still(400);
    wearer.tap(Side::Right, "pause");
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.tap(Side::Right, "ShiftLeft");
    wearer.tap(Side::Right, "A");
    assert_eq!(wearer.transcript(), "toggle-pause", "nothing goes out");
    wearer.tap(Side::Right, "pause");
    wearer.hold_still(400);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer.tap(Side::Right, "A");
    assert_eq!(
        wearer.transcript(),
        "+A -A",
        "without the Shift of the pause"
    );
}

//! The locks, one-shots and switched keys of a hand end when it is lost, and those that the other hand has set stay.

use ademan::command::CommandOrigin;
use ademan::hand::{HandPart, Side};
use ademan::pipeline::{HandLoss, PipelineState};
use ademan::setup::{OtherHand, Setup};

use crate::wearer::{Wearer, boards_of_both_hands};

/// A board for each hand. The left one locks, arms and switches; both type.
const BOARDS: &str = r#"Layout(name: "boards", boards: [
    (
        hand: "left",
        pose: (anchor: elbow, bearing_deg: -35, forward_mm: 300, height_mm: -45),
        pitch_mm: 24, size_mm: Box(22, 20),
        keys: [
            (code: "ControlLeft", name: "lock", latch: Lock, at_mm: (-48, 0)),
            (code: "F", at_mm: (0, 0)),
            (code: "ShiftLeft", name: "once", latch: OneShot, at_mm: (-24, 0)),
            (layer: "digits", name: "layer-once", latch: OneShot, at_mm: (24, 0)),
            (layer: "digits", name: "layer-lock", latch: Lock, at_mm: (48, 0)),
        ],
        toggles: [
            (name: "toggle", at_mm: (-24, 24), hold: Key("W")),
            (name: "tapping", at_mm: (48, 24), tap: Key("T")),
        ],
        radios: [(name: "radio", options: [
            (name: "off", at_mm: (0, 24)),
            (name: "on", at_mm: (24, 24), hold: Key("Space")),
        ])],
    ),
    (
        hand: "right",
        pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
        pitch_mm: 24, size_mm: Box(22, 20),
        keys: [
            (code: "J", at_mm: (0, 0)),
            (code: "K", at_mm: (24, 0)),
            (code: "AltLeft", name: "right-lock", latch: Lock, at_mm: (-24, 0)),
        ],
        toggles: [(name: "right-toggle", at_mm: (-24, 24), hold: Key("V"))],
    ),
], layers: [(name: "digits", keys: {"J": "1"})])"#;

fn wearer(setup: Setup) -> Wearer {
    let setup = Setup {
        other_hand: Some(OtherHand::default()),
        ..setup
    };
    let mut wearer = Wearer::with_layout(BOARDS, setup);
    wearer.go(Side::Left, "F", false);
    wearer.go(Side::Right, "J", false);
    wearer.hold_still(400);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer
}

/// The controls that stay on, what they type, and what comes up when the left hand is lost.
const CONTROLS: [(&str, &str, &str); 6] = [
    ("lock", "+ControlLeft", "-ControlLeft"),
    ("toggle", "+W", "-W"),
    ("on", "+Space", "-Space"),
    ("once", "", ""),
    ("layer-once", "", ""),
    ("layer-lock", "", ""),
];

#[test]
fn a_hand_without_readings_releases_what_it_has_locked_and_switched_on() {
    for (control, on, off) in CONTROLS {
        let mut wearer = wearer(Setup::default());
        wearer.tap(Side::Left, control);
        assert_eq!(wearer.transcript(), on, "{control}");
        wearer.shown[Side::Left.index()] = None;
        wearer.hold_still(300);
        assert_eq!(wearer.transcript(), off, "{control}");
        let losses = wearer.pipeline.hand_losses();
        assert_eq!(losses, [Some(HandLoss::NoReadings), None]);
        wearer.tap(Side::Right, "J");
        assert_eq!(wearer.transcript(), "+J -J", "{control}");
        assert_eq!(wearer.pipeline.state(), PipelineState::Running);
        // It switches on again, and not off, when the hand is back.
        wearer.go(Side::Left, "F", false);
        wearer.hold_still(300);
        wearer.tap(Side::Left, control);
        assert_eq!(wearer.transcript(), on, "{control}");
    }
}

#[test]
fn a_one_shot_ends_in_a_gap_of_its_hand_that_may_hide_its_key() {
    for (control, armed) in [
        ("once", "+ShiftLeft +J -J -ShiftLeft"),
        ("layer-once", "+1 -1"),
    ] {
        for (missing, typed) in [(100, armed), (160, "+J -J")] {
            let mut wearer = wearer(Setup::default());
            wearer.tap(Side::Left, control);
            let shown = wearer.shown[Side::Left.index()].take();
            wearer.hold_still(missing);
            wearer.shown[Side::Left.index()] = shown;
            wearer.hold_still(100);
            wearer.tap(Side::Right, "J");
            assert_eq!(wearer.transcript(), typed, "{control}, {missing} ms");
        }
    }
}

#[test]
fn a_lost_source_releases_what_its_hand_has_locked_and_switched_on() {
    for part in [None, Some(HandPart::Fingers)] {
        let mut wearer = wearer(Setup::default());
        wearer.tap(Side::Left, "lock");
        wearer.tap(Side::Left, "toggle");
        assert_eq!(wearer.transcript(), "+ControlLeft +W");
        wearer.lose(Side::Left, part);
        assert_eq!(wearer.transcript(), "-W -ControlLeft", "{part:?}");
    }
}

#[test]
fn the_other_hand_keeps_what_it_holds_and_has_set() {
    let mut wearer = wearer(Setup::default());
    wearer.tap(Side::Right, "right-lock");
    wearer.tap(Side::Right, "right-toggle");
    wearer.press(Side::Right, "J");
    wearer.tap(Side::Left, "tapping");
    wearer.tap(Side::Left, "lock");
    assert_eq!(wearer.transcript(), "+AltLeft +V +J +T -T +ControlLeft");
    wearer.shown[Side::Left.index()] = None;
    wearer.hold_still(1_000);
    assert_eq!(wearer.transcript(), "-ControlLeft");
    wearer.go(Side::Right, "J", false);
    wearer.hold_still(150);
    wearer.tap(Side::Right, "right-toggle");
    wearer.tap(Side::Right, "right-lock");
    assert_eq!(wearer.transcript(), "-J -V -AltLeft");
}

#[test]
fn a_hand_suspended_by_the_rate_limit_releases_what_it_has_locked() {
    let mut wearer = wearer(Setup {
        max_presses_per_second: Some(2),
        ..Setup::default()
    });
    wearer.tap(Side::Left, "lock");
    wearer.hold_still(1_000);
    for _ in 0..3 {
        wearer.tap(Side::Left, "F");
    }
    assert_eq!(wearer.transcript(), "+ControlLeft +F -F -ControlLeft");
    assert_eq!(wearer.pipeline.suppressed().rate_limited, 1);
    wearer.hold_still(1_000);
    wearer.tap(Side::Right, "J");
    assert_eq!(wearer.transcript(), "+J -J");
    wearer.pipeline.resume(CommandOrigin::Client);
    wearer.hold_still(1_000);
    wearer.tap(Side::Left, "lock");
    assert_eq!(wearer.transcript(), "+ControlLeft");
}

#[test]
fn a_key_of_the_layout_does_not_resume_a_hand_suspended_by_the_rate_limit() {
    let boards = boards_of_both_hands(
        r#"keys: [
                (code: "W", name: "SIDE-w", at_mm: (0, 0)),
                (action: Command("resume"), name: "SIDE-resume", at_mm: (24, 0)),
            ]"#,
    );
    let layout = format!(r#"Layout(name: "resume", boards: [{boards}])"#);
    let setup = Setup {
        max_presses_per_second: Some(2),
        other_hand: Some(OtherHand::default()),
        ..Setup::default()
    };
    let mut wearer = Wearer::with_layout(&layout, setup);
    wearer.go(Side::Left, "left-w", false);
    wearer.go(Side::Right, "right-w", false);
    wearer.hold_still(400);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    for _ in 0..3 {
        wearer.tap(Side::Left, "left-w");
    }
    wearer.hold_still(1_000);
    wearer.tap(Side::Right, "right-resume");
    wearer.tap(Side::Left, "left-w");
    assert_eq!(wearer.transcript(), "+W -W resume");
    wearer.pipeline.resume(CommandOrigin::Client);
    wearer.hold_still(1_000);
    wearer.tap(Side::Left, "left-w");
    assert_eq!(wearer.transcript(), "+W -W");
}

//! Two hands of which one may only point, or only type: each press is judged by the hand that causes it.

use ademan::hand::Side;
use ademan::pipeline::{PipelineState, SourceRole};
use ademan::setup::{OtherHand, Setup};

use crate::wearer::{Wearer, boards_of_both_hands};

/// Returns a layout with the same board for each hand. The name of a control starts with the side of its hand.
fn boards() -> String {
    let boards = boards_of_both_hands(
        r#"keys: [
                (code: "W", name: "SIDE-w", at_mm: (0, 0)),
                (code: "ControlLeft", name: "SIDE-control", at_mm: (-24, 0)),
                (code: "MouseLeft", name: "SIDE-click", at_mm: (24, 0)),
                (code: "A", hold: (code: "ControlRight"), hold_after_ms: 105, name: "SIDE-hold", at_mm: (48, 0)),
                (code: "D", dwell_ms: 105, name: "SIDE-dwell", at_mm: (0, 24)),
                (action: Text("hi"), dwell_ms: 105, name: "SIDE-text", at_mm: (24, 24)),
                (code: "C", name: "SIDE-chord", at_mm: (-48, 0)),
            ],
            toggles: [(name: "SIDE-toggle", at_mm: (-24, 24), hold: Key("ControlLeft"))]"#,
    );
    let chords =
        r#"chord_timeout_ms: 45, chords: [(keys: "left-chord right-chord", action: Key("X"))]"#;
    format!(r#"Layout(name: "roles", boards: [{boards}], {chords})"#)
}

/// Returns a wearer whose left hand sends first in each step.
fn wearer(left: SourceRole, right: SourceRole) -> Wearer {
    let setup = Setup {
        source: Some("serial:/dev/right".parse().expect("a source")),
        role: Some(right),
        other_hand: Some(OtherHand {
            source: Some("serial:/dev/left".parse().expect("a source")),
            role: Some(left),
            ..OtherHand::default()
        }),
        ..Setup::default()
    };
    let mut wearer = Wearer::with_layout(&boards(), setup);
    wearer.go(Side::Left, "left-w", false);
    wearer.go(Side::Right, "right-w", false);
    wearer.hold_still(400);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer
}

#[test]
fn a_switch_of_a_hand_that_may_only_point_neither_types_nor_hides_a_key() {
    let mut wearer = wearer(SourceRole::Pointer, SourceRole::Both);
    wearer.tap(Side::Left, "left-toggle");
    wearer.tap(Side::Right, "right-control");
    assert_eq!(wearer.transcript(), "+ControlLeft -ControlLeft");
    wearer.press(Side::Right, "right-control");
    wearer.tap(Side::Left, "left-toggle");
    assert_eq!(wearer.transcript(), "+ControlLeft", "still held");
    assert_eq!(wearer.pipeline.suppressed().keys_by_role, 1);
}

#[test]
fn delayed_presses_are_judged_by_their_hand() {
    for (control, expected) in [
        ("hold", "+ControlRight -ControlRight"),
        ("dwell", "+D -D"),
        ("text", "h i"),
        ("chord", "+C -C"),
    ] {
        let roles = [SourceRole::Pointer, SourceRole::Both];
        for (left, right) in [(roles[0], roles[1]), (roles[1], roles[0])] {
            for (side, role) in [(Side::Left, left), (Side::Right, right)] {
                let mut wearer = wearer(left, right);
                wearer.tap(side, &format!("{side}-{control}"));
                let is_typed = role == SourceRole::Both;
                let (typed, count) = (wearer.transcript(), u64::from(!is_typed));
                assert_eq!(
                    typed,
                    if is_typed { expected } else { "" },
                    "{side} {control}"
                );
                assert_eq!(wearer.pipeline.suppressed().keys_by_role, count);
            }
        }
    }
}

#[test]
fn a_button_that_a_role_suppresses_does_not_hide_the_button_of_the_other_hand() {
    let mut wearer = wearer(SourceRole::Keys, SourceRole::Both);
    wearer.press(Side::Left, "left-click");
    wearer.tap(Side::Right, "right-click");
    wearer.hold_still(300);
    assert_eq!(wearer.transcript(), "+MouseLeft -MouseLeft");
    assert_eq!(wearer.pipeline.suppressed().pointing_by_role, 1);
}

//! Radio groups.

use super::{assert_events, simulate};

const VALUE_ONLY: &str = r#"radios: [(name: "Mode", initial: "Draw", options: [
    (name: "Draw", at_mm: (0, 0)), (name: "Fill", at_mm: (30, 0)), (name: "Erase", at_mm: (60, 0)),
])]"#;
const HOLD: &str = r#"radios: [(name: "Mode", options: [
    (name: "Move", at_mm: (0, 0), hold: Key("ShiftLeft")),
    (name: "Turn", at_mm: (30, 0), hold: Key("ControlLeft")),
    (name: "Off", at_mm: (60, 0)),
])]"#;
const TAP: &str = r#"radios: [(name: "Tool", options: [
    (name: "Brush", at_mm: (0, 0), tap: Key("B")), (name: "Pen", at_mm: (30, 0), tap: Key("P")),
])]"#;

#[test]
fn one_option_of_a_group_is_on() {
    assert_events(
        VALUE_ONLY,
        "index Fill tap; thumb Erase tap",
        "value:Draw=0.000 value:Fill=1.000 value:Fill=0.000 value:Erase=1.000",
    );
}

#[test]
fn pressing_the_option_that_is_on_has_no_effect() {
    assert_events(VALUE_ONLY, "index Draw tap", "");
    assert_events(
        TAP,
        "index Pen tap; index Pen tap; wait 500; index Pen tap",
        "dn:P up:P value:Pen=1.000",
    );
}

#[test]
fn the_previous_option_is_released_before_the_new_one_is_pressed() {
    assert_events(
        HOLD,
        "index Move tap; index Turn tap; index Off tap",
        "dn:ShiftLeft value:Move=1.000 up:ShiftLeft value:Move=0.000 dn:ControlLeft \
         value:Turn=1.000 up:ControlLeft value:Turn=0.000 value:Off=1.000",
    );
}

#[test]
fn only_a_press_switches_an_option() {
    let before = "index Turn up; index Turn down";
    let on = "dn:ControlLeft value:Turn=1.000";
    for after in [
        "index Turn up",
        "index Off down; index Off up",
        "hide index; wait 50; index Turn down",
    ] {
        assert_eq!(simulate(HOLD, &format!("{before}; {after}")), on, "{after}");
    }
    assert_events(HOLD, "index Turn up; index Turn 1; index Turn up", "");
}

#[test]
fn release_all_switches_holding_options_off() {
    assert_events(
        HOLD,
        "index Move tap; release; index Move tap",
        "dn:ShiftLeft value:Move=1.000 up:ShiftLeft value:Move=0.000 dn:ShiftLeft value:Move=1.000",
    );
}

#[test]
fn release_all_leaves_tapping_options_on() {
    assert_events(
        TAP,
        "index Pen tap; release; index Pen tap; index Brush tap",
        "dn:P up:P value:Pen=1.000 value:Pen=0.000 dn:B up:B value:Brush=1.000",
    );
}

#[test]
fn groups_are_independent() {
    let two = r#"radios: [
        (name: "X", options: [(name: "A", at_mm: (0, 0)), (name: "B", at_mm: (30, 0))]),
        (name: "Y", options: [(name: "C", at_mm: (60, 0)), (name: "D", at_mm: (90, 0))]),
    ]"#;
    assert_events(
        two,
        "index B tap; index C tap; index A tap",
        "value:B=1.000 value:C=1.000 value:B=0.000 value:A=1.000",
    );
}

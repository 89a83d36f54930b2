//! Radio groups.

use super::simulate;

const TOLD: &str = r#"radios: [(name: "Mode", starts: "Draw", options: [
    (name: "Draw", at_mm: (0, 0)), (name: "Fill", at_mm: (30, 0)), (name: "Erase", at_mm: (60, 0)),
])]"#;
const HOLDS: &str = r#"radios: [(name: "Mode", options: [
    (name: "Move", at_mm: (0, 0), holds: Key("ShiftLeft")),
    (name: "Turn", at_mm: (30, 0), holds: Key("ControlLeft")),
    (name: "Off", at_mm: (60, 0)),
])]"#;
const TAPS: &str = r#"radios: [(name: "Tool", options: [
    (name: "Brush", at_mm: (0, 0), taps: Key("B")), (name: "Pen", at_mm: (30, 0), taps: Key("P")),
])]"#;

#[test]
fn one_of_several_is_on() {
    assert_eq!(
        simulate(TOLD, "index Fill tap; thumb Erase tap"),
        "value:Draw=0.000 value:Fill=1.000 value:Fill=0.000 value:Erase=1.000"
    );
}

#[test]
fn poking_the_one_that_is_on_does_nothing() {
    assert_eq!(simulate(TOLD, "index Draw tap"), "");
    assert_eq!(
        simulate(
            TAPS,
            "index Pen tap; index Pen tap; wait 500; index Pen tap"
        ),
        "dn:P up:P value:Pen=1.000"
    );
}

#[test]
fn what_the_old_one_holds_comes_up_before_the_new_one_goes_down() {
    assert_eq!(
        simulate(HOLDS, "index Move tap; index Turn tap; index Off tap"),
        "dn:ShiftLeft value:Move=1.000 up:ShiftLeft value:Move=0.000 dn:ControlLeft \
             value:Turn=1.000 up:ControlLeft value:Turn=0.000 value:Off=1.000"
    );
}

#[test]
fn withdrawing_sliding_off_and_losing_the_finger_switch_nothing() {
    let before = "index Turn up; index Turn down";
    let on = "dn:ControlLeft value:Turn=1.000";
    for after in [
        "index Turn up",
        "index Off down; index Off up",
        "hide index; wait 50; index Turn down",
    ] {
        assert_eq!(
            simulate(HOLDS, &format!("{before}; {after}")),
            on,
            "{after}"
        );
    }
    assert_eq!(
        simulate(HOLDS, "index Turn up; index Turn 1; index Turn up"),
        ""
    );
}

#[test]
fn nothing_that_holds_is_on_after_everything_is_let_go_of() {
    assert_eq!(
        simulate(HOLDS, "index Move tap; release; index Move tap"),
        "dn:ShiftLeft value:Move=1.000 up:ShiftLeft value:Move=0.000 dn:ShiftLeft value:Move=1.000"
    );
}

#[test]
fn an_option_that_taps_stays_on_when_everything_is_let_go_of() {
    assert_eq!(
        simulate(
            TAPS,
            "index Pen tap; release; index Pen tap; index Brush tap"
        ),
        "dn:P up:P value:Pen=1.000 value:Pen=0.000 dn:B up:B value:Brush=1.000"
    );
}

#[test]
fn groups_know_nothing_of_each_other() {
    let two = r#"radios: [
        (name: "X", options: [(name: "A", at_mm: (0, 0)), (name: "B", at_mm: (30, 0))]),
        (name: "Y", options: [(name: "C", at_mm: (60, 0)), (name: "D", at_mm: (90, 0))]),
    ]"#;
    assert_eq!(
        simulate(two, "index B tap; index C tap; index A tap"),
        "value:B=1.000 value:C=1.000 value:B=0.000 value:A=1.000"
    );
}

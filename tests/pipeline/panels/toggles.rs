//! Toggle switches.

use super::simulate;

const TOLD: &str = r#"toggles: [(name: "Light", at_mm: (0, 0))]"#;
const HOLDS: &str = r#"toggles: [(name: "Shift", at_mm: (0, 0), holds: Key("ShiftLeft"))],
    keys: [(code: "A", at_mm: (40, 0))]"#;
const TAPS: &str = r#"toggles: [(name: "Play", at_mm: (0, 0), taps: Key("MediaPlayPause"))]"#;

#[test]
fn one_poke_is_one_change_and_withdrawing_changes_nothing() {
    assert_eq!(simulate(TOLD, "index Light tap"), "value:Light=1.000");
    assert_eq!(
        simulate(TOLD, "index Light tap; wait 50; index Light tap"),
        "value:Light=1.000 value:Light=0.000"
    );
    assert_eq!(
        simulate(
            TOLD,
            "index Light up; index Light 10; wait 2000; index Light up"
        ),
        "value:Light=1.000",
        "however long and deep"
    );
    assert_eq!(
        simulate(
            TOLD,
            "index Light up; index Light down; index Light 40 0 down"
        ),
        "value:Light=1.000",
        "sliding off is no second poke"
    );
    assert_eq!(
        simulate(TOLD, "index Light up; index Light 1; index Light up"),
        "",
        "not deep enough"
    );
}

#[test]
fn what_a_switch_holds_is_down_as_long_as_it_is_on() {
    assert_eq!(
        simulate(HOLDS, "index Shift tap; index A tap; index Shift tap"),
        "dn:ShiftLeft value:Shift=1.000 dn:A up:A up:ShiftLeft value:Shift=0.000"
    );
}

#[test]
fn a_switch_that_holds_is_off_when_everything_is_let_go_of() {
    assert_eq!(
        simulate(HOLDS, "index Shift tap; release; index Shift tap"),
        "dn:ShiftLeft value:Shift=1.000 up:ShiftLeft value:Shift=0.000 dn:ShiftLeft value:Shift=1.000"
    );
}

#[test]
fn a_switch_that_taps_stays_as_it_is_when_everything_is_let_go_of() {
    assert_eq!(
        simulate(TAPS, "index Play tap; release; index Play tap"),
        "dn:MediaPlayPause up:MediaPlayPause value:Play=1.000 dn:MediaPlayPause up:MediaPlayPause \
             value:Play=0.000"
    );
}

#[test]
fn a_finger_that_is_lost_on_a_switch_changes_nothing_more() {
    assert_eq!(
        simulate(
            TOLD,
            "index Light up; index Light down; hide index; index Light down"
        ),
        "value:Light=1.000"
    );
}

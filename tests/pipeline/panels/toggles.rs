//! Toggle switches.

use super::assert_events;

const VALUE_ONLY: &str = r#"toggles: [(name: "Light", at_mm: (0, 0))]"#;
const HOLD: &str = r#"toggles: [(name: "Shift", at_mm: (0, 0), hold: Key("ShiftLeft"))],
    keys: [(code: "A", at_mm: (40, 0))]"#;
const TAP: &str = r#"toggles: [(name: "Play", at_mm: (0, 0), tap: Key("MediaPlayPause"))]"#;

#[test]
fn a_switch_changes_once_per_press() {
    assert_events(VALUE_ONLY, "index Light tap", "value:Light=1.000");
    assert_events(
        VALUE_ONLY,
        "index Light tap; wait 50; index Light tap",
        "value:Light=1.000 value:Light=0.000",
    );
    // Regardless of time and depth.
    assert_events(
        VALUE_ONLY,
        "index Light up; index Light 10; wait 2000; index Light up",
        "value:Light=1.000",
    );
    // Sliding off is not a second press.
    assert_events(
        VALUE_ONLY,
        "index Light up; index Light down; index Light 40 0 down",
        "value:Light=1.000",
    );
    // Not deep enough.
    assert_events(
        VALUE_ONLY,
        "index Light up; index Light 1; index Light up",
        "",
    );
}

#[test]
fn noise_between_press_and_release_depth_changes_a_switch_once() {
    let noise = "index Light down; index Light up; ".repeat(20);
    assert_events(
        VALUE_ONLY,
        &format!("index Light up; {noise}"),
        "value:Light=1.000",
    );
}

#[test]
fn a_switch_holds_its_action_while_it_is_on() {
    assert_events(
        HOLD,
        "index Shift tap; index A tap; index Shift tap",
        "dn:ShiftLeft value:Shift=1.000 dn:A up:A up:ShiftLeft value:Shift=0.000",
    );
}

#[test]
fn release_all_switches_a_holding_switch_off() {
    assert_events(
        HOLD,
        "index Shift tap; release; index Shift tap",
        "dn:ShiftLeft value:Shift=1.000 up:ShiftLeft value:Shift=0.000 dn:ShiftLeft value:Shift=1.000",
    );
}

#[test]
fn release_all_leaves_a_tapping_switch_unchanged() {
    assert_events(
        TAP,
        "index Play tap; release; index Play tap",
        "dn:MediaPlayPause up:MediaPlayPause value:Play=1.000 dn:MediaPlayPause up:MediaPlayPause \
         value:Play=0.000",
    );
}

#[test]
fn a_lost_finger_does_not_change_a_switch() {
    assert_events(
        VALUE_ONLY,
        "index Light up; index Light down; hide index; index Light down",
        "value:Light=1.000",
    );
}

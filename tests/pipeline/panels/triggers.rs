//! Triggers: angles and pinches as controls.

use ademan::layout::Layout;

use super::{assert_layout_events, simulate_layout};
use crate::rig::Rig;

const BOARD: &str = r#"keys: [(code: "A", at_mm: (0, 0))]"#;
const CLAW: &str = r#"triggers: [(name: "Claw", action: Key("X"),
    when: Angle(dof: "index-mcp-flexion", on_deg: 60, off_deg: 50))]"#;
const BLADE: &str = r#"triggers: [(name: "Blade", output: Axis("RightTrigger"),
    when: Angle(dof: "index-mcp-flexion", on_deg: 60, off_deg: 50, zero_deg: 20, full_deg: 70))]"#;
const PINCH: &str =
    r#"triggers: [(name: "Pinch", action: Key("MouseLeft"), when: Pinch(finger: "index"))]"#;

/// Returns a script that bends the index knuckle to these angles, one per step.
fn bend(degrees: &[i32]) -> String {
    let orders: Vec<String> = degrees
        .iter()
        .map(|degrees| format!("set index-mcp-flexion {degrees}"))
        .collect();
    orders.join("; ")
}

/// Returns a script that holds the fingertips of thumb and index this far apart, one distance per step.
fn pinch(millimetres: &[i32]) -> String {
    let orders: Vec<String> = millimetres
        .iter()
        .map(|gap| format!("tip thumb 0 100 0 & tip index {gap} 100 0"))
        .collect();
    orders.join("; ")
}

fn claw(script: &str) -> String {
    simulate_layout(BOARD, CLAW, script)
}

#[test]
fn a_layout_of_triggers_needs_no_board() {
    let text = format!("Layout(name: \"t\", {CLAW})");
    assert!(Layout::parse(&text, "t.ron").is_ok());
}

#[test]
fn a_trigger_has_hysteresis() {
    assert_eq!(
        claw(&bend(&[0, 59, 61, 55, 51, 59, 50, 55, 60])),
        "dn:X value:Claw=1.000 up:X value:Claw=0.000 dn:X value:Claw=1.000"
    );
}

#[test]
fn a_trigger_can_switch_on_below_its_threshold() {
    let back = CLAW.replace("on_deg: 60, off_deg: 50", "on_deg: -20, off_deg: -10");
    assert_layout_events(
        BOARD,
        &back,
        &bend(&[0, -15, -20, -15, -10]),
        "dn:X value:Claw=1.000 up:X value:Claw=0.000",
    );
}

#[test]
fn a_trigger_has_to_be_seen_off_before_it_switches_on() {
    assert_eq!(claw(&bend(&[70, 80, 55])), "", "it was never seen off");
    assert_eq!(claw(&bend(&[70, 40, 70])), "dn:X value:Claw=1.000");
    assert_eq!(
        claw(&format!(
            "{}; release; {}",
            bend(&[0, 70]),
            bend(&[75, 40, 70])
        )),
        "dn:X value:Claw=1.000 up:X value:Claw=0.000 dn:X value:Claw=1.000"
    );
}

#[test]
fn a_trigger_without_measurement_is_off() {
    assert_eq!(claw("set middle-mcp-flexion 80; wait 100"), "");
}

#[test]
fn an_untrusted_finger_switches_a_trigger_off() {
    assert_eq!(
        claw(&format!(
            "{}; doubt index; trust index; {}",
            bend(&[0, 70]),
            bend(&[70, 55])
        )),
        "dn:X value:Claw=1.000 up:X value:Claw=0.000"
    );
    assert_eq!(
        claw(&format!("{}; doubt middle", bend(&[0, 70]))),
        "dn:X value:Claw=1.000",
        "other fingers have no effect"
    );
}

#[test]
fn a_reacquired_hand_switches_a_trigger_off() {
    assert_eq!(
        claw(&format!(
            "{}; reacquire; {}",
            bend(&[0, 70]),
            bend(&[70, 55])
        )),
        "dn:X value:Claw=1.000 up:X value:Claw=0.000"
    );
}

#[test]
fn the_value_of_a_trigger_follows_the_angle() {
    assert_layout_events(
        BOARD,
        BLADE,
        &bend(&[0, 20, 45, 70, 90, 45]),
        "value:Blade=0.500 axis:RightTrigger=+0.500 value:Blade=1.000 axis:RightTrigger=+1.000 \
         value:Blade=0.500 axis:RightTrigger=+0.500",
    );
}

#[test]
fn a_trigger_at_value_0_leaves_every_axis_at_rest() {
    let yaw = BLADE.replace("RightTrigger", "TurnY");
    assert_layout_events(BOARD, &yaw, &bend(&[0, 10]), "");
    assert_layout_events(
        BOARD,
        &yaw,
        &bend(&[0, 45, 90, 0]),
        "value:Blade=0.500 axis:TurnY=+0.500 value:Blade=1.000 axis:TurnY=+1.000 \
         value:Blade=0.000 axis:TurnY=+0.000",
    );
}

#[test]
fn the_axis_of_a_trigger_returns_to_0_when_the_finger_is_lost() {
    assert_layout_events(
        BOARD,
        BLADE,
        &format!("{}; doubt index", bend(&[0, 45])),
        "value:Blade=0.500 axis:RightTrigger=+0.500 value:Blade=0.000 axis:RightTrigger=+0.000",
    );
    // And follows the hand when it is seen again.
    assert_layout_events(
        BOARD,
        BLADE,
        &format!("{}; release", bend(&[0, 45])),
        "value:Blade=0.500 axis:RightTrigger=+0.500 value:Blade=0.000 axis:RightTrigger=+0.000 \
         value:Blade=0.500 axis:RightTrigger=+0.500",
    );
}

#[test]
fn a_trigger_does_not_scroll_for_changes_while_it_was_unknown() {
    let wheel = BLADE.replace(r#"Axis("RightTrigger")"#, "ScrollY(10)");
    assert_layout_events(
        BOARD,
        &wheel,
        &format!(
            "{}; doubt index; trust index; {}",
            bend(&[45, 45]),
            bend(&[50])
        ),
        "value:Blade=0.500 value:Blade=0.000 value:Blade=0.500 value:Blade=0.600 scroll=+0,+120",
    );
}

#[test]
fn a_pinch_switches_on_at_25_mm_and_off_above_30_mm() {
    assert_layout_events(
        BOARD,
        PINCH,
        &pinch(&[60, 26, 25, 29, 31, 26, 24]),
        "dn:MouseLeft value:Pinch=1.000 up:MouseLeft value:Pinch=0.000 dn:MouseLeft value:Pinch=1.000",
    );
}

#[test]
fn a_pinch_trigger_ends_when_one_of_its_fingers_is_lost() {
    for end in ["hide thumb", "hide index", "doubt thumb", "doubt index"] {
        assert_layout_events(
            BOARD,
            PINCH,
            &format!("{}; {end}", pinch(&[60, 20])),
            "dn:MouseLeft value:Pinch=1.000 up:MouseLeft value:Pinch=0.000",
        );
    }
}

#[test]
fn a_trigger_follows_its_hand_or_each_hand() {
    let left = CLAW.replace("action:", r#"hand: "left", action:"#);
    let bent = bend(&[0, 70]);
    assert_layout_events(BOARD, &left, &format!("right; {bent}"), "");
    assert_layout_events(
        BOARD,
        &left,
        &format!("left; {bent}"),
        "dn:X value:Claw=1.000",
    );
    let mut rig = Rig::with_fields(BOARD, CLAW);
    rig.run(&format!(
        "left; {bent}; right; {bent}; left; {}",
        bend(&[0])
    ));
    assert!(!rig.events().contains("up:X"), "{}", rig.events());
    rig.run(&format!("right; {}", bend(&[0])));
    assert!(rig.events().contains("up:X"), "{}", rig.events());
}

//! Angles and pinches as controls.

use super::simulate_layout;
use crate::rig::Rig;

const BOARD: &str = r#"keys: [(code: "A", at_mm: (0, 0))]"#;
const CLAW: &str = r#"triggers: [(name: "Claw", does: Key("X"),
    when: Angle(of: "index-mcp-flexion", on_deg: 60, off_deg: 50))]"#;
const BLADE: &str = r#"triggers: [(name: "Blade", drives: Axis("RightTrigger"),
    when: Angle(of: "index-mcp-flexion", on_deg: 60, off_deg: 50, from_deg: 20, full_deg: 70))]"#;
const PINCH: &str =
    r#"triggers: [(name: "Pinch", does: Key("MouseLeft"), when: Pinch(of: "index"))]"#;

/// The index knuckle at these angles, frame by frame.
fn bend(degrees: &[i32]) -> String {
    let orders: Vec<String> = degrees
        .iter()
        .map(|degrees| format!("set index-mcp-flexion {degrees}"))
        .collect();
    orders.join("; ")
}

/// The tips of thumb and index so many millimetres apart, frame by frame.
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
fn an_angle_goes_on_past_one_limit_and_off_past_the_other() {
    assert_eq!(
        claw(&bend(&[0, 59, 61, 55, 51, 59, 50, 55, 60])),
        "dn:X value:Claw=1.000 up:X value:Claw=0.000 dn:X value:Claw=1.000"
    );
}

#[test]
fn where_off_is_more_than_on_less_is_on() {
    let back = CLAW.replace("on_deg: 60, off_deg: 50", "on_deg: -20, off_deg: -10");
    assert_eq!(
        simulate_layout(BOARD, &back, &bend(&[0, -15, -20, -15, -10])),
        "dn:X value:Claw=1.000 up:X value:Claw=0.000"
    );
}

#[test]
fn a_trigger_has_to_be_seen_off_before_it_goes_on() {
    assert_eq!(claw(&bend(&[70, 80, 55])), "", "it was never off");
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
fn an_angle_that_is_not_measured_is_off() {
    assert_eq!(claw("set middle-mcp-flexion 80; wait 100"), "");
}

#[test]
fn a_finger_that_is_not_believed_lets_go() {
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
        "another finger does not matter"
    );
}

#[test]
fn a_jump_of_the_hand_lets_go() {
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
fn the_value_goes_along_with_the_angle() {
    assert_eq!(
        simulate_layout(BOARD, BLADE, &bend(&[0, 20, 45, 70, 90, 45])),
        "value:Blade=0.500 axis:RightTrigger=+0.500 value:Blade=1.000 axis:RightTrigger=+1.000 \
             value:Blade=0.500 axis:RightTrigger=+0.500"
    );
}

#[test]
fn an_axis_springs_back_when_the_finger_is_lost() {
    assert_eq!(
        simulate_layout(BOARD, BLADE, &format!("{}; doubt index", bend(&[0, 45]))),
        "value:Blade=0.500 axis:RightTrigger=+0.500 value:Blade=0.000 axis:RightTrigger=+0.000"
    );
    assert_eq!(
        simulate_layout(BOARD, BLADE, &format!("{}; release", bend(&[0, 45]))),
        "value:Blade=0.500 axis:RightTrigger=+0.500 value:Blade=0.000 axis:RightTrigger=+0.000 \
             value:Blade=0.500 axis:RightTrigger=+0.500",
        "and goes on from where the hand is seen then"
    );
}

#[test]
fn what_a_trigger_stood_at_before_it_was_seen_turns_no_wheel() {
    let wheel = BLADE.replace(r#"Axis("RightTrigger")"#, "ScrollY(10)");
    assert_eq!(
        simulate_layout(
            BOARD,
            &wheel,
            &format!(
                "{}; doubt index; trust index; {}",
                bend(&[45, 45]),
                bend(&[50])
            )
        ),
        "value:Blade=0.500 value:Blade=0.000 value:Blade=0.500 value:Blade=0.600 scroll=+0,+120"
    );
}

#[test]
fn a_pinch_is_on_from_25_mm_to_30_mm() {
    assert_eq!(
        simulate_layout(BOARD, PINCH, &pinch(&[60, 26, 25, 29, 31, 26, 24])),
        "dn:MouseLeft value:Pinch=1.000 up:MouseLeft value:Pinch=0.000 dn:MouseLeft value:Pinch=1.000"
    );
}

#[test]
fn a_pinch_ends_when_one_of_its_fingers_is_lost() {
    for end in ["hide thumb", "hide index", "doubt thumb", "doubt index"] {
        assert_eq!(
            simulate_layout(BOARD, PINCH, &format!("{}; {end}", pinch(&[60, 20]))),
            "dn:MouseLeft value:Pinch=1.000 up:MouseLeft value:Pinch=0.000",
            "{end}"
        );
    }
}

#[test]
fn a_trigger_is_of_the_hand_that_it_names_or_of_either() {
    let left = CLAW.replace("does:", r#"hand: "left", does:"#);
    let bent = bend(&[0, 70]);
    assert_eq!(simulate_layout(BOARD, &left, &format!("right; {bent}")), "");
    assert_eq!(
        simulate_layout(BOARD, &left, &format!("left; {bent}")),
        "dn:X value:Claw=1.000"
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

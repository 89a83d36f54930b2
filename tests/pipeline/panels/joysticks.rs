//! Joysticks.

use super::assert_events;

const STICK: &str = r#"joysticks: [(name: "Stick", at_mm: (0, 0), diameter_mm: 30, dead_zone: 0,
    axes: ("LeftX", "LeftY"))]"#;
const KEYS: &str = r#"joysticks: [(name: "Stick", at_mm: (0, 0), diameter_mm: 30,
    direction_keys: (up: Key("W"), down: Key("S"), left: Key("A"), right: Key("D")))]"#;
const PUSHED: &str = r#"joysticks: [(name: "Stick", at_mm: (0, 0), diameter_mm: 30, travel_mm: 16,
    push_action: Key("PadL3"))]"#;
const POINTER: &str = r#"joysticks: [(name: "Stick", at_mm: (0, 0), diameter_mm: 30,
    pointer_px_per_s: 1000)]"#;

/// All ways in which the press of a finger can end.
const ENDS: [&str; 5] = [
    "index Stick 20 0 up",
    "hide index",
    "doubt index",
    "index Stick 90 0 down",
    "release",
];

#[test]
fn a_stick_is_deflected_by_the_distance_from_the_press() {
    // Limited to full deflection.
    assert_events(
        STICK,
        "index Stick 5 0 up; index Stick 5 0 down; index Stick 15 0 down; index Stick 5 -40 down",
        "axis:LeftX=+0.500 axis:LeftX=+0.000 axis:LeftY=-1.000",
    );
}

#[test]
fn a_stick_returns_to_0_however_its_press_ends() {
    for end in ENDS {
        assert_events(
            STICK,
            &format!("index Stick up; index Stick down; index Stick 20 0 down; {end}; wait 50"),
            "axis:LeftX=+1.000 axis:LeftX=+0.000",
        );
    }
}

#[test]
fn a_stick_is_centered_within_its_dead_zone() {
    let stick = STICK.replace("dead_zone: 0,", "dead_zone: 0.5, exponent: 2,");
    assert_events(
        &stick,
        "index Stick up; index Stick down; index Stick 9 0 down; index Stick 15 0 down; index Stick -3 0 down",
        "axis:LeftX=+0.250 axis:LeftX=+0.000",
    );
}

#[test]
fn a_second_finger_on_a_stick_is_ignored() {
    assert_events(
        STICK,
        "index Stick up & middle Stick 5 0 up; index Stick down & middle Stick 5 0 down; middle \
         Stick 20 0 down; middle Stick 20 0 up; index Stick 10 0 down",
        "axis:LeftX=+0.500",
    );
}

#[test]
fn a_direction_key_has_hysteresis() {
    assert_events(
        KEYS,
        "index Stick up; index Stick down; index Stick 9 0 down; index Stick 11 0 down; index \
         Stick 9 0 down; index Stick 11 0 down; index Stick 7 0 down",
        "dn:D up:D",
    );
    // A diagonal presses two directions, and releases precede presses.
    assert_events(
        KEYS,
        "index Stick up; index Stick down; index Stick 14 14 down; index Stick -14 14 down",
        "dn:W dn:D up:D dn:A",
    );
}

#[test]
fn a_direction_key_is_released_however_the_press_ends() {
    for end in ENDS {
        assert_events(
            KEYS,
            &format!("index Stick up; index Stick down; index Stick 20 0 down; {end}; wait 50"),
            "dn:D up:D",
        );
    }
}

#[test]
fn a_deep_push_presses_its_action() {
    assert_events(
        PUSHED,
        "index Stick up; index Stick 10; index Stick 15; index Stick 12; index Stick 15; index \
         Stick 10; index Stick 20; index Stick up",
        "dn:PadL3 up:PadL3 dn:PadL3 up:PadL3",
    );
}

#[test]
fn a_stick_moves_the_pointer_while_it_is_held() {
    assert_events(
        POINTER,
        "index Stick up; index Stick down; index Stick 20 0 down; wait 20; index Stick 0 20 down; \
         index Stick up; wait 50",
        "move=+10,+0 move=+10,+0 move=+10,+0 move=+0,-10",
    );
}

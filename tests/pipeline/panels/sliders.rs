//! Sliders.

use super::assert_events;

const FADER: &str = r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100)]"#;
const RELATIVE: &str =
    r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100, grab: Relative, initial: 0.5)]"#;
const TURNED: &str =
    r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100, rotation_deg: 90)]"#;
const STEPS: &str = r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100, steps: 4)]"#;
const TRIGGER: &str =
    r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100, output: Axis("LeftTrigger"))]"#;
const TAPS: &str = r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100, initial: 0.5,
    output: Taps(increase: Key("AudioVolumeUp"), decrease: Key("AudioVolumeDown"), steps: 10))]"#;

#[test]
fn the_handle_jumps_to_the_finger_and_follows_it() {
    assert_events(
        FADER,
        "index Fader up; index Fader down; wait 100; index Fader 25 0 down; index Fader -50 0 down",
        "value:Fader=0.500 value:Fader=0.750 value:Fader=0.000",
    );
}

#[test]
fn a_touch_without_a_press_does_not_move_the_handle() {
    assert_events(
        FADER,
        "index Fader up; index Fader 1; index Fader 20 0 1",
        "",
    );
}

#[test]
fn a_lifted_finger_does_not_move_the_handle() {
    assert_events(
        FADER,
        "index Fader up; index Fader down; index Fader 5 0 up; index Fader 30 0 up",
        "value:Fader=0.500",
    );
}

#[test]
fn a_rotated_slider_moves_along_its_own_axis() {
    // Along the target's own X axis.
    assert_events(
        TURNED,
        "index Fader up; index Fader down; index Fader 25 0 down",
        "value:Fader=0.500 value:Fader=0.750",
    );
    // Away from the wearer in the world increases the value.
    assert_events(
        TURNED,
        "tip index 0 11 0; tip index 0 1 0; tip index 0 1 -25; tip index 40 1 -25",
        "value:Fader=0.500 value:Fader=0.750",
    );
}

#[test]
fn a_relative_grab_does_not_move_the_handle() {
    assert_events(
        RELATIVE,
        "index Fader 30 0 up; index Fader 30 0 down; index Fader 40 0 down; index Fader 30 0 down",
        "value:Fader=0.600 value:Fader=0.500",
    );
}

#[test]
fn tremor_between_two_steps_does_not_change_the_value() {
    assert_events(
        STEPS,
        "index Fader -38 0 up; index Fader -38 0 down; index Fader -36 0 down; index Fader -34 0 \
         down; index Fader -37 0 down; index Fader -36 0 down; index Fader -34 0 down; index \
         Fader -42 0 down",
        "value:Fader=0.250 value:Fader=0.000",
    );
}

#[test]
fn a_finger_that_strays_sideways_keeps_its_grip() {
    assert_events(
        FADER,
        "index Fader up; index Fader down; index Fader 10 20 down; index Fader 70 -20 down",
        "value:Fader=0.500 value:Fader=0.600 value:Fader=1.000",
    );
    // A finger further than 30 mm beside the track loses its grip.
    assert_events(
        FADER,
        "index Fader up; index Fader down; index Fader 10 45 down; index Fader 20 0 down",
        "value:Fader=0.500",
    );
}

#[test]
fn a_second_finger_is_ignored_until_it_presses_a_free_slider() {
    assert_events(
        FADER,
        "index Fader up & middle Fader 40 0 up; index Fader down; middle Fader 40 0 down; middle \
         Fader 30 0 down; index Fader 10 0 down; index Fader 10 0 up; middle Fader 20 0 down; \
         middle Fader 20 0 up; middle Fader 20 0 down",
        "value:Fader=0.500 value:Fader=0.600 value:Fader=0.700",
    );
}

#[test]
fn the_value_stays_when_the_hand_is_lost() {
    for end in ["hide index", "doubt index", "release"] {
        assert_events(
            FADER,
            &format!("index Fader up; index Fader down; {end}; wait 100; index Fader 20 0 down"),
            "value:Fader=0.500",
        );
    }
}

#[test]
fn release_all_returns_an_axis_to_0_until_the_next_grip() {
    assert_events(
        TRIGGER,
        "index Fader up; index Fader down; index Fader up; wait 100; release; index Fader up; \
         index Fader down",
        "value:Fader=0.500 axis:LeftTrigger=+0.500 axis:LeftTrigger=+0.000 axis:LeftTrigger=+0.500",
    );
}

#[test]
fn each_step_of_the_value_taps() {
    assert_events(
        TAPS,
        "index Fader up; index Fader down; index Fader 20 0 down; index Fader 10 0 down",
        "value:Fader=0.700 dn:AudioVolumeUp up:AudioVolumeUp dn:AudioVolumeUp up:AudioVolumeUp \
         value:Fader=0.600 dn:AudioVolumeDown up:AudioVolumeDown",
    );
}

//! Sliders.

use super::simulate;

const FADER: &str = r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100)]"#;
const RELATIVE: &str =
    r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100, grab: Relative, start: 0.5)]"#;
const TURNED: &str = r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100, turn_deg: 90)]"#;
const STEPS: &str = r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100, steps: 4)]"#;
const TRIGGER: &str =
    r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100, drives: Axis("LeftTrigger"))]"#;
const TAPS: &str = r#"sliders: [(name: "Fader", at_mm: (0, 0), length_mm: 100, start: 0.5,
    drives: Taps(more: Key("AudioVolumeUp"), less: Key("AudioVolumeDown"), steps: 10))]"#;

#[test]
fn the_handle_comes_to_the_finger_and_goes_with_it() {
    assert_eq!(
        simulate(
            FADER,
            "index Fader up; index Fader down; wait 100; index Fader 25 0 down; index Fader -50 0 down"
        ),
        "value:Fader=0.500 value:Fader=0.750 value:Fader=0.000"
    );
}

#[test]
fn a_finger_that_only_touches_moves_nothing() {
    assert_eq!(
        simulate(FADER, "index Fader up; index Fader 1; index Fader 20 0 1"),
        ""
    );
}

#[test]
fn lifting_the_finger_off_moves_nothing() {
    assert_eq!(
        simulate(
            FADER,
            "index Fader up; index Fader down; index Fader 5 0 up; index Fader 30 0 up"
        ),
        "value:Fader=0.500"
    );
}

#[test]
fn a_turned_slider_is_moved_away_from_the_wearer() {
    // Along the target's own X, wherever that points.
    assert_eq!(
        simulate(
            TURNED,
            "index Fader up; index Fader down; index Fader 25 0 down"
        ),
        "value:Fader=0.500 value:Fader=0.750"
    );
    assert_eq!(
        simulate(
            TURNED,
            "tip index 0 11 0; tip index 0 1 0; tip index 0 1 -25; tip index 40 1 -25"
        ),
        "value:Fader=0.500 value:Fader=0.750",
        "what is forward in the world is up"
    );
}

#[test]
fn a_handle_that_is_grabbed_where_it_is_does_not_jump() {
    assert_eq!(
        simulate(
            RELATIVE,
            "index Fader 30 0 up; index Fader 30 0 down; index Fader 40 0 down; index Fader 30 0 down"
        ),
        "value:Fader=0.600 value:Fader=0.500"
    );
}

#[test]
fn between_two_steps_a_tremble_does_not_flutter() {
    assert_eq!(
        simulate(
            STEPS,
            "index Fader -38 0 up; index Fader -38 0 down; index Fader -36 0 down; index Fader -34 0 \
             down; index Fader -37 0 down; index Fader -36 0 down; index Fader -34 0 down; index \
             Fader -42 0 down"
        ),
        "value:Fader=0.250 value:Fader=0.000"
    );
}

#[test]
fn a_finger_that_strays_sideways_keeps_hold() {
    assert_eq!(
        simulate(
            FADER,
            "index Fader up; index Fader down; index Fader 10 20 down; index Fader 70 -20 down"
        ),
        "value:Fader=0.500 value:Fader=0.600 value:Fader=1.000"
    );
    assert_eq!(
        simulate(
            FADER,
            "index Fader up; index Fader down; index Fader 10 45 down; index Fader 20 0 down"
        ),
        "value:Fader=0.500",
        "further than 30 mm beside it has let go"
    );
}

#[test]
fn a_second_finger_is_ignored_until_it_presses_a_free_slider() {
    assert_eq!(
        simulate(
            FADER,
            "index Fader up & middle Fader 40 0 up; index Fader down; middle Fader 40 0 down; middle \
             Fader 30 0 down; index Fader 10 0 down; index Fader 10 0 up; middle Fader 20 0 down; \
             middle Fader 20 0 up; middle Fader 20 0 down"
        ),
        "value:Fader=0.500 value:Fader=0.600 value:Fader=0.700"
    );
}

#[test]
fn the_value_stays_when_the_hand_is_lost() {
    for end in ["hide index", "doubt index", "release"] {
        assert_eq!(
            simulate(
                FADER,
                &format!(
                    "index Fader up; index Fader down; {end}; wait 100; index Fader 20 0 down"
                )
            ),
            "value:Fader=0.500",
            "{end}"
        );
    }
}

#[test]
fn an_axis_goes_to_0_when_everything_is_let_go_of_and_comes_back_at_the_next_touch() {
    assert_eq!(
        simulate(
            TRIGGER,
            "index Fader up; index Fader down; index Fader up; wait 100; release; index Fader up; \
             index Fader down"
        ),
        "value:Fader=0.500 axis:LeftTrigger=+0.500 axis:LeftTrigger=+0.000 axis:LeftTrigger=+0.500"
    );
}

#[test]
fn each_step_of_the_way_taps() {
    assert_eq!(
        simulate(
            TAPS,
            "index Fader up; index Fader down; index Fader 20 0 down; index Fader 10 0 down"
        ),
        "value:Fader=0.700 dn:AudioVolumeUp up:AudioVolumeUp dn:AudioVolumeUp up:AudioVolumeUp \
             value:Fader=0.600 dn:AudioVolumeDown up:AudioVolumeDown"
    );
}

//! Knobs, turned at the rim and by a pinch.

use super::{assert_events, simulate};

const VOLUME: &str = r#"knobs: [(name: "Volume", at_mm: (0, 0), diameter_mm: 40, initial: 0.5)]"#;
const STEPS: &str =
    r#"knobs: [(name: "Volume", at_mm: (0, 0), diameter_mm: 40, initial: 0.5, steps: 6)]"#;
const ENDLESS: &str = r#"knobs: [(name: "Volume", at_mm: (0, 0), diameter_mm: 40, endless: true,
    output: ScrollY(12))]"#;
const AXIS: &str = r#"knobs: [(name: "Volume", at_mm: (0, 0), diameter_mm: 40, initial: 0.5,
    output: Axis("LeftX"))]"#;

const OPEN: &str = "tip thumb -30 20 0 & tip index 30 20 0";
const CLOSED: &str = "tip thumb -10 20 0 & tip index 10 20 0";

#[test]
fn a_finger_that_moves_around_the_rim_turns_the_knob() {
    // A quarter clockwise, back, and a quarter counter-clockwise.
    assert_events(
        VOLUME,
        "index Volume 15 0 up; index Volume 15 0 down; index Volume 0 -15 down; index Volume 15 0 \
         down; index Volume 0 15 down",
        "value:Volume=0.833 value:Volume=0.500 value:Volume=0.167",
    );
}

#[test]
fn a_press_and_motion_across_the_center_do_not_turn_a_knob() {
    // Only the quarter turn on the far side counts.
    assert_events(
        VOLUME,
        "index Volume 0 15 up; index Volume 0 15 down; index Volume 0 1 down; index Volume 1 0 \
         down; index Volume 0 -15 down; index Volume -15 0 down",
        "value:Volume=0.833",
    );
}

#[test]
fn a_knob_stops_at_its_end_and_turns_back_with_the_finger() {
    assert_events(
        VOLUME,
        "index Volume 15 0 up; index Volume 15 0 down; index Volume 0 -15 down; index Volume -15 \
         0 down; index Volume 0 -15 down",
        "value:Volume=0.833 value:Volume=1.000 value:Volume=0.667",
    );
}

#[test]
fn a_finger_beside_the_rim_keeps_its_grip_and_a_lost_one_leaves_the_value() {
    assert_events(
        VOLUME,
        "index Volume 15 0 up; index Volume 15 0 down; index Volume 0 -45 down; hide index; wait 20; \
         index Volume 15 0 down",
        "value:Volume=0.833",
    );
}

#[test]
fn a_knob_with_a_spring_returns_to_its_initial_value() {
    let shuttle = VOLUME.replace(", initial", ", springs_back: true, initial");
    assert_events(
        &shuttle,
        "index Volume 15 0 up; index Volume 15 0 down; index Volume 0 -15 down; index Volume 0 -15 up",
        "value:Volume=0.833 value:Volume=0.500",
    );
}

#[test]
fn a_second_finger_on_the_rim_is_ignored() {
    assert_events(
        VOLUME,
        "index Volume 15 0 up & middle Volume -15 0 up; index Volume 15 0 down & middle Volume \
         -15 0 down; middle Volume 0 -15 down; index Volume 0 -15 down",
        "value:Volume=0.833",
    );
}

#[test]
fn a_pinched_knob_follows_the_rotation_of_the_hand() {
    assert_events(
        VOLUME,
        &format!("{OPEN}; {CLOSED}; palm 0 -27 0; palm 0 27 0; {OPEN}; palm 0 0 0"),
        "value:Volume=0.600 value:Volume=0.400",
    );
}

#[test]
fn only_rotation_about_the_normal_turns_a_knob() {
    assert_events(
        VOLUME,
        &format!("{OPEN}; {CLOSED}; palm 20 0 0; palm 0 0 20"),
        "",
    );
}

#[test]
fn a_pinch_on_a_knob_has_hysteresis() {
    // 28 mm apart is not closed.
    assert_events(
        VOLUME,
        &format!("{OPEN}; tip thumb -14 20 0 & tip index 14 20 0; palm 0 -27 0"),
        "",
    );
    // 28 mm apart is not open.
    assert_events(
        VOLUME,
        &format!("{OPEN}; {CLOSED}; tip thumb -14 20 0 & tip index 14 20 0; palm 0 -27 0"),
        "value:Volume=0.600",
    );
}

#[test]
fn fingers_that_close_beside_a_knob_or_far_above_it_do_not_grip_it() {
    for position in [
        "tip thumb 30 20 0 & tip index 45 20 0",
        "tip thumb -10 50 0 & tip index 10 50 0",
    ] {
        assert_events(
            VOLUME,
            &format!("{OPEN}; {position}; {CLOSED}; palm 0 -27 0"),
            "",
        );
    }
}

#[test]
fn fingers_that_were_never_open_do_not_grip_a_knob() {
    assert_events(VOLUME, &format!("{CLOSED}; palm 0 -27 0"), "");
}

#[test]
fn a_lost_pinch_has_to_open_before_it_grips_again() {
    for end in [
        "doubt index; trust index",
        "hide thumb; tip thumb -10 20 0",
        "release",
    ] {
        assert_events(
            VOLUME,
            &format!("{OPEN}; {CLOSED}; {end}; palm 0 -27 0"),
            "",
        );
        assert_events(
            VOLUME,
            &format!("{OPEN}; {CLOSED}; {end}; {OPEN}; {CLOSED}; palm 0 -27 0"),
            "value:Volume=0.600",
        );
    }
}

#[test]
fn a_pinch_takes_over_from_its_own_finger_on_the_rim() {
    // The finger moves by a quarter turn, and the hand rotates by 27°.
    assert_events(
        VOLUME,
        "tip thumb -60 5 0; index Volume 8 0 up; index Volume 8 0 down; tip thumb -8 5 0; index \
         Volume 0 -8 down; palm 0 -27 0",
        "value:Volume=0.600",
    );
}

#[test]
fn a_pinch_does_not_take_over_from_another_finger() {
    let turn = format!("right; {OPEN}; {CLOSED}; palm 0 -27 0");
    assert_events(
        VOLUME,
        &format!("left; index Volume 15 0 up; index Volume 15 0 down; {turn}"),
        "",
    );
}

#[test]
fn a_knob_with_steps_snaps_to_them() {
    assert_events(
        STEPS,
        &format!("{OPEN}; {CLOSED}; palm 0 -25 0; palm 0 -28 0; palm 0 -25 0; palm 0 -17 0"),
        "value:Volume=0.667 value:Volume=0.500",
    );
}

#[test]
fn the_value_of_an_endless_knob_is_its_number_of_turns() {
    let turn = "index Volume 0 -15 down; index Volume -15 0 down; index Volume 0 15 down; index Volume 15 0 down";
    let events = simulate(
        ENDLESS,
        &format!("index Volume 15 0 up; index Volume 15 0 down; {turn}; {turn}"),
    );
    assert!(
        events.ends_with("value:Volume=2.000 scroll=+0,+360"),
        "{events}"
    );
    assert_eq!(events.matches("scroll=+0,+360").count(), 8, "{events}");
}

#[test]
fn the_axis_of_a_knob_is_0_until_the_knob_is_held_again() {
    assert_events(
        AXIS,
        &format!("{OPEN}; {CLOSED}; palm 0 -27 0; release; {OPEN}; {CLOSED}"),
        "value:Volume=0.600 axis:LeftX=+0.200 axis:LeftX=+0.000 axis:LeftX=+0.200",
    );
}

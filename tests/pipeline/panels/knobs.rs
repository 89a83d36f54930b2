//! Knobs, along the rim and pinched.

use super::simulate;

const VOLUME: &str = r#"knobs: [(name: "Volume", at_mm: (0, 0), diameter_mm: 40, start: 0.5)]"#;
const STEPS: &str =
    r#"knobs: [(name: "Volume", at_mm: (0, 0), diameter_mm: 40, start: 0.5, steps: 6)]"#;
const ENDLESS: &str = r#"knobs: [(name: "Volume", at_mm: (0, 0), diameter_mm: 40, endless: true,
    drives: ScrollY(12))]"#;
const AXIS: &str = r#"knobs: [(name: "Volume", at_mm: (0, 0), diameter_mm: 40, start: 0.5,
    drives: Axis("LeftX"))]"#;

const OPEN: &str = "tip thumb -30 20 0 & tip index 30 20 0";
const CLOSED: &str = "tip thumb -10 20 0 & tip index 10 20 0";

#[test]
fn a_finger_that_goes_round_the_rim_turns_the_knob() {
    assert_eq!(
        simulate(
            VOLUME,
            "index Volume 15 0 up; index Volume 15 0 down; index Volume 0 -15 down; index Volume 15 0 \
             down; index Volume 0 15 down"
        ),
        "value:Volume=0.833 value:Volume=0.500 value:Volume=0.167",
        "a quarter clockwise, back, and a quarter counter-clockwise"
    );
}

#[test]
fn a_press_and_the_way_over_the_middle_turn_nothing() {
    assert_eq!(
        simulate(
            VOLUME,
            "index Volume 0 15 up; index Volume 0 15 down; index Volume 0 1 down; index Volume 1 0 \
             down; index Volume 0 -15 down; index Volume -15 0 down"
        ),
        "value:Volume=0.833",
        "only the quarter on the far side counts"
    );
}

#[test]
fn beyond_its_end_a_knob_stands_and_comes_back_with_the_finger() {
    assert_eq!(
        simulate(
            VOLUME,
            "index Volume 15 0 up; index Volume 15 0 down; index Volume 0 -15 down; index Volume -15 \
             0 down; index Volume 0 -15 down"
        ),
        "value:Volume=0.833 value:Volume=1.000 value:Volume=0.667"
    );
}

#[test]
fn a_finger_beside_the_rim_keeps_hold_and_one_that_is_lost_leaves_the_knob_as_it_is() {
    assert_eq!(
        simulate(
            VOLUME,
            "index Volume 15 0 up; index Volume 15 0 down; index Volume 0 -45 down; hide index; index \
             Volume 15 0 down"
        ),
        "value:Volume=0.833"
    );
}

#[test]
fn a_second_finger_on_the_rim_is_ignored() {
    assert_eq!(
        simulate(
            VOLUME,
            "index Volume 15 0 up & middle Volume -15 0 up; index Volume 15 0 down & middle Volume \
             -15 0 down; middle Volume 0 -15 down; index Volume 0 -15 down"
        ),
        "value:Volume=0.833"
    );
}

#[test]
fn a_pinched_knob_turns_as_the_hand_does() {
    assert_eq!(
        simulate(
            VOLUME,
            &format!("{OPEN}; {CLOSED}; palm 0 -27 0; palm 0 27 0; {OPEN}; palm 0 0 0")
        ),
        "value:Volume=0.600 value:Volume=0.400"
    );
}

#[test]
fn only_the_turn_about_the_knobs_normal_counts() {
    assert_eq!(
        simulate(
            VOLUME,
            &format!("{OPEN}; {CLOSED}; palm 20 0 0; palm 0 0 20")
        ),
        ""
    );
}

#[test]
fn a_pinch_ends_further_apart_than_it_begins() {
    assert_eq!(
        simulate(
            VOLUME,
            &format!("{OPEN}; tip thumb -14 20 0 & tip index 14 20 0; palm 0 -27 0")
        ),
        "",
        "28 mm apart is not closed yet"
    );
    assert_eq!(
        simulate(
            VOLUME,
            &format!("{OPEN}; {CLOSED}; tip thumb -14 20 0 & tip index 14 20 0; palm 0 -27 0")
        ),
        "value:Volume=0.600",
        "nor open again"
    );
}

#[test]
fn fingers_that_close_beside_a_knob_or_too_far_from_it_do_not_take_it() {
    for place in [
        "tip thumb 30 20 0 & tip index 45 20 0",
        "tip thumb -10 50 0 & tip index 10 50 0",
    ] {
        assert_eq!(
            simulate(VOLUME, &format!("{OPEN}; {place}; {CLOSED}; palm 0 -27 0")),
            "",
            "{place}"
        );
    }
}

#[test]
fn fingers_that_were_never_seen_open_do_not_take_a_knob() {
    assert_eq!(simulate(VOLUME, &format!("{CLOSED}; palm 0 -27 0")), "");
}

#[test]
fn a_pinch_that_was_lost_has_to_be_made_again() {
    for end in [
        "doubt index; trust index",
        "hide thumb; tip thumb -10 20 0",
        "release",
    ] {
        assert_eq!(
            simulate(VOLUME, &format!("{OPEN}; {CLOSED}; {end}; palm 0 -27 0")),
            "",
            "{end}"
        );
        assert_eq!(
            simulate(
                VOLUME,
                &format!("{OPEN}; {CLOSED}; {end}; {OPEN}; {CLOSED}; palm 0 -27 0")
            ),
            "value:Volume=0.600",
            "{end}"
        );
    }
}

#[test]
fn a_pinch_takes_the_knob_from_its_own_finger_on_the_rim() {
    assert_eq!(
        simulate(
            VOLUME,
            "tip thumb -60 5 0; index Volume 8 0 up; index Volume 8 0 down; tip thumb -8 5 0; index \
             Volume 0 -8 down; palm 0 -27 0"
        ),
        "value:Volume=0.600",
        "the finger goes round a quarter, and the hand turns by 27°"
    );
}

#[test]
fn a_pinch_does_not_take_a_knob_from_another_finger() {
    let turn = format!("right; {OPEN}; {CLOSED}; palm 0 -27 0");
    assert_eq!(
        simulate(
            VOLUME,
            &format!("left; index Volume 15 0 up; index Volume 15 0 down; {turn}")
        ),
        ""
    );
}

#[test]
fn a_knob_with_steps_stands_on_one_of_them() {
    assert_eq!(
        simulate(
            STEPS,
            &format!("{OPEN}; {CLOSED}; palm 0 -25 0; palm 0 -28 0; palm 0 -25 0; palm 0 -17 0")
        ),
        "value:Volume=0.667 value:Volume=0.500"
    );
}

#[test]
fn an_endless_knob_counts_its_turns() {
    let turn = "index Volume 0 -15 down; index Volume -15 0 down; index Volume 0 15 down; index Volume 15 0 down";
    let told = simulate(
        ENDLESS,
        &format!("index Volume 15 0 up; index Volume 15 0 down; {turn}; {turn}"),
    );
    assert!(
        told.ends_with("value:Volume=2.000 scroll=+0,+360"),
        "{told}"
    );
    assert_eq!(told.matches("scroll=+0,+360").count(), 8, "{told}");
}

#[test]
fn the_axis_of_a_knob_rests_until_it_is_held_again() {
    assert_eq!(
        simulate(
            AXIS,
            &format!("{OPEN}; {CLOSED}; palm 0 -27 0; release; {OPEN}; {CLOSED}")
        ),
        "value:Volume=0.600 axis:LeftX=+0.200 axis:LeftX=+0.000 axis:LeftX=+0.200"
    );
}

//! Fingertips over a keyboard: script in, transcript out. Covers the contact stage and the keyboard.

mod keys;
mod options;
mod contact;
mod fast_taps;
mod random_fingers;

use crate::rig::Rig;

/// Returns the events of a script on a keyboard in shorthand, with times.
fn simulate(keys: &str, script: &str) -> String {
    Rig::with_keys(keys).run(script).transcript()
}

/// Returns the events of a script on a keyboard in shorthand, without times.
fn simulate_keys(keys: &str, script: &str) -> String {
    Rig::with_keys(keys).run(script).events()
}

/// Asserts that a script on a keyboard in shorthand has these events and times.
#[track_caller]
fn assert_transcript(keys: &str, script: &str, expected: &str) {
    assert_eq!(simulate(keys, script), expected, "{script}");
}

/// Asserts that a script on a keyboard in shorthand has these events.
#[track_caller]
fn assert_events(keys: &str, script: &str, expected: &str) {
    assert_eq!(simulate_keys(keys, script), expected, "{script}");
}

/// Returns a random number from `low` to `high`.
fn between(random: &mut fastrand::Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.f64()
}

const BOARD: &str = "q w e r / a s d f";

#[test]
fn a_tap_is_one_press_and_one_release() {
    // 2 mm deep 8 ms into the step down, 1 mm deep 3 ms into the step up.
    assert_transcript(BOARD, "index w tap", "t:18ms dn:W t:5ms up:W");
}

#[test]
fn a_key_that_is_held_does_not_repeat() {
    assert_transcript(
        BOARD,
        "index w up; index w down; wait 80; index w up",
        "t:18ms dn:W t:85ms up:W",
    );
    assert_events(BOARD, "index w up; index w down; wait 2000", "dn:W");
}

#[test]
fn chatter_between_press_and_release_depth_is_one_press() {
    let chatter = "index w 2.1; index w 1.9; ".repeat(20);
    let script = format!("index w up; {chatter}; index w up");
    assert_events(BOARD, &script, "dn:W up:W");
    let shallow = "index w 1.5; index w 0.2; ".repeat(20);
    let shallow_script = format!("index w up; {shallow}; index w up");
    assert_eq!(simulate_keys(BOARD, &shallow_script), "", "not deep enough");
}

#[test]
fn a_release_and_a_new_press_without_leaving_the_key_is_a_second_press() {
    assert_events(
        BOARD,
        "index w up; index w 3; index w 0.5; index w 3; index w up",
        "dn:W up:W dn:W up:W",
    );
}

#[test]
fn a_finger_that_slides_off_releases_its_key_and_does_not_press_the_neighbor() {
    let slide = "index w up; index w down; index e down; wait 50";
    assert_events(BOARD, slide, "dn:W up:W");
    let and_back = format!("{slide}; index w down; index q 3; index w up");
    assert_events(BOARD, &and_back, "dn:W up:W");
    let and_a_new_press = format!("{slide}; index e up; index e down");
    assert_events(BOARD, &and_a_new_press, "dn:W up:W dn:E");
}

#[test]
fn a_finger_that_rests_on_a_key_does_not_press_it_on_the_way_to_another_key_in_a_gap() {
    let way = "index w up; index w 1; gap 160 & index e down; wait 50";
    assert_events(BOARD, way, "");
    assert_events(BOARD, &format!("{way}; index e up; index e down"), "dn:E");
    // It stays.
    assert_events(
        BOARD,
        "index w up; index w 1; gap 160 & index w down",
        "dn:W",
    );
    // Without a gap.
    assert_events(BOARD, "index w up; index w 1; index e down", "dn:W up:W");
}

#[test]
fn a_stroke_that_turns_in_a_gap_presses_nothing() {
    const STROKES: &str = r#"press: Stroke, rows: [(at_mm: (0, 0), keys: "A B")]"#;
    // The stroke of a thumb presses when it turns.
    let stroke = |gap: u32| {
        let script = format!("thumb A up; thumb A 3; gap {gap} & thumb A up");
        Rig::on_board(STROKES).run(&script).events()
    };
    assert_eq!(stroke(100), "dn:A up:A");
    assert_eq!(stroke(160), "");
}

#[test]
fn tremor_at_the_edge_does_not_cancel_a_press() {
    let tremor = "index w 9.5 0 down; index w 7.5 0 down; ".repeat(10);
    let script = format!("index w 7.5 0 up; index w 7.5 0 down; {tremor}");
    assert_events(BOARD, &script, "dn:W");
    assert_events(
        BOARD,
        &format!("{script}; index w 10.5 0 down"),
        "dn:W up:W",
    );
}

#[test]
fn a_press_and_slide_within_one_step_is_released() {
    // 2 mm deep at 8/26 of the step, 10 mm aside at 10/19.
    assert_transcript(
        BOARD,
        "index w up; index e 20",
        "t:13.077ms dn:W t:2.186ms up:W",
    );
    // It leaves the key before it is deep enough.
    assert_events(BOARD, "index w up; index r 4", "");
}

#[test]
fn a_fingertip_far_below_the_board_keeps_the_key_down() {
    assert_events(
        BOARD,
        "index w up; index w 10; index w 60; index w 250; wait 50",
        "dn:W",
    );
}

#[test]
fn a_key_cannot_be_pressed_from_behind_or_from_the_side() {
    assert_events(BOARD, "index w 10; index w up; index w 10", "dn:W");
    assert_events(BOARD, "index w 10; index w 1; index w 3; index w 10", "");
    assert_events(
        BOARD,
        "index q -30 0 3; index q 3; index w 3; index e 3",
        "",
    );
}

#[test]
fn a_finger_that_starts_inside_a_key_has_to_leave_first() {
    assert_events(
        BOARD,
        "index w 3; wait 100; index w down; index w 1; index w 3",
        "",
    );
    assert_events(BOARD, "index w 3; index w up; index w 3", "dn:W");
}

#[test]
fn a_reset_cancels_presses_and_the_finger_has_to_leave_first() {
    assert_events(
        BOARD,
        "index w up; index w 3; reset; index w 1; index w 4; index w up; index w 3",
        "dn:W up:W dn:W",
    );
}

#[test]
fn a_reset_forgets_the_previous_position() {
    assert_events(BOARD, "index w up; reset & index w 3; index w 4", "");
}

#[test]
fn a_reacquired_hand_cancels_presses_and_presses_nothing() {
    assert_events(BOARD, "index w up; reacquire & index e 3; index e 4", "");
    assert_events(
        BOARD,
        "index w up; index w 3; reacquire & index w 3; index w 4; index w up; index w 3",
        "dn:W up:W dn:W",
    );
}

#[test]
fn an_untrusted_or_lost_finger_releases_its_key() {
    for (word, back) in [("doubt", "trust index"), ("hide", "index w 3")] {
        assert_eq!(
            simulate(
                BOARD,
                &format!("index w up; index w 3; wait 50; {word} index; wait 50")
            ),
            "t:18.889ms dn:W t:71.111ms up:W",
            "released in the second step of `{word}`"
        );
        let script =
            format!("index w up; index w 3; {word} index; wait 20; {back}; index w 4; index w up");
        assert_events(BOARD, &script, "dn:W up:W");
    }
    assert_events(BOARD, "index w up; doubt index & index w 3; index w up", "");
    // Another finger's doubt.
    assert_events(BOARD, "index w up; doubt middle & index w 3", "dn:W");
}

#[test]
fn a_position_that_is_not_finite_releases_the_key() {
    assert_events(
        BOARD,
        "index w up; index w 3; index w NaN; index w 3; index w up; index w 3",
        "dn:W up:W dn:W",
    );
    assert_events(BOARD, "index w up; index w inf; index w up", "");
}

#[test]
fn a_key_under_two_fingers_is_released_with_the_last() {
    assert_transcript(
        BOARD,
        "index w up & middle w 3 0 up; index w down; middle w 3 0 down; index w up; wait 20; middle w 3 0 up",
        "t:18ms dn:W t:45ms up:W",
    );
}

#[test]
fn rollover_keeps_the_order_of_the_fingers() {
    assert_events(
        BOARD,
        "index q up & middle w up & ring e up; index q down; middle w down; ring e down; index q \
         up; middle w up; ring e up",
        "dn:Q dn:W dn:E up:Q up:W up:E",
    );
    // The faster finger is there first.
    assert_events(
        BOARD,
        "index q up & middle w up; index q 3 & middle w 8",
        "dn:W dn:Q",
    );
}

#[test]
fn releases_precede_presses_within_a_step() {
    assert_transcript(
        BOARD,
        "index q up & middle w up; index q down; index q up & middle w 20",
        "t:18ms dn:Q t:5ms up:Q t:0.077ms dn:W",
    );
    // The press gets the time of the release.
    assert_transcript(
        BOARD,
        "index q up & middle w up; index q 20; index q -1 & middle w 20",
        "t:13.077ms dn:Q t:15.971ms up:Q dn:W",
    );
}

#[test]
fn a_hand_is_clear_if_no_finger_is_in_or_on_a_key() {
    let is_clear = |script: &str| {
        let mut rig = Rig::with_keys(BOARD);
        rig.run(script);
        rig.is_clear()
    };
    assert!(is_clear("index w up"));
    assert!(
        is_clear("index w up & thumb a 9.5 0 3"),
        "in the gap between two keys"
    );
    assert!(!is_clear("index w up & thumb s 0.5"), "rests inside");
    assert!(!is_clear("index w 50"), "poked through");
    assert!(is_clear("index w 105"), "the hand is under the board");
    assert!(
        !is_clear("index w up; index w down; index w 9.5 0 down"),
        "still on the key"
    );
    assert!(
        is_clear("index w up & doubt thumb & thumb s 0.5"),
        "a thumb that is not believed"
    );
    assert!(!is_clear("doubt index & index w up"), "no finger is seen");
    assert!(!is_clear("wait 10"), "no finger is there");
    assert!(!is_clear("index w NaN"), "not finite");
}

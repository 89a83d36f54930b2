//! Gestures over a board, script in, transcript out: contact stage and keyboard together.

mod keys;
mod options;
mod scenes;
mod taps;
mod walks;

use crate::rig::Rig;

/// Returns the events of a script on a keyboard in shorthand, with times.
fn simulate(keys: &str, script: &str) -> String {
    Rig::with_keys(keys).run(script).transcript()
}

/// Returns the events of a script on a keyboard in shorthand, without times.
fn simulate_keys(keys: &str, script: &str) -> String {
    Rig::with_keys(keys).run(script).events()
}

/// Returns a random number from `low` to `high`.
fn between(random: &mut fastrand::Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.f64()
}

const BOARD: &str = "q w e r / a s d f";

#[test]
fn a_tap_is_one_key_down_and_up() {
    assert_eq!(
        simulate(BOARD, "index w tap"),
        "t:18ms dn:W t:5ms up:W",
        "2 mm deep after 8 ms of the way in, 1 mm deep after 3 ms of the way out"
    );
}

#[test]
fn a_key_that_is_held_does_not_repeat() {
    assert_eq!(
        simulate(BOARD, "index w up; index w down; wait 80; index w up"),
        "t:18ms dn:W t:85ms up:W"
    );
    assert_eq!(
        simulate_keys(BOARD, "index w up; index w down; wait 2000"),
        "dn:W"
    );
}

#[test]
fn chatter_between_press_and_release_depth_is_one_press() {
    let chatter = "index w 2.1; index w 1.9; ".repeat(20);
    let script = format!("index w up; {chatter}; index w up");
    assert_eq!(simulate_keys(BOARD, &script), "dn:W up:W");
    let chatter = "index w 1.5; index w 0.2; ".repeat(20);
    let script = format!("index w up; {chatter}; index w up");
    assert_eq!(simulate_keys(BOARD, &script), "", "not deep enough");
}

#[test]
fn a_release_and_a_new_press_without_leaving_the_key_is_a_second_press() {
    assert_eq!(
        simulate_keys(
            BOARD,
            "index w up; index w 3; index w 0.5; index w 3; index w up"
        ),
        "dn:W up:W dn:W up:W"
    );
}

#[test]
fn sliding_off_lets_go_and_does_not_fire_the_neighbour() {
    let slide = "index w up; index w down; index e down; wait 50";
    assert_eq!(simulate_keys(BOARD, slide), "dn:W up:W");
    let and_back = format!("{slide}; index w down; index q 3; index w up");
    assert_eq!(simulate_keys(BOARD, &and_back), "dn:W up:W");
    let and_a_new_press = format!("{slide}; index e up; index e down");
    assert_eq!(simulate_keys(BOARD, &and_a_new_press), "dn:W up:W dn:E");
}

#[test]
fn a_tremble_at_the_edge_does_not_cancel() {
    let tremble = "index w 9.5 0 down; index w 7.5 0 down; ".repeat(10);
    let script = format!("index w 7.5 0 up; index w 7.5 0 down; {tremble}");
    assert_eq!(simulate_keys(BOARD, &script), "dn:W");
    assert_eq!(
        simulate_keys(BOARD, &format!("{script}; index w 10.5 0 down")),
        "dn:W up:W"
    );
}

#[test]
fn a_press_and_slide_within_one_frame_comes_up_again() {
    assert_eq!(
        simulate(BOARD, "index w up; index e 20"),
        "t:13.077ms dn:W t:2.186ms up:W",
        "2 mm deep at 8/26 of the way, 10 mm aside at 10/19"
    );
    assert_eq!(
        simulate_keys(BOARD, "index w up; index r 4"),
        "",
        "it is off the key before it is deep enough"
    );
}

#[test]
fn poking_through_keeps_the_key_down() {
    assert_eq!(
        simulate_keys(
            BOARD,
            "index w up; index w 10; index w 60; index w 250; wait 50"
        ),
        "dn:W"
    );
}

#[test]
fn nothing_is_pressed_from_behind_or_from_the_side() {
    assert_eq!(
        simulate_keys(BOARD, "index w 10; index w up; index w 10"),
        "dn:W"
    );
    assert_eq!(
        simulate_keys(BOARD, "index w 10; index w 1; index w 3; index w 10"),
        ""
    );
    assert_eq!(
        simulate_keys(BOARD, "index q -30 0 3; index q 3; index w 3; index e 3"),
        ""
    );
}

#[test]
fn a_finger_that_rests_inside_at_the_start_must_leave_first() {
    assert_eq!(
        simulate_keys(
            BOARD,
            "index w 3; wait 100; index w down; index w 1; index w 3"
        ),
        ""
    );
    assert_eq!(
        simulate_keys(BOARD, "index w 3; index w up; index w 3"),
        "dn:W"
    );
}

#[test]
fn a_reset_cancels_and_the_finger_must_leave_first() {
    assert_eq!(
        simulate_keys(
            BOARD,
            "index w up; index w 3; reset; index w 1; index w 4; index w up; index w 3"
        ),
        "dn:W up:W dn:W"
    );
}

#[test]
fn a_reset_forgets_where_the_finger_came_from() {
    assert_eq!(
        simulate_keys(BOARD, "index w up; reset & index w 3; index w 4"),
        ""
    );
}

#[test]
fn a_jump_cancels_and_presses_nothing_on_its_way() {
    assert_eq!(
        simulate_keys(BOARD, "index w up; reacquire & index e 3; index e 4"),
        ""
    );
    assert_eq!(
        simulate_keys(
            BOARD,
            "index w up; index w 3; reacquire & index w 3; index w 4; index w up; index w 3"
        ),
        "dn:W up:W dn:W"
    );
}

#[test]
fn a_finger_that_is_doubted_or_lost_lets_go() {
    for (word, back) in [("doubt", "trust index"), ("hide", "index w 3")] {
        assert_eq!(
            simulate(
                BOARD,
                &format!("index w up; index w 3; wait 50; {word} index; wait 50")
            ),
            "t:18.889ms dn:W t:61.111ms up:W",
            "in the frame in which it is {word}"
        );
        let script = format!("index w up; index w 3; {word} index; {back}; index w 4; index w up");
        assert_eq!(simulate_keys(BOARD, &script), "dn:W up:W");
    }
    assert_eq!(
        simulate_keys(BOARD, "index w up; doubt index & index w 3; index w up"),
        ""
    );
    assert_eq!(
        simulate_keys(BOARD, "index w up; doubt middle & index w 3"),
        "dn:W",
        "another finger's doubt"
    );
}

#[test]
fn numbers_that_are_not_finite_let_go() {
    assert_eq!(
        simulate_keys(
            BOARD,
            "index w up; index w 3; index w NaN; index w 3; index w up; index w 3"
        ),
        "dn:W up:W dn:W"
    );
    assert_eq!(
        simulate_keys(BOARD, "index w up; index w inf; index w up"),
        ""
    );
}

#[test]
fn two_fingers_on_one_key_hold_it_until_the_last_leaves() {
    assert_eq!(
        simulate(
            BOARD,
            "index w up & middle w 3 0 up; index w down; middle w 3 0 down; index w up; wait 20; middle w 3 0 up"
        ),
        "t:18ms dn:W t:45ms up:W"
    );
}

#[test]
fn rollover_keeps_the_order_of_the_fingers() {
    assert_eq!(
        simulate_keys(
            BOARD,
            "index q up & middle w up & ring e up; index q down; middle w down; ring e down; index q \
             up; middle w up; ring e up"
        ),
        "dn:Q dn:W dn:E up:Q up:W up:E"
    );
    assert_eq!(
        simulate_keys(BOARD, "index q up & middle w up; index q 3 & middle w 8"),
        "dn:W dn:Q",
        "the faster finger is there first"
    );
}

#[test]
fn in_one_frame_releases_go_before_presses() {
    assert_eq!(
        simulate(
            BOARD,
            "index q up & middle w up; index q down; index q up & middle w 20"
        ),
        "t:18ms dn:Q t:5ms up:Q t:0.077ms dn:W"
    );
    assert_eq!(
        simulate(
            BOARD,
            "index q up & middle w up; index q 20; index q -1 & middle w 20"
        ),
        "t:13.077ms dn:Q t:15.971ms up:Q dn:W",
        "the press is dated forward to the release"
    );
}

#[test]
fn a_hand_is_clear_when_no_finger_is_in_or_on_a_key() {
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

//! Keys that fire when a fingertip rests on them.

use super::{simulate, simulate_layout};
use crate::rig::Rig;

const KEYS: &str = r#"keys: [
    (code: "A", dwell_ms: 300, at_mm: (0, 0)), (code: "B", at_mm: (30, 0)),
    (code: "ShiftLeft", latch: OneShot, dwell_ms: 300, at_mm: (60, 0)),
]"#;

#[test]
fn a_key_fires_once_a_fingertip_has_rested_on_it() {
    assert_eq!(simulate(KEYS, "index A up; index A 1; wait 280"), "");
    assert_eq!(
        simulate(KEYS, "index A up; index A 1; wait 2000; index A up"),
        "dn:A up:A",
        "once for each contact"
    );
    assert_eq!(
        simulate(
            KEYS,
            "index A up; index A 1; wait 300; index A up; index A 1; wait 300"
        ),
        "dn:A up:A dn:A up:A"
    );
}

#[test]
fn it_fires_at_its_time_between_two_frames() {
    let mut rig = Rig::on_board(KEYS);
    rig.run("index A up; index A 4; wait 400");
    assert_eq!(rig.transcript(), "t:316ms dn:A up:A");
}

#[test]
fn a_fingertip_that_leaves_right_after_its_time_has_fired_the_key() {
    assert_eq!(
        simulate(KEYS, "index A up; index A 4; wait 290; index A -1"),
        "dn:A up:A"
    );
    assert_eq!(
        simulate(KEYS, "index A up; index A 4; wait 290; index A -16"),
        "",
        "it left before"
    );
}

#[test]
fn pressing_it_deep_is_no_second_time() {
    assert_eq!(
        simulate(
            KEYS,
            "index A up; index A down; wait 50; index A 1; index A down; wait 50; index A up"
        ),
        ""
    );
    assert_eq!(
        simulate(
            KEYS,
            "index A up; index A 1; index A down; wait 400; index A 1; index A down"
        ),
        "dn:A up:A"
    );
}

#[test]
fn leaving_sliding_off_and_losing_the_finger_fire_nothing() {
    for end in [
        "index A up",
        "index B 1",
        "hide index",
        "doubt index",
        "release",
    ] {
        let script = format!("index A up; index A 1; wait 250; {end}; wait 500");
        assert_eq!(simulate(KEYS, &script), "", "{end}");
    }
}

#[test]
fn two_fingers_each_have_their_time() {
    assert_eq!(
        simulate(
            KEYS,
            "index A up & thumb A 2 0 up; index A 1; wait 200; thumb A 2 0 1; index A up; wait 200"
        ),
        ""
    );
}

#[test]
fn a_one_shot_that_is_dwelled_on_is_for_the_next_key() {
    assert_eq!(
        simulate(
            KEYS,
            "index ShiftLeft up; index ShiftLeft 1; wait 320; index A up; index A 1; wait 320; index B tap"
        ),
        "dn:ShiftLeft dn:A up:A up:ShiftLeft dn:B up:B"
    );
}

#[test]
fn it_does_what_the_layer_says() {
    let keys = r#"keys: [(code: "A", dwell_ms: 300, at_mm: (0, 0)), (layer: "x", name: "L", at_mm: (30, 0))]"#;
    assert_eq!(
        simulate_layout(
            keys,
            r#"layers: [(name: "x", keys: {"A": "1"})]"#,
            "thumb L up & index A up; thumb L down; index A 1; wait 320"
        ),
        "dn:1 up:1"
    );
}

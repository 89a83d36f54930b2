//! Keys that fire when a fingertip rests on them.

use super::{assert_events, assert_layout_events, simulate};
use crate::rig::Rig;

const KEYS: &str = r#"keys: [
    (code: "A", dwell_ms: 300, at_mm: (0, 0)), (code: "B", at_mm: (30, 0)),
    (code: "ShiftLeft", latch: OneShot, dwell_ms: 300, at_mm: (60, 0)),
]"#;

#[test]
fn a_dwell_key_fires_once_per_contact() {
    assert_events(KEYS, "index A up; index A 1; wait 280", "");
    // Once per contact.
    assert_events(
        KEYS,
        "index A up; index A 1; wait 2000; index A up",
        "dn:A up:A",
    );
    assert_events(
        KEYS,
        "index A up; index A 1; wait 300; index A up; index A 1; wait 300",
        "dn:A up:A dn:A up:A",
    );
}

#[test]
fn a_dwell_fires_at_its_due_time_between_two_steps() {
    let mut rig = Rig::on_board(KEYS);
    rig.run("index A up; index A 4; wait 400");
    assert_eq!(rig.transcript(), "t:316ms dn:A up:A");
}

#[test]
fn a_fingertip_that_leaves_after_the_dwell_time_fires_the_key() {
    assert_events(
        KEYS,
        "index A up; index A 4; wait 290; index A -1",
        "dn:A up:A",
    );
    // It left before the dwell time.
    assert_events(KEYS, "index A up; index A 4; wait 290; index A -16", "");
}

#[test]
fn a_press_of_a_dwell_key_does_not_fire_it_again() {
    assert_events(
        KEYS,
        "index A up; index A down; wait 50; index A 1; index A down; wait 50; index A up",
        "",
    );
    assert_events(
        KEYS,
        "index A up; index A 1; index A down; wait 400; index A 1; index A down",
        "dn:A up:A",
    );
}

#[test]
fn a_dwell_that_ends_early_does_not_fire() {
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
fn a_dwell_does_not_fire_by_poses_of_the_other_hand() {
    let left = |end: &str| {
        let unseen = "index A up; index A 1; wait 250; right; index B up; wait 200";
        simulate(KEYS, &format!("left; {unseen}; left & index A {end}"))
    };
    assert_eq!(left("up"), "", "it may have left before the dwell time");
    assert_eq!(left("1"), "dn:A up:A", "it has stayed");
}

#[test]
fn each_finger_has_its_own_dwell_time() {
    assert_events(
        KEYS,
        "index A up & thumb A 2 0 up; index A 1; wait 200; thumb A 2 0 1; index A up; wait 200",
        "",
    );
}

#[test]
fn a_one_shot_fired_by_a_dwell_applies_to_the_next_key() {
    assert_events(
        KEYS,
        "index ShiftLeft up; index ShiftLeft 1; wait 320; index A up; index A 1; wait 320; index B tap",
        "dn:ShiftLeft dn:A up:A up:ShiftLeft dn:B up:B",
    );
}

#[test]
fn a_dwell_fires_the_action_of_the_active_layer() {
    let keys = r#"keys: [(code: "A", dwell_ms: 300, at_mm: (0, 0)), (layer: "x", name: "L", at_mm: (30, 0))]"#;
    assert_layout_events(
        keys,
        r#"layers: [(name: "x", keys: {"A": "1"})]"#,
        "thumb L up & index A up; thumb L down; index A 1; wait 320",
        "dn:1 up:1",
    );
}

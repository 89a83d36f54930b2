//! Chords: keys with another action when they are pressed together.

use super::{assert_layout_events, simulate_layout};
use crate::rig::Rig;

const KEYS: &str = r#"rows: [(at_mm: (0, 0), keys: "J K L A", pitch_mm: 30)],
    keys: [(name: "N", action: NoOp, at_mm: (0, 30)), (code: "F", hold: (code: "ShiftLeft"), at_mm: (30, 30))]"#;
const CHORDS: &str = r#"chords: [
    (keys: "J K", action: Key("Escape")), (keys: "J K L", action: Key("Tab")),
    (keys: "K L", action: Key("Enter")), (keys: "N J", action: Text("ñ")),
    (keys: "N K", action: Key("ShiftLeft"), latch: OneShot), (keys: "F L", action: Key("Home")),
]"#;
/// Each finger above its own key.
const OVER: &str = "index J up & middle K up & ring L up & little A up & thumb N up";

fn chords(script: &str) -> String {
    simulate_layout(KEYS, CHORDS, &format!("{OVER}; {script}"))
}

#[test]
fn keys_pressed_together_fire_their_chord() {
    assert_eq!(
        chords("index J down & middle K down; wait 60; index J up & middle K up"),
        "dn:Escape up:Escape"
    );
    assert_eq!(
        chords("index J down; wait 30; middle K down; wait 60; index J up & middle K up"),
        "dn:Escape up:Escape"
    );
}

#[test]
fn a_chord_key_acts_on_its_own_after_the_chord_time() {
    let mut rig = Rig::with_fields(KEYS, CHORDS);
    rig.run(&format!("{OVER}; index J down; wait 100; index J up"));
    assert_eq!(rig.transcript(), "t:68ms dn:J t:55ms up:J");
    assert_eq!(
        chords("index J down; wait 60; middle K down; wait 60; middle K up; index J up"),
        "dn:J dn:K up:K up:J",
        "after the chord time"
    );
}

#[test]
fn a_chord_waits_for_a_pose_of_the_hand_that_presses_its_keys() {
    let left = |middle: &str| {
        let unseen = "index J down; right; index A up; wait 100";
        let script = format!("left; {OVER}; {unseen}; left & {middle}; wait 60");
        simulate_layout(KEYS, CHORDS, &script)
    };
    assert_eq!(left("middle K 24"), "dn:Escape", "pressed while unseen");
    assert_eq!(left("middle K up"), "dn:J");
}

#[test]
fn a_chord_of_which_a_key_may_have_been_missed_in_a_gap_has_no_effect() {
    assert_eq!(chords("index J down; gap 100 & index J up"), "dn:J up:J");
    assert_eq!(chords("index J down; gap 160 & index J up"), "");
    assert_eq!(
        chords("index J down; wait 60; gap 160 & index J up"),
        "dn:J up:J",
        "it was pressed before"
    );
    assert_eq!(
        chords("index J down; gap 160 & index J up; index J tap"),
        "dn:J up:J"
    );
}

#[test]
fn a_short_tap_of_a_chord_key_taps_that_key() {
    assert_eq!(chords("index J tap"), "dn:J up:J");
}

#[test]
fn the_largest_chord_fires_without_waiting() {
    let mut rig = Rig::with_fields(KEYS, CHORDS);
    rig.run(&format!("{OVER}; index J down; middle K down; ring L down"));
    assert_eq!(rig.transcript(), "t:38ms dn:Tab");
}

#[test]
fn keys_outside_the_chord_act_on_their_own() {
    assert_eq!(
        chords(
            "index J down & thumb N down & ring L down; wait 60; index J up & ring L up & thumb N up"
        ),
        "write:ñ dn:L up:L"
    );
    assert_eq!(chords("thumb N down; wait 500; thumb N up"), "");
}

#[test]
fn a_chord_is_held_until_its_first_key_is_released() {
    assert_eq!(
        chords("index J down & middle K down; wait 500; middle K up; wait 500; index J up"),
        "dn:Escape up:Escape"
    );
    assert_eq!(
        chords(
            "index J down & middle K down; wait 100; middle K up; wait 100; middle K down; wait 60; middle K up"
        ),
        "dn:Escape up:Escape dn:K up:K",
        "the key that stays pressed does not act on its own"
    );
}

#[test]
fn a_key_that_outlasts_its_chord_ignores_presses_right_after_its_own_release() {
    for end in ["index J up", "hide index"] {
        let outlast = format!("index J down & middle K down; wait 60; {end}; wait 50; middle K up");
        let again = "middle K down; wait 60; middle K up";
        assert_eq!(
            chords(&format!("{outlast}; {again}")),
            "dn:Escape up:Escape",
            "{end}"
        );
        assert_eq!(
            chords(&format!("{outlast}; wait 50; {again}")),
            "dn:Escape up:Escape dn:K up:K",
            "{end}"
        );
    }
}

#[test]
fn another_key_ends_the_chord_time() {
    assert_eq!(
        chords(
            "index J down; little A down; middle K down; wait 60; index J up & little A up & middle K up"
        ),
        "dn:J dn:A dn:K up:J up:K up:A"
    );
}

#[test]
fn a_lost_finger_cancels_all_gathered_keys() {
    assert_eq!(
        chords("index J down & middle K down & ring L 1; hide middle; wait 200; index J up"),
        ""
    );
    assert_eq!(
        chords("index J down & middle K down; index A down; wait 200"),
        "",
        "a finger that slides off cancels them as well"
    );
}

#[test]
fn a_lost_finger_or_release_all_releases_a_chord() {
    for end in ["hide index", "doubt middle", "release", "index A down"] {
        assert_eq!(
            chords(&format!(
                "index J down & middle K down; wait 60; {end}; wait 200"
            )),
            "dn:Escape up:Escape",
            "{end}"
        );
    }
    assert_eq!(chords("index J down; release; wait 200; index J up"), "");
}

#[test]
fn a_second_finger_on_a_chord_key_is_ignored() {
    assert_eq!(
        chords(
            "index J down & thumb J up; thumb J down; wait 60; index J up; little A tap; thumb J up"
        ),
        "dn:J up:J dn:A up:A"
    );
}

#[test]
fn a_chord_can_be_a_one_shot() {
    assert_eq!(
        chords("thumb N down & middle K down; thumb N up & middle K up; little A tap"),
        "dn:ShiftLeft dn:A up:A up:ShiftLeft"
    );
}

#[test]
fn a_chord_key_can_be_a_tap_hold_key() {
    assert_eq!(
        chords("index F up; index F down; wait 400; little A tap; index F up"),
        "dn:ShiftLeft dn:A up:A up:ShiftLeft"
    );
    assert_eq!(chords("index F up; index F tap"), "dn:F up:F");
    assert_eq!(
        chords("index F up; index F down & ring L down; wait 400; index F up & ring L up"),
        "dn:Home up:Home"
    );
}

#[test]
fn a_chord_that_waits_for_its_hold_presses_nothing_once_a_finger_is_lost() {
    let keys = r#"rows: [(at_mm: (0, 0), keys: "J K", pitch_mm: 30)], keys: [(code: "A", at_mm: (0, 30))]"#;
    let chords = r#"chords: [(keys: "J K", action: Key("Escape"), hold: (code: "ShiftLeft"))]"#;
    let play = |end: &str| {
        let script = format!(
            "index J up & middle K up; index J down & middle K down; wait 60; {end}; wait 400"
        );
        simulate_layout(keys, chords, &script)
    };
    assert_eq!(play("index J up & middle K up"), "dn:Escape up:Escape");
    assert_eq!(
        play("wait 400; index J up & middle K up"),
        "dn:ShiftLeft up:ShiftLeft"
    );
    for end in ["hide index", "doubt middle", "index A down"] {
        assert_eq!(play(end), "", "{end}");
    }
}

#[test]
fn a_chord_is_in_the_layer_of_a_tap_hold_key_that_it_turns_into_a_hold() {
    let keys = r#"rows: [(at_mm: (0, 0), keys: "J K", pitch_mm: 30)],
        keys: [(code: "F", hold: (layer: "move"), at_mm: (0, 30))]"#;
    let script = "index J up & middle K up & thumb F up; thumb F down; \
                  index J down & middle K down; wait 60; index J up & middle K up; thumb F up";
    for in_base_layer in [r#"chords: [(keys: "J K", action: Key("Escape"))],"#, ""] {
        let in_layer = r#"layers: [(name: "move", chords: [(keys: "J K", action: Key("Home"))])]"#;
        let fields = format!("{in_base_layer} {in_layer}");
        assert_layout_events(keys, &fields, script, "dn:Home up:Home");
    }
}

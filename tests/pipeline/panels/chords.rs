//! Keys that do something else when they are pressed together.

use super::simulate_layout;
use crate::rig::Rig;

const KEYS: &str = r#"rows: [(at_mm: (0, 0), keys: "J K L A", pitch_mm: 30)],
    keys: [(name: "N", does: Nothing, at_mm: (0, 30)), (code: "F", hold: (code: "ShiftLeft"), at_mm: (30, 30))]"#;
const CHORDS: &str = r#"chords: [
    (keys: "J K", does: Key("Escape")), (keys: "J K L", does: Key("Tab")),
    (keys: "K L", does: Key("Enter")), (keys: "N J", does: Write("ñ")),
    (keys: "N K", does: Key("ShiftLeft"), latch: OneShot), (keys: "F L", does: Key("Home")),
]"#;
/// Over the keys, each finger over its own.
const OVER: &str = "index J up & middle K up & ring L up & little A up & thumb N up";

fn chords(script: &str) -> String {
    simulate_layout(KEYS, CHORDS, &format!("{OVER}; {script}"))
}

#[test]
fn keys_pressed_together_do_what_their_chord_does() {
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
fn a_key_of_chords_acts_on_its_own_after_its_time() {
    let mut rig = Rig::with_fields(KEYS, CHORDS);
    rig.run(&format!("{OVER}; index J down; wait 100; index J up"));
    assert_eq!(rig.transcript(), "t:68ms dn:J t:55ms up:J");
    assert_eq!(
        chords("index J down; wait 60; middle K down; wait 60; middle K up; index J up"),
        "dn:J dn:K up:K up:J",
        "too late for a chord"
    );
}

#[test]
fn a_short_tap_of_one_key_is_that_key() {
    assert_eq!(chords("index J tap"), "dn:J up:J");
}

#[test]
fn the_largest_chord_wins_and_needs_no_more_time() {
    let mut rig = Rig::with_fields(KEYS, CHORDS);
    rig.run(&format!("{OVER}; index J down; middle K down; ring L down"));
    assert_eq!(rig.transcript(), "t:38ms dn:Tab");
}

#[test]
fn what_is_in_no_chord_acts_on_its_own() {
    assert_eq!(
        chords(
            "index J down & thumb N down & ring L down; wait 60; index J up & ring L up & thumb N up"
        ),
        "write:ñ dn:L up:L"
    );
    assert_eq!(chords("thumb N down; wait 500; thumb N up"), "");
}

#[test]
fn a_chord_is_held_until_the_first_of_its_keys_is_let_go_of() {
    assert_eq!(
        chords("index J down & middle K down; wait 500; middle K up; wait 500; index J up"),
        "dn:Escape up:Escape"
    );
    assert_eq!(
        chords(
            "index J down & middle K down; wait 100; middle K up; wait 100; middle K down; wait 60; middle K up"
        ),
        "dn:Escape up:Escape dn:K up:K",
        "the other key stays out of it"
    );
}

#[test]
fn another_key_ends_the_wait() {
    assert_eq!(
        chords(
            "index J down; little A down; middle K down; wait 60; index J up & little A up & middle K up"
        ),
        "dn:J dn:A dn:K up:J up:K up:A"
    );
}

#[test]
fn a_finger_that_is_lost_takes_all_that_waits_back() {
    assert_eq!(
        chords("index J down & middle K down & ring L 1; hide middle; wait 200; index J up"),
        ""
    );
    assert_eq!(
        chords("index J down & middle K down; index A down; wait 200"),
        "",
        "nor does one that slides off leave the rest"
    );
}

#[test]
fn losing_a_finger_or_letting_go_of_everything_ends_a_chord() {
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
fn a_second_finger_on_a_key_is_no_second_key() {
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
fn a_key_of_chords_can_be_tapped_and_held_too() {
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

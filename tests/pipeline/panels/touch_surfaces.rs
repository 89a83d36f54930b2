//! Touchscreens and touchpads.

use super::{assert_events, simulate};
use crate::rig::Rig;

const SCREEN: &str =
    r#"touch_surfaces: [(name: "S", at_mm: (0, 0), size_mm: Box(160, 100), mode: Touchscreen)]"#;
const PAD: &str = r#"touch_surfaces: [(name: "P", at_mm: (0, 0), size_mm: Box(200, 200), mode: Touchpad,
    acceleration: 0)]"#;

#[test]
fn a_finger_on_a_touchscreen_moves_the_pointer_and_presses_the_button() {
    assert_events(
        SCREEN,
        "index S 40 25 up; index S 40 25 1; index S 40 25 down; index S 40 25 up",
        "place=0.7500,0.2500 dn:MouseLeft up:MouseLeft",
    );
    // The position is clamped at the edge.
    assert_events(
        SCREEN,
        "index S -72 -45 up; index S -72 -45 1; index S -81 -45 1",
        "place=0.0500,0.9500 place=0.0000,0.9500",
    );
}

#[test]
fn the_pointer_moves_before_the_button_is_pressed() {
    assert_events(
        SCREEN,
        "index S 0 0 up; index S 16 0 down; index S 32 0 down; index S 32 0 up",
        "place=0.5600,0.5000 place=0.5800,0.5000 dn:MouseLeft place=0.6000,0.5000 \
         place=0.7000,0.5000 up:MouseLeft",
    );
}

#[test]
fn only_the_first_finger_on_a_touchscreen_counts() {
    assert_events(
        SCREEN,
        "index S 0 0 up & ring S 40 0 up; index S 0 0 1; ring S 40 0 down; ring S 40 0 up; index S 0 0 up",
        "place=0.5000,0.5000",
    );
}

#[test]
fn a_drag_on_a_touchscreen_ends_when_the_finger_slides_off_or_is_lost() {
    for end in ["index S 90 0 down", "hide index", "doubt index", "release"] {
        assert_events(
            SCREEN,
            &format!("index S 72 0 up; index S 72 0 down; {end}; wait 100"),
            "place=0.9500,0.5000 dn:MouseLeft up:MouseLeft",
        );
    }
}

/// Returns a script that moves a finger over the touchpad in steps of `step` millimetres.
fn stroke(finger: &str, from: i32, to: i32, step: i32) -> String {
    let places = (0..=(to - from) / step).map(|number| from + number * step);
    let orders: Vec<String> = places.map(|x| format!("{finger} P {x} 0 1")).collect();
    orders.join("; ")
}

#[test]
fn a_finger_on_a_touchpad_moves_the_pointer_beyond_the_dead_zone() {
    let script = format!(
        "index P 0 0 up; {}; index P 20 0 up",
        stroke("index", 0, 20, 1)
    );
    let (x, y) = total(&simulate(PAD, &script), "move");
    assert!((17 * 4 - 1..=17 * 4).contains(&x) && y == 0, "{x} {y}");
    let events = simulate(
        PAD,
        "index P 0 0 up; index P 0 0 1; index P 0 -10.1 1; index P 0 -10.1 up",
    );
    assert_eq!(events, "move=+0,+28", "towards the wearer is down");
}

#[test]
fn slow_motion_on_a_touchpad_adds_up() {
    let steps: Vec<String> = (0..=300)
        .map(|tenth| format!("index P {} 0 1", f64::from(tenth) * 0.1))
        .collect();
    let script = format!("index P 0 0 up; {}; index P 30 0 up", steps.join("; "));
    let (x, _) = total(&simulate(PAD, &script), "move");
    assert!((27 * 4 - 1..=27 * 4).contains(&x), "{x}");
}

#[test]
fn a_fast_finger_moves_the_pointer_further() {
    let quick = PAD.replace("acceleration: 0", "acceleration: 2");
    let far = |step| {
        let script = format!("index P 0 0 up; {}", stroke("index", 0, 60, step));
        total(&simulate(&quick, &script), "move").0
    };
    let first = 2.0 * 4.0 * (1.0 + 2.0 * 200.0 / 250.0);
    assert_eq!(
        far(5),
        first as i32 + 55 * 4 * 3,
        "1 + 2 times as far from 250 mm/s on"
    );
    assert!(far(1) < 57 * 4 * 2, "100 mm/s: {}", far(1));
}

#[test]
fn a_short_touch_clicks_without_moving_the_pointer() {
    assert_events(
        PAD,
        "index P 0 0 up; index P 0 0 1; index P 2 0 1; index P 2 0 up",
        "dn:MouseLeft up:MouseLeft",
    );
    // Too long.
    assert_events(
        PAD,
        "index P 0 0 up; index P 0 0 1; wait 250; index P 0 0 up",
        "",
    );
    // Moved.
    assert_events(
        PAD,
        "index P 0 0 up; index P 0 0 1; index P 4.1 0 1; index P 4.1 0 up",
        "move=+4,+0",
    );
}

#[test]
fn a_finger_that_lifts_in_a_gap_does_not_click() {
    // It may have moved before it lifted.
    let lifted = |gap: &str| {
        let script = format!("index P 0 0 up; index P 0 0 1; {gap} & index P 10 0 up");
        simulate(PAD, &script)
    };
    assert_eq!(lifted("gap 100"), "dn:MouseLeft up:MouseLeft", "short");
    assert_eq!(lifted("gap 160"), "");
}

#[test]
fn two_fingers_click_the_right_button() {
    assert_events(
        PAD,
        "index P 0 0 up & middle P 30 0 up; index P 0 0 1 & middle P 30 0 1; wait 50; index P 0 0 \
         up; middle P 30 0 up",
        "dn:MouseRight up:MouseRight",
    );
}

#[test]
fn a_touch_soon_after_a_click_drags() {
    // The next touch does not drag.
    assert_events(
        PAD,
        "index P 0 0 tap; index P 0 0 1; index P 13.1 0 1; wait 100; index P 13.1 0 up; wait 100; \
         index P 0 0 up; index P 0 0 1; index P 13.1 0 1",
        "dn:MouseLeft up:MouseLeft dn:MouseLeft move=+40,+0 up:MouseLeft move=+40,+0",
    );
    // A double click.
    assert_events(
        PAD,
        "index P 0 0 tap; index P 0 0 tap",
        "dn:MouseLeft up:MouseLeft dn:MouseLeft up:MouseLeft",
    );
    // Too late.
    assert_events(
        PAD,
        "index P 0 0 tap; wait 400; index P 0 0 1; index P 13.1 0 1",
        "dn:MouseLeft up:MouseLeft move=+40,+0",
    );
}

#[test]
fn two_fingers_scroll() {
    let both = |x: i32, y: i32| format!("index P {x} {y} 1 & middle P {} {y} 1", x + 30);
    let script = format!(
        "index P 0 0 up & middle P 30 0 up; {}; {}; {}; index P 0 0 up; middle P 0 0 up",
        both(0, 0),
        both(0, 11),
        both(0, 19)
    );
    assert_events(PAD, &script, "scroll=+0,+120 scroll=+0,+120");
    let natural = PAD.replace(
        "acceleration: 0",
        "natural_scrolling: true, mm_per_detent: 16",
    );
    assert_events(&natural, &script, "scroll=+0,-60 scroll=+0,-60");
}

#[test]
fn the_last_of_two_fingers_does_not_move_the_pointer() {
    assert_events(
        PAD,
        "index P 0 0 up & middle P 30 0 up; index P 0 0 1 & middle P 30 0 1; index P 0 0 up; \
         middle P 60 0 1; middle P 60 0 up",
        "",
    );
}

#[test]
fn a_finger_that_slides_off_or_is_lost_does_not_click() {
    for end in ["index P 110 0 1", "hide index", "doubt index", "release"] {
        let events = simulate(
            PAD,
            &format!("index P 98 0 up; index P 98 0 1; {end}; wait 300"),
        );
        assert_eq!(events, "", "{end}");
    }
    // The remaining finger does not click either.
    assert_events(
        PAD,
        "index P 0 0 up & middle P 30 0 up; index P 0 0 1 & middle P 30 0 1; hide index; middle P 30 0 up",
        "",
    );
    // A drag ends.
    assert_events(
        PAD,
        "index P 0 0 tap; index P 0 0 1; index P 13.1 0 1; hide index; wait 20",
        "dn:MouseLeft up:MouseLeft dn:MouseLeft move=+40,+0 up:MouseLeft",
    );
}

#[test]
fn fingers_from_before_release_all_do_not_count() {
    // One finger, not two.
    assert_events(
        PAD,
        "index P 0 0 up; index P 0 0 1; release; middle P 30 0 tap",
        "dn:MouseLeft up:MouseLeft",
    );
    assert_events(
        SCREEN,
        "index S 0 0 up; index S 0 0 1; release; ring S 40 0 up; ring S 40 0 1",
        "place=0.5000,0.5000 place=0.7500,0.5000",
    );
}

#[test]
fn release_all_ends_a_drag() {
    let mut rig = Rig::on_board(PAD);
    rig.run("index P 0 0 tap; index P 0 0 1; index P 13.1 0 1; release; index P 30 0 1; index P 30 0 up");
    assert_eq!(
        rig.events(),
        "dn:MouseLeft up:MouseLeft dn:MouseLeft move=+40,+0 up:MouseLeft"
    );
}

/// Returns the sum of all motion of a kind.
fn total(events: &str, kind: &str) -> (i32, i32) {
    let motions = events
        .split(' ')
        .filter_map(|event| event.strip_prefix(kind)?.strip_prefix('='));
    motions.fold((0, 0), |sum, motion| {
        let (x, y) = motion.split_once(',').unwrap();
        (
            sum.0 + x.parse::<i32>().unwrap(),
            sum.1 + y.parse::<i32>().unwrap(),
        )
    })
}

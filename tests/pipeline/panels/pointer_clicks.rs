//! Clicks, drags and scrolling of a pointer.

use super::pointer_modes::pointer;

/// The wrist moves the cursor by 50 px per degree.
const WRIST: &str = r#"mode: Joint(
    x: (dof: "wrist-deviation", from_deg: -10, to_deg: 10),
    y: (dof: "wrist-flexion", from_deg: 10, to_deg: -10),
), output: Relative"#;
const PINCHES: &str = r#"clicks: [
    (gesture: Pinch("index"), action: Key("MouseLeft")),
    (gesture: Pinch("middle"), action: Key("MouseRight")),
]"#;
/// Fingers apart, wrist straight.
const OPEN: &str = "tip thumb 0 0 0 & tip index 80 0 0 & tip middle 0 80 0 & \
                    set wrist-deviation 0 & set wrist-flexion 0";

fn play(fields: &str, script: &str) -> String {
    let script = script.replace("open", OPEN);
    pointer(&format!("{WRIST}, {fields}")).run(&script).events()
}

#[track_caller]
fn assert_events(fields: &str, script: &str, expected: &str) {
    assert_eq!(play(fields, script), expected, "{script}");
}

#[test]
fn fingers_that_pinch_move_a_cursor_that_follows_their_tip_and_not_one_that_follows_the_knuckle() {
    // The index finger bends before the pinch is near, and the cursor may move from the first moment of a click.
    let script = "knuckle 0 0 0 & tip index 0 0 -80 & tip thumb -80 -20 -30; tip index 0 -30 -60; \
                  tip thumb -40 -30 -50; tip index 0 -40 -50 & tip thumb -10 -40 -50; tip thumb -40 -30 -50; \
                  tip index 0 0 -80 & tip thumb -80 -20 -30; wait 400";
    let events = |point: &str| {
        let mode = format!(
            "mode: Direct(point: {point}, pose: (anchor: world), size_mm: (200, 200, 400))"
        );
        let fields = format!("{mode}, output: Relative, drag_threshold_px: 0, {PINCHES}");
        pointer(&fields).run(script).events()
    };
    assert_eq!(events("Knuckle"), "dn:MouseLeft up:MouseLeft");
    let carried = events("Index");
    assert!(
        carried.contains("dn:MouseLeft") && carried.contains("move="),
        "{carried}"
    );
}

#[test]
fn a_pinch_is_a_button_with_hysteresis() {
    assert_events(
        PINCHES,
        "open; tip index 26 0 0; tip index 24 0 0; tip index 29 0 0; tip index 31 0 0",
        "dn:MouseLeft up:MouseLeft",
    );
    assert_events(
        PINCHES,
        "open; tip middle 20 0 0; open",
        "dn:MouseRight up:MouseRight",
    );
}

#[test]
fn only_the_finger_nearest_to_the_thumb_pinches() {
    assert_events(
        PINCHES,
        "open; tip index 15 0 0 & tip middle 0 20 0; tip middle 0 10 0; wait 100; open",
        "dn:MouseLeft up:MouseLeft",
    );
    // The other finger has to open before it counts.
    assert_events(
        PINCHES,
        "open; tip index 15 0 0 & tip middle 0 20 0; tip index 80 0 0; wait 100",
        "dn:MouseLeft up:MouseLeft",
    );
}

#[test]
fn the_pointer_is_held_while_a_click_is_near_or_on() {
    assert_events(
        PINCHES,
        "open; set wrist-deviation 1; tip index 40 0 0; set wrist-deviation 2; tip index 20 0 0; \
         set wrist-deviation 2.2; tip index 40 0 0; set wrist-deviation 3; tip index 80 0 0; set \
         wrist-deviation 4",
        "move=+50,+0 dn:MouseLeft up:MouseLeft move=+50,+0",
    );
}

#[test]
fn resting_fingers_close_together_hold_the_pointer_only_briefly() {
    assert_events(
        PINCHES,
        "open; tip index 40 0 0; wait 400; set wrist-deviation 1",
        "move=+50,+0",
    );
}

#[test]
fn a_drag_starts_beyond_the_drag_threshold() {
    assert_events(
        PINCHES,
        "open; tip index 20 0 0; set wrist-deviation 0.4; set wrist-deviation 0; set \
         wrist-deviation 0.7; set wrist-deviation 1.7; tip index 80 0 0",
        "dn:MouseLeft move=+50,+0 up:MouseLeft",
    );
}

#[test]
fn a_click_is_released_when_a_finger_or_the_hand_is_lost() {
    for lost in [
        "hide index",
        "doubt index",
        "hide thumb",
        "reacquire",
        "set wrist-flexion NaN",
        "release",
    ] {
        assert_eq!(
            play(
                PINCHES,
                &format!("open; tip index 20 0 0; {lost}; trust index & tip index 20 0 0; wait 50")
            ),
            "dn:MouseLeft up:MouseLeft",
            "{lost}, and it has to open before it presses again"
        );
    }
}

#[test]
fn a_flexion_clicks() {
    let bent =
        "clicks: [(gesture: Flexion(\"index-pip-flexion\", 60), action: Key(\"MouseLeft\"))]";
    let bend = |degrees: &str| {
        let orders = degrees
            .split(' ')
            .map(|it| format!("set index-pip-flexion {it}"));
        let script = orders.collect::<Vec<_>>().join("; ");
        play(bent, &format!("open; {script}"))
    };
    assert_eq!(bend("0 59 60 51 49"), "dn:MouseLeft up:MouseLeft");
    assert_eq!(bend("70 80"), "");
}

#[test]
fn a_push_forward_clicks_and_half_its_depth_ends_it() {
    let push = "clicks: [(gesture: Push(20), action: Key(\"MouseLeft\"))]";
    assert_events(
        push,
        "open; tip index 80 0 -10; tip index 80 0 -25; wait 200; tip index 80 0 -13; tip index 80 0 0",
        "dn:MouseLeft up:MouseLeft",
    );
    let slowly: Vec<String> = (0..40)
        .map(|step| format!("tip index 80 0 -{step}"))
        .collect();
    // 100 mm/s.
    assert_events(push, &format!("open; {}", slowly.join("; ")), "");
}

#[test]
fn sideways_motion_does_not_push_and_reaching_ends_a_push() {
    let push = "clicks: [(gesture: Push(20), action: Key(\"MouseLeft\"))]";
    let way = |x: i32, z: i32| {
        let step = |step: i32| format!("tip index {} 0 {}", 80 + x * step / 8, z * step / 8);
        (0..=8).map(step).collect::<Vec<_>>().join("; ")
    };
    // Aside.
    assert_events(push, &format!("open; {}; wait 2000", way(40, -60)), "");
    // Too far.
    assert_events(
        push,
        &format!("open; {}; wait 2000", way(0, -90)),
        "dn:MouseLeft up:MouseLeft",
    );
}

#[test]
fn a_push_that_missing_readings_hide_does_not_click() {
    let push = "clicks: [(gesture: Push(20), action: Key(\"MouseLeft\"))]";
    // The fingertip may have gone aside before it went forward.
    let hidden = "open; wait 100; gap 60 & tip index 85 0 -30; wait 200";
    assert_events(push, hidden, "");
    let seen =
        "tip index 85 0 -40; tip index 85 0 -55; wait 200; tip index 85 0 -43; tip index 85 0 -30";
    // After a rest.
    assert_events(
        push,
        &format!("{hidden}; {seen}"),
        "dn:MouseLeft up:MouseLeft",
    );
    let held =
        "open; tip index 80 0 -10; tip index 80 0 -25; gap 160 & tip index 80 0 -25; wait 100";
    assert_eq!(play(push, held), "dn:MouseLeft", "held in the gap");
}

#[test]
fn a_cursor_that_was_moved_and_rests_clicks_once() {
    let dwell = "dwell: (time_ms: 300, radius_px: 10, action: Key(\"MouseLeft\"))";
    // The wearer has not moved it there.
    assert_events(dwell, "open; wait 1000", "");
    // Once.
    assert_events(
        dwell,
        "open; set wrist-deviation 1; wait 200; set wrist-deviation 1.1; wait 2000",
        "move=+50,+0 move=+5,+0 dn:MouseLeft up:MouseLeft",
    );
    // It did not rest for long enough.
    assert_events(
        dwell,
        "open; set wrist-deviation 1; wait 200; set wrist-deviation 2; wait 200",
        "move=+50,+0 move=+50,+0",
    );
}

#[test]
fn a_cursor_that_rests_because_the_clutch_is_off_does_not_click() {
    let dwell = "dwell: (time_ms: 300, radius_px: 10, action: Key(\"MouseLeft\")), \
                 clutch: Flexion(\"ring-pip-flexion\", 60)";
    let after = |end: &str| {
        let start = "open & set ring-pip-flexion 0; set ring-pip-flexion 60; set wrist-deviation 1";
        play(dwell, &format!("{start}; {end}"))
    };
    assert_eq!(after("wait 1000"), "move=+50,+0 dn:MouseLeft up:MouseLeft");
    let released = "wait 100; set ring-pip-flexion 0; wait 1000";
    assert_eq!(after(released), "move=+50,+0");
    assert_eq!(
        after(&format!("{released}; set ring-pip-flexion 60; wait 1000")),
        "move=+50,+0",
        "the wearer has not moved it since"
    );
}

#[test]
fn motion_scrolls_while_the_scroll_gesture_is_on() {
    let scroll = "scroll: (gesture: Flexion(\"little-mcp-flexion\", 60), px_per_detent: 50)";
    assert_events(
        scroll,
        "open; set little-mcp-flexion 0; set little-mcp-flexion 60; set wrist-flexion -1; set \
         wrist-deviation 0.005; set wrist-deviation 0.01; set little-mcp-flexion 0; set \
         wrist-deviation 1.01",
        "scroll=+0,+60 scroll=+1,+0 move=+50,+0",
    );
}

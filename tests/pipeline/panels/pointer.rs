//! Cursor motion of a pointer.

use super::pointer_modes::pointer;
use crate::rig::Rig;

/// 5 pixels per millimetre; the center is at (0, 0, 0).
const BOX: &str = "mode: Direct(pose: (anchor: world), size_mm: (200, 100, 100))";

fn play(fields: &str, script: &str) -> String {
    pointer(&format!("{BOX}, {fields}")).run(script).events()
}

#[track_caller]
fn assert_events(fields: &str, script: &str, expected: &str) {
    assert_eq!(play(fields, script), expected, "{script}");
}

#[test]
fn a_relative_pointer_keeps_fractions_of_a_pixel() {
    assert_events(
        "output: Relative",
        "tip index 30 0 0; tip index 40 0 0; tip index 40 10 0",
        "move=+50,+0 move=+0,-50",
    );
    let crept = play(
        "output: Relative",
        "tip index 0 0 0; tip index 0.05 0 0; tip index 0.1 0 0; tip index 0.15 0 0; tip index \
             0.2 0 0; tip index 0.25 0 0; tip index 0.3 0 0; tip index 0.4 0 0",
    );
    assert_eq!(crept, "move=+1,+0 move=+1,+0");
}

#[test]
fn long_motion_is_split_into_steps_of_limited_length() {
    let stepped = play(
        "output: Relative, max_step_px: 101",
        "tip index 0 0 0; tip index 50 0 0; wait 50",
    );
    assert_eq!(stepped, "move=+100,+0 move=+100,+0 move=+50,+0");
    let placed = play(
        "max_step_px: 101",
        "tip index 0 0 0; tip index 50 0 0; wait 50",
    );
    assert_eq!(
        placed,
        "place=0.5000,0.5000 place=0.6000,0.5000 place=0.7000,0.5000 place=0.7500,0.5000"
    );
}

#[test]
fn a_reacquired_hand_does_not_move_the_mouse_and_is_followed_in_steps() {
    let script = "tip index 0 0 0; hide index; tip index 20 0 0; wait 50";
    assert_events("output: Relative", script, "");
    assert_events(
        "max_step_px: 51",
        script,
        "place=0.5000,0.5000 place=0.5500,0.5000 place=0.6000,0.5000",
    );
    let jump = "tip index 0 0 0; reacquire & tip index 20 0 0; wait 50";
    assert_events("output: Relative", jump, "");
}

#[test]
fn the_cursor_moves_only_while_the_clutch_is_on() {
    let clutched = "output: Relative, clutch: Flexion(\"ring-pip-flexion\", 60)";
    assert_events(
        clutched,
        "set ring-pip-flexion 0 & tip index 0 0 0; tip index 10 0 0; set ring-pip-flexion 60; tip \
         index 20 0 0; set ring-pip-flexion 55; tip index 30 0 0; set ring-pip-flexion 49; tip \
         index 0 0 0",
        "move=+50,+0 move=+50,+0",
    );
    // A clutch that is on at first has to be seen off.
    assert_events(
        clutched,
        "set ring-pip-flexion 60 & tip index 0 0 0; tip index 10 0 0",
        "",
    );
}

#[test]
fn the_offset_of_a_clutch_is_recovered_gradually() {
    let clutched = "clutch: Flexion(\"ring-pip-flexion\", 60)";
    // A fifth of the motion recovers the offset of 100 pixels.
    assert_events(
        clutched,
        "set ring-pip-flexion 0 & tip index 0 0 0; tip index 20 0 0; set ring-pip-flexion 60; tip \
         index 40 0 0; tip index 20 0 0",
        "place=0.5000,0.5000 place=0.6200,0.5000 place=0.5400,0.5000",
    );
}

#[test]
fn a_key_can_be_the_clutch_or_precision() {
    let on_board = |does: &str| {
        let layout = format!(
            "Layout(name: \"test\", boards: [(pose: (anchor: world, height_mm: -200), \
             keys: [(action: {does}, name: \"Hold\", at_mm: (0, 0))])], \
             pointer: Pointer(smoothing: Off, screen_px: (1001, 501), output: Relative, {BOX}))"
        );
        let script = "tip index 0 0 0; thumb Hold up; thumb Hold down; tip index 20 0 0; thumb Hold up; tip index 40 0 0";
        Rig::new(&layout).run(script).events()
    };
    assert_eq!(on_board("Clutch"), "move=+100,+0");
    assert_eq!(on_board("Precision"), "move=+25,+0 move=+100,+0");
}

#[test]
fn a_gesture_turns_precision_on() {
    let slow =
        "output: Relative, precision: Flexion(\"ring-pip-flexion\", 60), precision_factor: 0.1";
    assert_events(
        slow,
        "set ring-pip-flexion 0 & tip index 0 0 0; tip index 20 0 0; set ring-pip-flexion 60; tip \
         index 40 0 0",
        "move=+100,+0 move=+10,+0",
    );
}

#[test]
fn acceleration_depends_on_the_speed_of_the_hand() {
    let accelerated = "output: Relative, acceleration: [(1000, 0.5), (2000, 1), (10000, 2)]";
    // 1000, 2000 and 10000 px/s.
    assert_events(
        accelerated,
        "tip index 0 0 0; tip index 2 0 0; tip index 6 0 0; tip index 26 0 0",
        "move=+5,+0 move=+20,+0 move=+200,+0",
    );
}

#[test]
fn tremor_within_the_dead_zone_does_not_move_the_pointer() {
    let still = "dead_zone_px: 10";
    assert_events(
        still,
        "tip index 0 0 0; tip index 1.9 0 0; tip index -1.9 0 0; tip index 0 1.9 0",
        "place=0.5000,0.5000",
    );
    assert_events(
        still,
        "tip index 0 0 0; tip index 22 0 0",
        "place=0.5000,0.5000 place=0.6000,0.5000",
    );
}

#[test]
fn the_first_or_the_configured_hand_points() {
    let script = "right; tip index 0 0 0; left; tip index 20 0 0; wait 50";
    assert_events("max_step_px: 1000", script, "place=0.5000,0.5000");
    assert_events(
        "max_step_px: 1000",
        &format!("{script}; release; wait 20"),
        "place=0.5000,0.5000 place=0.6000,0.5000",
    );
    assert_events("hand: \"left\"", script, "place=0.6000,0.5000");
}

//! Targets in space.

use crate::rig::Rig;

const SCENE: &str = r#"spaces: [(pose: (anchor: elbow), targets: [
    (name: "Sun", at_mm: (0, 0, -300), shape: Ball(100)),
    (name: "Moon", at_mm: (80, 0, -300), shape: Ball(100)),
    (name: "Door", at_mm: (300, 0, -300), shape: Box(20, 100, 100), action: Key("A")),
])]"#;

fn play(fields: &str, script: &str) -> String {
    Rig::new(&format!("Layout(name: \"test\", {fields})"))
        .run(script)
        .events()
}

#[track_caller]
fn assert_events(fields: &str, script: &str, expected: &str) {
    assert_eq!(play(fields, script), expected, "{script}");
}

#[test]
fn a_target_is_selected_while_the_fingertip_is_inside() {
    assert_events(
        SCENE,
        "tip index -100 0 -300; tip index -25 0 -300; tip index 0 0 -300; tip index 0 0 -200",
        "select:Sun depth:Sun=0.500 depth:Sun=1.000 depth:Sun=0.000 unselect:Sun",
    );
}

#[test]
fn a_target_stays_selected_within_the_tremor_margin() {
    let edge =
        |x: &str| format!("tip index -100 0 -300; tip index -49 0 -300; tip index {x} 0 -300");
    assert_events(
        SCENE,
        &edge("-51"),
        "select:Sun depth:Sun=0.020 depth:Sun=0.000",
    );
    assert_events(
        SCENE,
        &edge("-53"),
        "select:Sun depth:Sun=0.020 depth:Sun=0.000 unselect:Sun",
    );
}

#[test]
fn the_nearest_center_of_overlapping_targets_is_selected() {
    assert_events(
        SCENE,
        "tip index -100 0 -300; tip index 35 0 -300; tip index 40.5 0 -300; tip index 45 0 -300",
        "select:Sun depth:Sun=0.300 depth:Sun=0.190 depth:Sun=0.000 unselect:Sun select:Moon depth:Moon=0.300",
    );
}

#[test]
fn a_fast_fingertip_does_not_tunnel_and_event_times_are_interpolated() {
    let mut rig = Rig::new(&format!("Layout(name: \"test\", {SCENE})"));
    rig.run("tip index 250 0 -300; tip index 350 0 -300");
    assert_eq!(
        rig.transcript(),
        "t:14ms select:Door dn:A t:2.2ms up:A unselect:Door"
    );
}

#[test]
fn the_action_of_a_target_is_released_when_the_finger_is_lost() {
    for lost in ["hide index", "doubt index", "reacquire", "release"] {
        assert_events(
            SCENE,
            &format!("tip index 250 0 -300; tip index 300 0 -300; {lost}; wait 50"),
            "select:Door dn:A depth:Door=1.000 up:A depth:Door=0.000 unselect:Door",
        );
    }
}

#[test]
fn a_fingertip_that_appears_inside_a_target_has_to_leave_all_targets_first() {
    assert_events(SCENE, "tip index 0 0 -300; tip index 80 0 -300", "");
    assert_events(
        SCENE,
        "tip index 0 0 -300; tip index 0 200 -300; tip index 0 0 -300",
        "select:Sun depth:Sun=1.000",
    );
}

#[test]
fn joint_pointing_selects_in_every_space() {
    let joint = r#"pointer: Pointer(smoothing: Off, output: Off, mode: Joint(
        x: (dof: "wrist-deviation", from_deg: -10, to_deg: 10, extent_mm: 400),
        y: (dof: "wrist-flexion", from_deg: 10, to_deg: -10, extent_mm: 400),
        z: (dof: "elbow-flexion", from_deg: 0, to_deg: 90, extent_mm: 400),
    )), spaces: [(pose: (anchor: wrist, height_mm: 77), targets: [
        (name: "Near", at_mm: (0, 0, 200), shape: Ball(100)),
    ])]"#;
    assert_events(
        joint,
        "set wrist-deviation 0 & set wrist-flexion 0 & set elbow-flexion 45; set elbow-flexion 90",
        "select:Near depth:Near=1.000",
    );
}

#[test]
fn a_fingertip_selects_no_target_in_a_gap() {
    let through = "tip index 250 0 -300; gap 160 & tip index 350 0 -300; wait 50";
    assert_eq!(play(SCENE, through), "", "on the straight line");
    let into = "tip index 250 0 -300; gap 160 & tip index 300 0 -300; wait 50";
    assert_eq!(play(SCENE, into), "", "at its end");
    // After it has left.
    assert_events(
        SCENE,
        &format!("{into}; tip index 350 0 -300; tip index 300 0 -300"),
        "select:Door dn:A depth:Door=1.000",
    );
    let held = "tip index 250 0 -300; tip index 300 0 -300; gap 160 & tip index 300 0 -300";
    assert_events(SCENE, held, "select:Door dn:A depth:Door=1.000");
    // To another target.
    assert_events(
        SCENE,
        &format!("{held}; wait 50; gap 160 & tip index 0 0 -300; wait 50"),
        "select:Door dn:A depth:Door=1.000 up:A depth:Door=0.000 unselect:Door",
    );
}

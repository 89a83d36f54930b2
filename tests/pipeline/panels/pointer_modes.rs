//! What the modes of a pointer make of a hand.

use crate::rig::Rig;

/// The fields of a pointer without smoothing, on a screen of 1001 × 501 pixels.
pub fn pointer(fields: &str) -> Rig {
    Rig::new(&format!(
        "Layout(name: \"test\", pointer: Pointer(smoothing: Off, screen_px: (1001, 501), {fields}))"
    ))
}

const JOINT: &str = r#"mode: Joint(
    x: (dof: "wrist-deviation", from_deg: -10, to_deg: 10),
    y: (dof: "wrist-flexion", from_deg: 30, to_deg: -30),
)"#;
const DIRECT: &str = r#"mode: Direct(
    place: (anchor: elbow, forward_mm: 300), size_mm: (200, 100, 100),
)"#;
const RAY: &str =
    r#"mode: Ray(from: Index, place: (anchor: world, forward_mm: 500), size_mm: (200, 100))"#;
const RATE: &str = r#"mode: Rate(
    of: Tip(place: (anchor: world), full_mm: 100), dead_share: 0.2, top_px_s: 1000,
), max_step_px: 20"#;

fn play(fields: &str, script: &str) -> String {
    pointer(fields).run(script).events()
}

#[test]
fn angles_are_places_along_a_line_and_stay_within_the_screen() {
    assert_eq!(
        play(
            JOINT,
            "set wrist-deviation 0; set wrist-flexion 0; set wrist-deviation 5; set wrist-flexion -15"
        ),
        "place=0.5000,0.5000 place=0.7500,0.5000 place=0.7500,0.2500",
        "nothing before both are known"
    );
    let far = "set wrist-deviation 90 & set wrist-flexion 90; wait 50";
    assert_eq!(play(JOINT, far), "place=1.0000,1.0000");
}

#[test]
fn a_curve_makes_the_middle_finer_and_leaves_the_ends() {
    let curved = JOINT.replace("to_deg: 10", "to_deg: 10, curve: 2");
    let at = |degrees: &str| {
        play(
            &curved,
            &format!("set wrist-flexion 0 & set wrist-deviation {degrees}"),
        )
    };
    assert_eq!(at("5"), "place=0.6250,0.5000");
    assert_eq!(at("-5"), "place=0.3750,0.5000");
    assert_eq!(at("10"), "place=1.0000,0.5000");
}

#[test]
fn the_fingertip_in_the_box_is_the_place_on_the_screen() {
    assert_eq!(
        play(DIRECT, "tip index 0 0 -300; tip index 50 25 -300"),
        "place=0.5000,0.5000 place=0.7500,0.2500"
    );
    assert_eq!(play(DIRECT, "tip index 900 900 900"), "place=1.0000,0.0000");
}

#[test]
fn a_box_that_bears_to_the_right_is_seen_from_its_front() {
    let right = DIRECT.replace("forward_mm", "bearing_deg: 90, forward_mm");
    assert_eq!(
        play(&right, "tip index 300 0 0; tip index 300 0 50"),
        "place=0.5000,0.5000 place=0.7500,0.5000"
    );
}

#[test]
fn depth_drives_what_it_is_told_to() {
    let driven = format!("{DIRECT}, moves: Nothing, z_drives: Axis(\"MoveZ\")");
    assert_eq!(
        play(
            &driven,
            "tip index 0 0 -300; tip index 0 0 -275; hide index"
        ),
        "value:pointer=0.750 axis:MoveZ=+0.500 axis:MoveZ=+0.000"
    );
}

#[test]
fn a_ray_meets_the_plane_where_the_hand_points() {
    let knuckle = "knuckle 0 0 0 & tip index 0 0 -100";
    assert_eq!(
        play(RAY, &format!("{knuckle}; tip index 10 0 -100")),
        "place=0.5000,0.5000 place=0.7500,0.5000",
        "10 mm in 100 are 50 in 500"
    );
    assert_eq!(
        play(
            RAY,
            &format!("{knuckle}; tip index 0 0 100; tip index 100 0 0")
        ),
        "place=0.5000,0.5000",
        "away from the plane, and along it, it points nowhere"
    );
}

#[test]
fn displacement_is_speed_beyond_the_dead_zone() {
    assert_eq!(play(RATE, "tip index 19 0 0; wait 100"), "");
    // (0.6 − 0.2) / 0.8 of 1000 px/s, 10 ms a frame.
    assert_eq!(
        play(RATE, "tip index 0 0 0; tip index 60 0 0; tip index 0 -60 0"),
        "move=+5,+0 move=+0,+5"
    );
    assert_eq!(
        play(RATE, "tip index 0 0 0; tip index 900 0 0; wait 10"),
        "move=+10,+0 move=+10,+0"
    );
}

#[test]
fn a_slow_rate_adds_up() {
    // 0.05 / 0.8 of 1000 px/s: 62.5 px in a second.
    let crept = play(RATE, "tip index 25 0 0; wait 1000");
    let moves = crept.split(' ').collect::<Vec<_>>();
    assert_eq!(moves.len(), 62);
    assert!(moves.iter().all(|&step| step == "move=+1,+0"), "{crept}");
}

#[test]
fn a_finger_in_doubt_moves_nothing() {
    for fields in [DIRECT, RATE] {
        assert_eq!(
            play(fields, "doubt index & tip index 60 0 -300; wait 50"),
            ""
        );
    }
}

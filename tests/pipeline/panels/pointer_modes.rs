//! The pointing modes.

use crate::rig::Rig;

/// Returns a rig with a pointer with these fields, without smoothing, on a screen of 1001 × 501 pixels.
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
    pose: (anchor: elbow, forward_mm: 300), size_mm: (200, 100, 100),
)"#;
const RAY: &str =
    r#"mode: Ray(origin: Index, pose: (anchor: world, forward_mm: 500), size_mm: (200, 100))"#;
const RATE: &str = r#"mode: Rate(
    input: Fingertip(pose: (anchor: world), full_mm: 100), dead_zone: 0.2, max_px_per_s: 1000,
), max_step_px: 20"#;

fn play(fields: &str, script: &str) -> String {
    pointer(fields).run(script).events()
}

#[track_caller]
fn assert_events(fields: &str, script: &str, expected: &str) {
    assert_eq!(play(fields, script), expected, "{script}");
}

#[test]
fn joint_angles_map_linearly_to_the_screen_and_are_clamped() {
    // No position before both angles are known.
    assert_events(
        JOINT,
        "set wrist-deviation 0; set wrist-flexion 0; set wrist-deviation 5; set wrist-flexion -15",
        "place=0.5000,0.5000 place=0.7500,0.5000 place=0.7500,0.2500",
    );
    let far = "set wrist-deviation 90 & set wrist-flexion 90; wait 50";
    assert_events(JOINT, far, "place=1.0000,1.0000");
}

#[test]
fn a_curve_above_1_is_finer_in_the_middle() {
    let curved = JOINT.replace("to_deg: 10", "to_deg: 10, exponent: 2");
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
fn the_fingertip_in_the_box_is_the_position_on_the_screen() {
    assert_events(
        DIRECT,
        "tip index 0 0 -300; tip index 50 25 -300",
        "place=0.5000,0.5000 place=0.7500,0.2500",
    );
    assert_events(DIRECT, "tip index 900 900 900", "place=1.0000,0.0000");
}

#[test]
fn the_knuckle_or_the_wrist_in_the_box_is_the_position_on_the_screen_wherever_the_fingertip_is() {
    let follow = |point: &str| DIRECT.replace("Direct(", &format!("Direct(point: {point},"));
    let script = "knuckle 0 0 -300 & tip index 0 0 -380; tip index 0 -50 -330; hide index; knuckle 50 25 -300";
    assert_events(
        &follow("Knuckle"),
        script,
        "place=0.5000,0.5000 place=0.7500,0.2500",
    );
    assert_events(&follow("Wrist"), script, "place=0.5000,0.5000");
    assert_events(&follow("Knuckle"), "tip index 0 0 -300", "");
}

#[test]
fn the_knuckle_moves_the_pointer_while_one_finger_is_untrusted_and_not_while_all_are() {
    let knuckle = DIRECT.replace("Direct(", "Direct(point: Knuckle,");
    let one = "knuckle 0 0 -300; doubt index & knuckle 50 25 -300";
    assert_events(&knuckle, one, "place=0.5000,0.5000 place=0.7500,0.2500");
    let all = "doubt thumb & doubt index & doubt middle & doubt ring & doubt little";
    let lost = format!("knuckle 0 0 -300; {all} & knuckle 50 25 -300; wait 50");
    assert_events(&knuckle, &lost, "place=0.5000,0.5000");
}

#[test]
fn a_box_with_a_bearing_is_seen_from_its_front() {
    let right = DIRECT.replace("forward_mm", "bearing_deg: 90, forward_mm");
    assert_events(
        &right,
        "tip index 300 0 0; tip index 300 0 50",
        "place=0.5000,0.5000 place=0.7500,0.5000",
    );
}

#[test]
fn the_third_axis_drives_its_output() {
    let driven = format!("{DIRECT}, output: Off, z_output: Axis(\"MoveZ\")");
    assert_events(
        &driven,
        "tip index 0 0 -300; tip index 0 0 -275; hide index",
        "value:pointer=0.750 axis:MoveZ=+0.500 axis:MoveZ=+0.000",
    );
}

#[test]
fn a_ray_intersects_the_plane_where_the_hand_points() {
    let knuckle = "knuckle 0 0 0 & tip index 0 0 -100";
    // 10 mm at a distance of 100 mm are 50 mm at 500 mm.
    assert_events(
        RAY,
        &format!("{knuckle}; tip index 10 0 -100"),
        "place=0.5000,0.5000 place=0.7500,0.5000",
    );
    // A hand that points away from the plane or along it points nowhere.
    assert_events(
        RAY,
        &format!("{knuckle}; tip index 0 0 100; tip index 100 0 0"),
        "place=0.5000,0.5000",
    );
}

#[test]
fn rate_control_maps_displacement_to_speed() {
    assert_events(RATE, "tip index 19 0 0; wait 100", "");
    // (0.6 − 0.2) / 0.8 of 1000 px/s, 10 ms per step.
    assert_events(
        RATE,
        "tip index 0 0 0; tip index 60 0 0; tip index 0 -60 0",
        "move=+5,+0 move=+0,+5",
    );
    assert_events(
        RATE,
        "tip index 0 0 0; tip index 900 0 0; wait 10",
        "move=+10,+0 move=+10,+0",
    );
}

#[test]
fn fractions_of_a_pixel_add_up_at_a_slow_rate() {
    // 0.05 / 0.8 of 1000 px/s: 62.5 px per second.
    let crept = play(RATE, "tip index 25 0 0; wait 1000");
    let moves = crept.split(' ').collect::<Vec<_>>();
    assert_eq!(moves.len(), 62);
    assert!(moves.iter().all(|&step| step == "move=+1,+0"), "{crept}");
}

#[test]
fn an_untrusted_finger_does_not_move_the_pointer() {
    for fields in [DIRECT, RATE] {
        assert_events(fields, "doubt index & tip index 60 0 -300; wait 50", "");
    }
}

//! The arm as a joystick: postures in, axes out.

use ademan::device::{
    Axis, Capability, DeviceInput, DeviceOutput, EventKind, Events, KeyArbiter, TimedCommands,
};
use ademan::estimate::JointAngles;
use ademan::hand::{Dof, Finger, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::layout::Layout;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Rot3, Vec3};

/// Joints of a flat right hand that points straight forward, relative to its wrist, in metres.
const JOINTS: [(Joint, Vec3); 3] = [
    (Joint::IndexPhalanxProximal, Vec3::new(-0.02, 0.0, -0.08)),
    (Joint::LittlePhalanxProximal, Vec3::new(0.02, 0.0, -0.08)),
    (Joint::Wrist, Vec3::ZERO),
];
const INDEX_TIP: Vec3 = Vec3::new(-0.02, 0.0, -0.16);

const AXES: &str = r#"(axis: "MoveX", motion: Right(100)), (axis: "MoveY", motion: Forward(100)),
    (axis: "MoveZ", motion: Up(100)), (axis: "TurnX", motion: Pitch(45)), (axis: "TurnY", motion: Roll(45)),
    (axis: "TurnZ", motion: Yaw(-45)), (axis: "RightTrigger", motion: Up(100))"#;

fn layout(mode: &str) -> String {
    format!(
        "Layout(name: \"t\", pointer: Pointer(mode: Arm({mode}), clutch: Flexion(\"ring-mcp-flexion\", 50)))"
    )
}

/// Returns the pose of a hand whose wrist is at a position, turned about it, with the finger displaced.
fn pose(time: u64, side: Side, (wrist, turn): (Vec3, Rot3), finger: Vec3) -> HandPose {
    let mut pose = HandPose::new(Timestamp(time), side, 0.005);
    let mirror = match side {
        Side::Right => Vec3::ONE,
        Side::Left => Vec3::new(-1.0, 1.0, 1.0),
    };
    let at = |point: Vec3| Pose::from_parts(wrist + turn * (point * mirror), turn);
    for (joint, point) in JOINTS {
        pose.set(joint, at(point));
    }
    pose.set(Joint::tip(Finger::Index), at(INDEX_TIP + finger));
    pose
}

/// Plays a straight hand at rest, the same with the clutch held, and a hand that has moved; returns the axes off zero.
fn play(mode: &str, side: Side, moved: (Vec3, Rot3), finger: Vec3) -> Vec<(Axis, f32)> {
    let [before, _] = play_until_jump(mode, side, moved, finger);
    before
}

/// Plays as [`play`] does, and then a hand that jumps. Returns the axes before and in that step.
fn play_until_jump(
    mode: &str,
    side: Side,
    moved: (Vec3, Rot3),
    finger: Vec3,
) -> [Vec<(Axis, f32)>; 2] {
    let layout = Layout::parse(&layout(mode), "t.ron").unwrap_or_else(|error| panic!("{error}"));
    let mut devices = layout.devices();
    let (mut events, mut commands) = (Events::new(), TimedCommands::new());
    let mut arbiter = KeyArbiter::default();
    let start = (Vec3::new(0.2, 0.1, -0.3), Rot3::from_rotation_y(0.4));
    let (by, turn) = moved;
    let end = (start.0 + by, start.1 * turn);
    let steps = [
        (start, Vec3::ZERO, 0.0),
        (start, Vec3::ZERO, 60.0),
        (end, finger, 60.0),
        (end, finger, 60.0),
    ];
    let last = steps.len() - 1;
    let mut before_jump = 0;
    for (index, (place, fingertip, ring)) in steps.into_iter().enumerate() {
        let mut angles = JointAngles::default();
        angles.set(Dof::RingMcpFlexion, f64::to_radians(ring));
        let mut pose = pose(index as u64 * 10_000, side, place, fingertip);
        if index == last {
            before_jump = events.len();
            pose.jumped = true;
        }
        let input = DeviceInput {
            scene: &layout.scene,
            bends: &Default::default(),
            inputs: &Default::default(),
            touches: &[],
            presses: &[],
            pose: &pose,
            angles: &angles,
        };
        for device in &mut devices {
            let mut out = DeviceOutput {
                events: &mut events,
                commands: &mut commands,
                arbiter: &mut arbiter,
            };
            device.update(&input, &mut out);
        }
    }
    let axis = |kind| match kind {
        EventKind::Axis(axis, value) => (axis, value),
        other => panic!("{other:?}"),
    };
    let axes: Vec<_> = events.iter().map(|event| axis(event.kind)).collect();
    let (before, after) = axes.split_at(before_jump);
    [before.to_vec(), after.to_vec()]
}

fn axes(moved: (Vec3, Rot3)) -> Vec<(Axis, f32)> {
    play(
        &format!("point: Wrist, axes: [{AXES}], dead_zone: 0"),
        Side::Right,
        moved,
        Vec3::ZERO,
    )
}

fn about(axis: Vec3, degrees: f32) -> (Vec3, Rot3) {
    (
        Vec3::ZERO,
        Rot3::from_axis_angle(axis, degrees.to_radians()),
    )
}

#[test]
fn each_motion_deflects_its_own_axis_and_no_other() {
    let by = |x, y, z| (Vec3::new(x, y, z), Rot3::IDENTITY);
    let cases = [
        (by(0.05, 0.0, 0.0), vec![(Axis::MoveX, 0.5)]),
        (by(-0.3, 0.0, 0.0), vec![(Axis::MoveX, -1.0)]),
        (by(0.0, 0.0, -0.025), vec![(Axis::MoveY, 0.25)]),
        (
            by(0.0, 0.05, 0.0),
            vec![(Axis::MoveZ, 0.5), (Axis::RightTrigger, 0.5)],
        ),
        (by(0.0, -0.05, 0.0), vec![(Axis::MoveZ, -0.5)]),
        // About the axes of the hand, which points 23° to the left.
        (about(Vec3::X, 22.5), vec![(Axis::TurnX, 0.5)]),
        (about(Vec3::NEG_Z, 22.5), vec![(Axis::TurnY, 0.5)]),
        (about(Vec3::Y, 22.5), vec![(Axis::TurnZ, -0.5)]),
        (about(Vec3::X, 90.0), vec![(Axis::TurnX, 1.0)]),
    ];
    for (moved, expected) in cases {
        assert_eq!(axes(moved), expected, "{moved:?}");
    }
}

#[test]
fn a_motion_may_deflect_every_axis() {
    let written = |axis: &Axis| format!("(axis: \"{axis}\", motion: Up(100))");
    let all: Vec<_> = Axis::ALL.iter().map(written).collect();
    let mode = format!("point: Wrist, axes: [{}], dead_zone: 0", all.join(", "));
    let up = (Vec3::Y * 0.05, Rot3::IDENTITY);
    let moved = play(&mode, Side::Right, up, Vec3::ZERO);
    let expected: Vec<_> = Axis::ALL.iter().map(|axis| (*axis, 0.5)).collect();
    assert_eq!(moved, expected);
}

#[test]
fn the_axes_are_centered_when_the_hand_jumps() {
    let mode = format!("point: Wrist, axes: [{AXES}], dead_zone: 0");
    let up = (Vec3::new(0.0, 0.05, 0.0), Rot3::IDENTITY);
    let [moved, jumped] = play_until_jump(&mode, Side::Right, up, Vec3::ZERO);
    assert!(!moved.is_empty());
    let centered: Vec<_> = moved.iter().map(|&(axis, _)| (axis, 0.0)).collect();
    assert_eq!(jumped, centered);
}

#[test]
fn a_left_hand_moves_and_turns_in_the_same_directions() {
    let mode = format!("point: Wrist, axes: [{AXES}], dead_zone: 0");
    let play = |moved| play(&mode, Side::Left, moved, Vec3::ZERO);
    let right = (Vec3::X * 0.05, Rot3::IDENTITY);
    assert_eq!(play(right), [(Axis::MoveX, 0.5)]);
    assert_eq!(play(about(Vec3::NEG_Z, 22.5)), [(Axis::TurnY, 0.5)]);
}

#[test]
fn the_index_finger_moves_the_axes_and_a_turn_of_the_hand_does_not() {
    let mode = format!("point: Index, axes: [{AXES}], dead_zone: 0.05");
    let play = |moved, finger| play(&mode, Side::Right, moved, finger);
    let turned = play(about(Vec3::X, 30.0), Vec3::ZERO);
    assert_eq!(turned.len(), 1, "{turned:?}");
    assert_eq!(turned[0].0, Axis::TurnX);
    let bent = play((Vec3::ZERO, Rot3::IDENTITY), Vec3::Y * -0.05);
    assert_eq!(bent, [(Axis::MoveZ, -0.474)]);
}

#[test]
fn the_index_knuckle_moves_the_axes_and_its_finger_does_not() {
    let mode = format!("point: Knuckle, axes: [{AXES}], dead_zone: 0.05");
    let play = |by, finger| play(&mode, Side::Right, (by, Rot3::IDENTITY), finger);
    let bent = play(Vec3::ZERO, Vec3::Y * -0.05);
    assert!(bent.is_empty(), "{bent:?}");
    assert_eq!(play(Vec3::X * 0.3, Vec3::ZERO), [(Axis::MoveX, 1.0)]);
}

#[test]
fn the_response_has_a_dead_zone_and_a_curve() {
    let mode =
        r#"point: Wrist, axes: [(axis: "MoveX", motion: Right(100))], dead_zone: 0.2, exponent: 2"#;
    let at = |metres: f32| {
        let moved = (Vec3::X * metres, Rot3::IDENTITY);
        let events = play(mode, Side::Right, moved, Vec3::ZERO);
        events.last().map_or(0.0, |(_, value)| *value)
    };
    assert_eq!([0.019, 0.06, -0.06, 0.2].map(at), [0.0, 0.25, -0.25, 1.0]);
}

#[test]
fn errors_of_an_arm_name_the_remedy() {
    let error = |fields: &str| {
        let text = format!("Layout(name: \"t\", pointer: Pointer({fields}))");
        Layout::parse(&text, "t.ron").unwrap_err().to_string()
    };
    let clutch = r#"clutch: Flexion("ring-mcp-flexion", 50)"#;
    let axes = r#"axes: [(axis: "MoveX", motion: Right(50))]"#;
    let cases = [
        (format!("mode: Arm({axes})"), "`Arm` needs a `clutch`"),
        (
            format!("mode: Arm(axes: []), {clutch}"),
            "`Arm` has no `axes`",
        ),
        (
            format!("mode: Arm({axes}), output: Relative, {clutch}"),
            "`Arm` moves no cursor, remove `output`",
        ),
        (
            format!("mode: Arm({}), {clutch}", axes.replace("50", "2")),
            "at least 5 or at most -5",
        ),
        (
            format!("mode: Arm({}), {clutch}", axes.replace("MoveX", "MoveW")),
            "unknown axis `MoveW`",
        ),
        (
            format!(
                "mode: Arm({}), {clutch}",
                axes.replace("(50))", r#"(50)), (axis: "MoveX", motion: Up(50))"#)
            ),
            "sets the axis `MoveX` too",
        ),
    ];
    for (fields, expected) in cases {
        let found = error(&fields);
        assert!(found.contains(expected), "{found}");
    }
}

#[test]
fn an_arm_requires_the_capability_of_each_of_its_axes() {
    let text = layout(r#"axes: [(axis: "TurnZ", motion: Yaw(30))]"#);
    let layout = Layout::parse(&text, "t.ron").unwrap();
    let required = layout.required_capabilities();
    let axes: Vec<Capability> = required.iter().collect();
    assert_eq!(axes, [Capability::Axis(Axis::TurnZ)]);
}

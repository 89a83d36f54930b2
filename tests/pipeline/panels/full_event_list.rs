//! Returns to rest that do not fit into the event list happen in the next step.

use ademan::contact::{Phase, TargetId, Touch};
use ademan::device::{
    Axis, DeviceInput, DeviceOutput, EventKind, Events, KeyArbiter, OutputEvent, TimedCommands,
};
use ademan::estimate::JointAngles;
use ademan::hand::{Finger, Side};
use ademan::kinematics::HandPose;
use ademan::layout::Layout;
use ademan::time::Timestamp;
use parry3d::math::Vec2;

const LEVER: &str = r#"levers: [(name: "Lift", at_mm: (0, 0), length_mm: 80, springs_back: true,
    output: Axis("MoveZ"))]"#;
const STICK: &str = r#"joysticks: [(name: "Stick", at_mm: (0, 0), diameter_mm: 30,
    axes: ("MoveZ", "LeftY"))]"#;

const PAD: &str = r#"xy_pads: [(name: "Pad", at_mm: (0, 0), size_mm: Box(80, 80), springs_back: true,
    x: (output: Axis("MoveZ")))]"#;

/// The touch of a step, if any: its phase and its position in mm to the right.
type Step = Option<(Phase, f32)>;

/// Returns the axis after each step, rounded to a thousandth. The steps in `full` start with a full event list.
fn axis_values(controls: &str, steps: &[Step], full: &[usize]) -> Vec<f32> {
    let text = format!("Layout(name: \"t\", boards: [(pose: (anchor: world), {controls})])");
    let layout = Layout::parse(&text, "t.ron").unwrap();
    let (mut devices, mut arbiter) = (layout.devices(), KeyArbiter::default());
    let mut axis = 0.0;
    let axis_after = |(index, step): (usize, &Step)| {
        let time = Timestamp(index as u64 * 10_000);
        let filler = OutputEvent {
            time,
            kind: EventKind::Scroll(0, 0),
        };
        let mut events = Events::new();
        if full.contains(&index) {
            events.extend(std::iter::repeat_n(filler, events.capacity()));
        }
        let touches = step.map(|(phase, x)| Touch {
            time,
            side: Side::Right,
            finger: Finger::Index,
            target: TargetId(0),
            phase,
            depth: 1.0,
            position: Vec2::new(x * 1e-3, 0.0),
        });
        let input = DeviceInput {
            scene: &layout.scene,
            angles: &JointAngles::default(),
            bends: &Default::default(),
            inputs: &Default::default(),
            pose: &HandPose::new(time, Side::Right, 0.005),
            touches: touches.as_slice(),
            presses: &[],
        };
        let mut out = DeviceOutput {
            arbiter: &mut arbiter,
            events: &mut events,
            commands: &mut TimedCommands::new(),
        };
        for device in &mut devices {
            device.update(&input, &mut out);
        }
        for event in &events {
            if let EventKind::Axis(Axis::MoveZ, value) = event.kind {
                axis = value;
            }
        }
        (axis * 1e3).round() / 1e3
    };
    steps.iter().enumerate().map(axis_after).collect()
}

#[test]
fn an_axis_returns_to_0_in_the_next_step_with_room() {
    for end in [Phase::Released, Phase::Cancelled] {
        let steps = [
            Some((Phase::Pressed, 0.0)),
            Some((Phase::Moved, 40.0)),
            Some((end, 40.0)),
            None,
        ];
        for controls in [LEVER, STICK, PAD] {
            let found = axis_values(controls, &steps, &[2]);
            assert_eq!(found, [0.0, 1.0, 1.0, 0.0], "{end}, {controls}");
        }
    }
}

#[test]
fn a_control_held_again_before_its_return_stays_held() {
    let steps = [
        Some((Phase::Pressed, 0.0)),
        Some((Phase::Moved, 40.0)),
        Some((Phase::Released, 40.0)),
        Some((Phase::Pressed, 40.0)),
        None,
        Some((Phase::Moved, 0.0)),
        Some((Phase::Released, 0.0)),
    ];
    // The lever is grabbed at its position, the stick starts at its center.
    let lever = axis_values(LEVER, &steps, &[2, 3]);
    assert_eq!(lever[3..], [1.0, 1.0, 0.0, 0.0]);
    let pad = axis_values(PAD, &steps, &[2, 3]);
    assert_eq!(pad[3..], [1.0, 1.0, 0.0, 0.0]);
    let stick = axis_values(STICK, &steps, &[2, 3]);
    assert_eq!(stick[3..], [1.0, 0.0, -1.0, 0.0]);
}

//! What springs back in a frame that has no room for it does so in the next.

use ademan::contact::{Phase, TargetId, Touch};
use ademan::device::{Axis, DeviceInput, DeviceOutput, EventKind, Events, KeyArbiter, OutputEvent};
use ademan::estimate::JointAngles;
use ademan::hand::{Finger, Side};
use ademan::kinematics::HandPose;
use ademan::layout::Layout;
use ademan::time::Timestamp;
use parry3d::math::Vec2;

const LEVER: &str = r#"levers: [(name: "Lift", at_mm: (0, 0), length_mm: 80, springs: true,
    drives: Axis("MoveZ"))]"#;
const STICK: &str = r#"joysticks: [(name: "Stick", at_mm: (0, 0), diameter_mm: 30,
    axes: ("MoveZ", "LeftY"))]"#;

/// What happens in a frame: a phase and the place in mm to the right, or nothing.
type Step = Option<(Phase, f32)>;

/// Where the axis stands after each frame, to a thousandth; of the frames, those that are `full` have no room.
fn stands(controls: &str, steps: &[Step], full: &[usize]) -> Vec<f32> {
    let text = format!("Layout(name: \"t\", boards: [(place: (anchor: world), {controls})])");
    let layout = Layout::parse(&text, "t.ron").unwrap();
    let (mut devices, mut switchboard) = (layout.devices(), KeyArbiter::default());
    let mut axis = 0.0;
    let of_frame = |(frame, step): (usize, &Step)| {
        let time = Timestamp(frame as u64 * 10_000);
        let filler = OutputEvent {
            time,
            kind: EventKind::Scroll(0, 0),
        };
        let mut events = Events::new();
        if full.contains(&frame) {
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
        let seen = DeviceInput {
            scene: &layout.scene,
            angles: &JointAngles::default(),
            pose: &HandPose::new(time, Side::Right, 0.005),
            touches: touches.as_slice(),
        };
        let mut out = DeviceOutput {
            arbiter: &mut switchboard,
            events: &mut events,
            commands: &mut ademan::device::TimedCommands::new(),
        };
        for device in &mut devices {
            device.update(&seen, &mut out);
        }
        for event in &events {
            if let EventKind::Axis(Axis::MoveZ, place) = event.kind {
                axis = place;
            }
        }
        (axis * 1e3).round() / 1e3
    };
    steps.iter().enumerate().map(of_frame).collect()
}

#[test]
fn an_axis_that_finds_no_room_goes_back_to_0_in_the_next_frame() {
    for end in [Phase::Released, Phase::Cancelled] {
        let steps = [
            Some((Phase::Pressed, 0.0)),
            Some((Phase::Moved, 40.0)),
            Some((end, 40.0)),
            None,
        ];
        for controls in [LEVER, STICK] {
            let found = stands(controls, &steps, &[2]);
            assert_eq!(found, [0.0, 1.0, 1.0, 0.0], "{end}, {controls}");
        }
    }
}

#[test]
fn what_is_held_again_before_there_was_room_stays_held() {
    let steps = [
        Some((Phase::Pressed, 0.0)),
        Some((Phase::Moved, 40.0)),
        Some((Phase::Released, 40.0)),
        Some((Phase::Pressed, 40.0)),
        None,
        Some((Phase::Moved, 0.0)),
        Some((Phase::Released, 0.0)),
    ];
    // The handle is grabbed where it still is, the stick begins in the middle.
    let lever = stands(LEVER, &steps, &[2, 3]);
    assert_eq!(lever[3..], [1.0, 1.0, 0.0, 0.0]);
    let stick = stands(STICK, &steps, &[2, 3]);
    assert_eq!(stick[3..], [1.0, 0.0, -1.0, 0.0]);
}

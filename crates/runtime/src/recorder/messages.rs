//! The messages of a step, stage by stage.

use crate::capture::recording::message::wire::{
    put_bytes, put_integer, put_message, put_nonzero_double, put_nonzero_float, put_present_integer,
};
use crate::capture::recording::message::{put_rounded_angles, put_side};
use ademan_core::contact::{Press, TargetName, TargetNames, Touch};
use ademan_core::device::{EventKind, OutputEvent};
use ademan_core::hand::{JointAngles, Side};
use ademan_core::time::Timestamp;

/// Appends the joint angles of a hand.
pub(super) fn encode_angles(time: Timestamp, side: Side, angles: &JointAngles, out: &mut Vec<u8>) {
    put_integer(out, 1, time.0);
    put_side(out, 2, Some(side));
    put_rounded_angles(out, 4, angles);
}

/// Appends a touch.
pub(super) fn encode_touch(touch: &Touch, names: &TargetNames, out: &mut Vec<u8>) {
    put_integer(out, 1, touch.time.0);
    put_side(out, 2, Some(touch.side));
    put_integer(out, 3, touch.finger.index() as u64 + 1);
    put_target(out, 4, names.get(touch.target));
    put_integer(out, 6, touch.phase.index() as u64 + 1);
    put_nonzero_float(out, 7, touch.depth);
    put_nonzero_float(out, 8, touch.position.x);
    put_nonzero_float(out, 9, touch.position.y);
}

/// Appends a press.
pub(super) fn encode_press(press: &Press, names: &TargetNames, out: &mut Vec<u8>) {
    put_integer(out, 1, press.time.0);
    put_side(out, 2, Some(press.side));
    put_integer(out, 3, press.finger.index() as u64 + 1);
    put_target(out, 4, names.get(press.target));
    for (field, coordinate) in (6..).zip(press.point.to_array()) {
        put_nonzero_float(out, field, coordinate);
    }
    put_nonzero_float(out, 9, press.depth);
    put_nonzero_float(out, 10, press.speed);
    for neighbor in &press.neighbors {
        put_message(out, 11, |out| {
            put_target(out, 1, names.get(neighbor.target));
            put_nonzero_float(out, 3, neighbor.distance);
        });
    }
}

/// Appends an event.
pub(super) fn encode_event(event: &OutputEvent, names: &TargetNames, out: &mut Vec<u8>) {
    put_integer(out, 1, event.time.0);
    put_integer(out, 2, number(event.kind));
    match event.kind {
        EventKind::KeyDown(key) | EventKind::KeyUp(key) => {
            put_bytes(out, 3, key.name().as_bytes());
        }
        EventKind::Character(character) => {
            put_bytes(out, 4, character.encode_utf8(&mut [0; 4]).as_bytes());
        }
        EventKind::MoveBy(x, y) | EventKind::Scroll(x, y) => put_xy(out, x.into(), y.into()),
        EventKind::MoveTo(x, y) => put_xy(out, x.into(), y.into()),
        EventKind::Axis(axis, value) => {
            put_bytes(out, 7, axis.name().as_bytes());
            put_nonzero_float(out, 10, value);
        }
        EventKind::Depth(target, value)
        | EventKind::Value(target, value)
        | EventKind::Velocity(target, value) => {
            put_target(out, 8, names.get(target));
            put_nonzero_float(out, 10, value);
        }
        EventKind::Select(target) | EventKind::Unselect(target) => {
            put_target(out, 8, names.get(target));
        }
    }
}

/// Returns the number of a kind of event in the schema.
const fn number(kind: EventKind) -> u64 {
    match kind {
        EventKind::KeyDown(_) => 1,
        EventKind::KeyUp(_) => 2,
        EventKind::Character(_) => 3,
        EventKind::MoveBy(..) => 4,
        EventKind::MoveTo(..) => 5,
        EventKind::Scroll(..) => 6,
        EventKind::Axis(..) => 7,
        EventKind::Depth(..) => 8,
        EventKind::Value(..) => 9,
        EventKind::Select(_) => 10,
        EventKind::Unselect(_) => 11,
        EventKind::Velocity(..) => 12,
    }
}

fn put_xy(out: &mut Vec<u8>, x: f64, y: f64) {
    put_nonzero_double(out, 5, x);
    put_nonzero_double(out, 6, y);
}

/// Appends the name of a target in `field`, or its index in the field after it.
fn put_target(out: &mut Vec<u8>, field: u32, target: TargetName) {
    match target {
        TargetName::Name(name) => put_bytes(out, field, name.as_bytes()),
        // Written also if it is 0, which selects the index of the two.
        TargetName::Id(id) => put_present_integer(out, field + 1, id.0.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::recording::message::SCHEMA_TEXT;
    use ademan_core::contact::{Phase, TargetId};
    use ademan_core::device::Axis;
    use ademan_core::hand::Dof;
    use parry3d::math::Vec2;

    #[test]
    fn phases_and_kinds_of_events_have_the_numbers_of_the_schema() {
        for phase in Phase::ALL {
            let name = phase.name().to_uppercase();
            let line = format!("  PHASE_{name} = {};\n", phase.index() + 1);
            assert!(SCHEMA_TEXT.contains(&line), "{line}");
        }
        let key = "Q".parse().unwrap();
        let target = TargetId(7);
        for (name, kind) in [
            ("KEY_DOWN", EventKind::KeyDown(key)),
            ("KEY_UP", EventKind::KeyUp(key)),
            ("CHARACTER", EventKind::Character('é')),
            ("MOVE_BY", EventKind::MoveBy(1, 2)),
            ("MOVE_TO", EventKind::MoveTo(0.5, 1.0)),
            ("SCROLL", EventKind::Scroll(0, 120)),
            ("AXIS", EventKind::Axis(Axis::LeftX, 0.5)),
            ("DEPTH", EventKind::Depth(target, 0.5)),
            ("VALUE", EventKind::Value(target, 0.5)),
            ("SELECT", EventKind::Select(target)),
            ("UNSELECT", EventKind::Unselect(target)),
            ("VELOCITY", EventKind::Velocity(target, 0.5)),
        ] {
            let line = format!("  EVENT_{name} = {};\n", number(kind));
            assert!(SCHEMA_TEXT.contains(&line), "{line}");
        }
    }

    #[test]
    fn angles_are_rounded_to_single_precision_and_an_angle_of_0_is_kept() {
        let mut angles = JointAngles::default();
        angles.set(Dof::ALL[0], 0.1);
        angles.set(Dof::ALL[1], 0.0);
        let mut message = Vec::new();
        encode_angles(Timestamp(0), Side::Left, &angles, &mut message);
        let mut expected = vec![2 << 3, 1, 4 << 3 | 2, 10];
        for (field, radians) in [(1, 0.1_f32), (2, 0.0)] {
            expected.push(field << 3 | 5);
            expected.extend(radians.to_le_bytes());
        }
        assert_eq!(message, expected);
    }

    #[test]
    fn a_target_without_a_name_has_its_index() {
        let touch = Touch {
            time: Timestamp(0),
            side: Side::Right,
            finger: ademan_core::hand::Finger::Thumb,
            target: TargetId(0),
            phase: Phase::Pressed,
            depth: 0.0,
            position: Vec2::ZERO,
        };
        let mut message = Vec::new();
        encode_touch(&touch, &TargetNames::default(), &mut message);
        assert_eq!(message, [2 << 3, 2, 3 << 3, 1, 5 << 3, 0, 6 << 3, 2]);
    }
}

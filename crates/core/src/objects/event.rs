//! The object of an event.

use serde::Serialize;

use crate::contact::{TargetName, TargetNames};
use crate::device::{Axis, EventKind, KeyCode, OutputEvent};
use crate::time::Timestamp;

/// The object of an event.
#[derive(Serialize)]
pub struct EventObject<'a> {
    time_us: Timestamp,
    #[serde(flatten)]
    kind: EventKindObject<'a>,
}

impl<'a> EventObject<'a> {
    /// Creates the object of an event. `names` has the names of the targets.
    pub fn new(event: &OutputEvent, names: &'a TargetNames) -> Self {
        Self {
            time_us: event.time,
            kind: EventKindObject::new(event.kind, names),
        }
    }
}

#[derive(Serialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
enum EventKindObject<'a> {
    KeyDown {
        key: KeyCode,
    },
    KeyUp {
        key: KeyCode,
    },
    Character {
        character: char,
    },
    MoveBy {
        x: i32,
        y: i32,
    },
    MoveTo {
        x: f32,
        y: f32,
    },
    Scroll {
        x: i32,
        y: i32,
    },
    Axis {
        axis: Axis,
        value: f32,
    },
    Depth {
        target: TargetName<'a>,
        depth: f32,
    },
    Value {
        target: TargetName<'a>,
        value: f32,
    },
    Velocity {
        target: TargetName<'a>,
        velocity: f32,
    },
    Select {
        target: TargetName<'a>,
    },
    Unselect {
        target: TargetName<'a>,
    },
}

impl<'a> EventKindObject<'a> {
    fn new(kind: EventKind, names: &'a TargetNames) -> Self {
        match kind {
            EventKind::KeyDown(key) => Self::KeyDown { key },
            EventKind::KeyUp(key) => Self::KeyUp { key },
            EventKind::Character(character) => Self::Character { character },
            EventKind::MoveBy(x, y) => Self::MoveBy { x, y },
            EventKind::MoveTo(x, y) => Self::MoveTo { x, y },
            EventKind::Scroll(x, y) => Self::Scroll { x, y },
            EventKind::Axis(axis, value) => Self::Axis { axis, value },
            EventKind::Depth(target, depth) => Self::Depth {
                target: names.get(target),
                depth,
            },
            EventKind::Value(target, value) => Self::Value {
                target: names.get(target),
                value,
            },
            EventKind::Velocity(target, velocity) => Self::Velocity {
                target: names.get(target),
                velocity,
            },
            EventKind::Select(target) => Self::Select {
                target: names.get(target),
            },
            EventKind::Unselect(target) => Self::Unselect {
                target: names.get(target),
            },
        }
    }
}

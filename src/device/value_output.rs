//! What the value of a slider, knob or lever drives.

use super::{Axis, Capabilities, Capability, DeviceOutput, EventKind, KeyAction, PressSource};
use crate::contact::TargetId;
use crate::time::Timestamp;

/// A click of the wheel in the units of [`Action::Scroll`].
const CLICK: f32 = 120.0;

/// What a value of 0..=1 drives, beside being told as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ValueOutput {
    /// Nothing else.
    ValueOnly,
    /// An axis: a trigger stands at the value, any other from −1 at 0 to 1 at 1.
    Axis(Axis),
    /// The wheel: this many clicks to the right for the whole range; negative the other way.
    ScrollX(f32),
    /// The wheel: this many clicks up for the whole range; negative the other way.
    ScrollY(f32),
    /// The pointer: this many pixels to the right for the whole range; negative the other way.
    MoveX(f32),
    /// The pointer: this many pixels up for the whole range; negative the other way.
    MoveY(f32),
    /// Taps at each step of the way.
    Taps {
        /// At each step up.
        increase: KeyAction,
        /// At each step down.
        decrease: KeyAction,
        /// How many steps the whole range has, at least 1.
        steps: u16,
    },
}

impl ValueOutput {
    /// Adds what an output must be able to carry for it.
    pub fn add_capabilities(self, needs: &mut Capabilities) {
        match self {
            Self::ValueOnly => {}
            Self::Axis(axis) => needs.insert(Capability::Axis(axis)),
            Self::ScrollX(_) | Self::ScrollY(_) => needs.insert(Capability::Scroll),
            Self::MoveX(_) | Self::MoveY(_) => needs.insert(Capability::RelativeMotion),
            Self::Taps {
                increase: more,
                decrease: less,
                ..
            } => {
                needs.extend(
                    [more, less]
                        .into_iter()
                        .filter_map(KeyAction::required_capability),
                );
            }
        }
    }
}

/// A value that drives something.
#[derive(Clone, Debug)]
pub(super) struct Driver {
    target: TargetId,
    drive: ValueOutput,
    value: f32,
    /// Where it goes when it is let go of; nowhere when `None`.
    springs_to: Option<f32>,
    /// What of the value has been driven: whole units, pixels or steps.
    driven: i32,
    /// Where the axis stands.
    axis: f32,
}

impl Driver {
    /// One that stands at `value` and has told nothing yet; `target` is what the value is told of.
    pub(super) fn new(target: TargetId, drive: ValueOutput, value: f32) -> Self {
        let mut driver = Self {
            target,
            drive,
            value,
            springs_to: None,
            driven: 0,
            axis: 0.0,
        };
        driver.driven = driver.units(value);
        driver
    }

    /// The same that springs back to a value when it is let go of, at which its axis, if it has one, is 0.
    pub(super) fn springing_to(self, springs_to: Option<f32>) -> Self {
        Self { springs_to, ..self }
    }

    /// Whether it moves when it is let go of.
    pub(super) fn springs(&self) -> bool {
        self.springs_to.is_some()
    }

    /// Where it stands.
    pub(super) fn value(&self) -> f32 {
        self.value
    }

    /// Brings it to a value, 0..=1 where it has ends; tells and drives what that changes. A value that is
    /// not a number changes nothing. What finds no room is made up for at the next change.
    pub(super) fn set(&mut self, value: f32, time: Timestamp, out: &mut DeviceOutput) {
        if !value.is_finite() {
            return;
        }
        self.tell_value(value, time, out);
        self.drive_to(value, time, out);
    }

    /// Makes it stand at a value from which it goes on: that is told, and nothing of the way there is
    /// driven, but the axis springs back to 0 until the next [`set`](Self::set).
    pub(super) fn stand(&mut self, value: f32, time: Timestamp, out: &mut DeviceOutput) {
        self.tell_value(value, time, out);
        self.driven = self.units(value);
        self.rest(time, out);
    }

    /// Lets the axis spring back to 0; the value stays where it is, unless it springs back too. That taps,
    /// scrolls and moves nothing, so that a spring works as a ratchet. `false` when there was no room for
    /// all of it.
    pub(super) fn rest(&mut self, time: Timestamp, out: &mut DeviceOutput) -> bool {
        if let ValueOutput::Axis(axis) = self.drive {
            self.stand_at(axis, 0.0, time, out);
        }
        let value = self.springs_to.unwrap_or(self.value);
        if self.tell_value(value, time, out) {
            self.driven = self.units(value);
        }
        self.axis == 0.0 && self.value == value
    }

    /// Whether the value is another than before and has been told.
    fn tell_value(&mut self, value: f32, time: Timestamp, out: &mut DeviceOutput) -> bool {
        let is_told = value != self.value && out.emit(time, EventKind::Value(self.target, value));
        if is_told {
            self.value = value;
        }
        is_told
    }

    fn drive_to(&mut self, value: f32, time: Timestamp, out: &mut DeviceOutput) {
        let (units, behind) = (self.units(value), self.units(value) - self.driven);
        let is_driven = match self.drive {
            ValueOutput::ValueOnly => true,
            ValueOutput::Axis(axis) => {
                let place = if axis.is_trigger() {
                    value
                } else {
                    2.0 * value - 1.0
                };
                self.stand_at(axis, place.clamp(-1.0, 1.0), time, out);
                true
            }
            ValueOutput::Taps {
                increase: more,
                decrease: less,
                ..
            } => return self.tap(more, less, behind, time, out),
            _ if behind == 0 => true,
            ValueOutput::ScrollX(_) => out.emit(time, EventKind::Scroll(behind, 0)),
            ValueOutput::ScrollY(_) => out.emit(time, EventKind::Scroll(0, behind)),
            ValueOutput::MoveX(_) => out.emit(time, EventKind::MoveBy(behind, 0)),
            ValueOutput::MoveY(_) => out.emit(time, EventKind::MoveBy(0, -behind)),
        };
        if is_driven {
            self.driven = units;
        }
    }

    fn stand_at(&mut self, axis: Axis, place: f32, time: Timestamp, out: &mut DeviceOutput) {
        if place != self.axis && out.emit(time, EventKind::Axis(axis, place)) {
            self.axis = place;
        }
    }

    fn tap(
        &mut self,
        more: KeyAction,
        less: KeyAction,
        behind: i32,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let owner = PressSource::Part(self.target, 0);
        let action = if behind > 0 { more } else { less };
        for _ in 0..behind.abs() {
            if !out.tap(owner, action, time) {
                return;
            }
            self.driven += behind.signum();
        }
    }

    fn units(&self, value: f32) -> i32 {
        let whole = match self.drive {
            ValueOutput::ValueOnly | ValueOutput::Axis(_) => 0.0,
            ValueOutput::ScrollX(clicks) | ValueOutput::ScrollY(clicks) => clicks * CLICK,
            ValueOutput::MoveX(pixels) | ValueOutput::MoveY(pixels) => pixels,
            ValueOutput::Taps { steps, .. } => f32::from(steps),
        };
        (value * whole).round() as i32
    }
}

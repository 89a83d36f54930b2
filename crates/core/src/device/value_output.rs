//! The events for the value of a slider, knob, lever or trigger.

use super::{
    Axis, Capabilities, Capability, DETENT, DeviceOutput, EventKind, KeyAction, PressSource,
};
use crate::contact::TargetId;
use crate::hand::Side;
use crate::time::Timestamp;

/// The most taps of a control that wait for the pace. Further ones would come long after the finger has stopped.
const MAX_WAITING_TAPS: i32 = 15;

/// The events for a value of 0..=1 in addition to [`EventKind::Value`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ValueOutput {
    /// Nothing else.
    ValueOnly,
    /// An axis. A trigger axis, and every axis of a control that rests at the value 0, is set to the value; any other
    /// axis to −1 for 0 and 1 for 1.
    Axis(Axis),
    /// The wheel: detents to the right over the whole range; negative for left.
    ScrollX(f32),
    /// The wheel: detents up over the whole range; negative for down.
    ScrollY(f32),
    /// The pointer: pixels to the right over the whole range; negative for left.
    MoveX(f32),
    /// The pointer: pixels up over the whole range; negative for down.
    MoveY(f32),
    /// One tap per step of the range, at the pace of the arbiter.
    Taps {
        /// Tapped at each step up.
        increase: KeyAction,
        /// Tapped at each step down.
        decrease: KeyAction,
        /// Number of steps in the whole range, at least 1.
        steps: u16,
    },
}

impl ValueOutput {
    /// Adds the capabilities that an output needs for it.
    pub fn add_capabilities(self, required: &mut Capabilities) {
        match self {
            Self::ValueOnly => {}
            Self::Axis(axis) => required.insert(Capability::Axis(axis)),
            Self::ScrollX(_) | Self::ScrollY(_) => required.insert(Capability::Scroll),
            Self::MoveX(_) | Self::MoveY(_) => required.insert(Capability::RelativeMotion),
            Self::Taps {
                increase, decrease, ..
            } => {
                let actions = [increase, decrease].into_iter();
                required.extend(actions.filter_map(KeyAction::required_capability));
            }
        }
    }
}

/// A value of a control that has several.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedValue {
    /// The name, which no other target has.
    pub name: String,
    /// The subject of its [`EventKind::Value`] events, which no fingertip touches.
    pub target: TargetId,
}

/// The value of one control and what it has emitted.
#[derive(Clone, Debug)]
pub(super) struct ValueEmitter {
    target: TargetId,
    output: ValueOutput,
    value: f32,
    /// The value to which the control returns when it is released; `None` if it stays.
    rest: Option<f32>,
    /// Whole units, pixels or steps emitted so far.
    emitted: i32,
    /// The hand whose steps emit the taps that wait for the pace.
    waits_for: Option<Side>,
    /// The axis value that was emitted last; 0 before the first one.
    axis: f32,
    /// `true` if an axis from −1 to 1 is 0 for the value 0.
    is_one_sided: bool,
}

impl ValueEmitter {
    /// Creates an emitter that stands at `value`, without emitting it. `target` is the subject of its
    /// [`EventKind::Value`] events.
    pub(super) fn new(target: TargetId, output: ValueOutput, value: f32) -> Self {
        let mut emitter = Self {
            target,
            output,
            value,
            rest: None,
            emitted: 0,
            waits_for: None,
            axis: 0.0,
            is_one_sided: false,
        };
        emitter.emitted = emitter.units(value);
        emitter
    }

    /// Sets the value to which it returns on release. Its axis, if any, must be 0 there.
    pub(super) fn with_rest(self, rest: Option<f32>) -> Self {
        Self { rest, ..self }
    }

    /// Maps the value 0 to the center of an axis from −1 to 1, for a control that rests at 0. Mapped to −1, it would deflect the axis
    /// while it rests.
    pub(super) fn with_axis_at_rest_for_zero(self) -> Self {
        Self {
            is_one_sided: true,
            ..self
        }
    }

    /// Returns `true` if it returns to a rest value on release.
    pub(super) fn springs_back(&self) -> bool {
        self.rest.is_some()
    }

    pub(super) fn output(&self) -> ValueOutput {
        self.output
    }

    pub(super) fn value(&self) -> f32 {
        self.value
    }

    /// Returns `true` if a fingertip may move the control: not during a pause, as the receiver would not learn of it, unless the control
    /// issues commands, which may end the pause.
    pub(super) fn can_move(&self, out: &DeviceOutput) -> bool {
        let is_command = |action: KeyAction| matches!(action, KeyAction::Command(_));
        let issues_commands = match self.output {
            ValueOutput::Taps {
                increase, decrease, ..
            } => is_command(increase) || is_command(decrease),
            _ => false,
        };
        issues_commands || !out.is_paused()
    }

    /// Returns `true` if the value and the axis that were emitted last are 0.
    pub(super) fn is_at_zero(&self) -> bool {
        self.value == 0.0 && self.axis == 0.0
    }

    /// Sets the value, 0..=1 unless the control is endless, and emits what changed. A value that is not
    /// finite is ignored. A change that does not fit into the event list is emitted by the next call.
    pub(super) fn set(&mut self, value: f32, time: Timestamp, out: &mut DeviceOutput) {
        if !value.is_finite() {
            return;
        }
        self.drop_waiting_of_other_hand(value, out);
        self.emit_value(value, time, out);
        self.emit_output(value, time, out);
        self.wait_only_at(value);
    }

    /// Sets a value that wraps around at 1 and emits the changes. Returns the number of whole turns by which the value was reduced.
    pub(super) fn turn_to(&mut self, value: f32, time: Timestamp, out: &mut DeviceOutput) -> f32 {
        if !value.is_finite() {
            return 0.0;
        }
        let turns = value.floor();
        let wrapped = value - turns;
        self.drop_waiting_of_other_hand(wrapped, out);
        self.emit_value(wrapped, time, out);
        self.emit_output(value, time, out);
        self.wait_only_at(wrapped);
        self.emitted += self.units(wrapped) - self.units(value);
        turns
    }

    /// Sets the value as a new starting point: emits the value, but no scrolling, motion or taps for the
    /// distance. The axis returns to 0 until the next [`set`](Self::set).
    pub(super) fn restart_at(&mut self, value: f32, time: Timestamp, out: &mut DeviceOutput) {
        self.emit_value(value, time, out);
        self.emitted = self.units(value);
        self.waits_for = None;
        self.return_to_rest(time, out);
    }

    /// Returns the axis to 0, and the value to its rest value if it has one. Emits no scrolling, motion or
    /// taps for that, so a control with a spring works as a ratchet. Returns `false` if not all of it fitted
    /// into the event list.
    pub(super) fn return_to_rest(&mut self, time: Timestamp, out: &mut DeviceOutput) -> bool {
        if let ValueOutput::Axis(axis) = self.output {
            self.emit_axis(axis, 0.0, time, out);
        }
        self.drop_waiting();
        let value = self.rest.unwrap_or(self.value);
        if self.emit_value(value, time, out) {
            self.emitted = self.units(value);
        }
        self.axis == 0.0 && self.value == value
    }

    /// Emits taps that wait for the pace, in a step of their hand.
    fn catch_up(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if self.waits_for == Some(out.arbiter.step_side()) {
            self.emit_output(self.value, time, out);
        }
    }

    /// Drops the taps that wait for the pace.
    fn drop_waiting(&mut self) {
        if self.waits_for.take().is_some() {
            self.emitted = self.units(self.value);
        }
    }

    /// Drops the taps that wait for the pace in steps of the other hand, if the hand of this step moves the control to another value. The
    /// other hand must not tap for it: this hand may only be allowed to point.
    fn drop_waiting_of_other_hand(&mut self, value: f32, out: &DeviceOutput) {
        let side = out.arbiter.step_side();
        if value != self.value && self.waits_for.is_some_and(|by| by != side) {
            self.drop_waiting();
        }
    }

    /// Keeps waiting taps only if the value was emitted; otherwise they would tap back to the previous value. The next call emits both.
    fn wait_only_at(&mut self, value: f32) {
        if self.value != value {
            self.waits_for = None;
        }
    }

    /// Emits the value if it has changed. Returns `true` if it was emitted.
    fn emit_value(&mut self, value: f32, time: Timestamp, out: &mut DeviceOutput) -> bool {
        let is_emitted =
            value != self.value && out.emit(time, EventKind::Value(self.target, value));
        if is_emitted {
            self.value = value;
        }
        is_emitted
    }

    fn emit_output(&mut self, value: f32, time: Timestamp, out: &mut DeviceOutput) {
        let units = self.units(value);
        let due = units - self.emitted;
        let is_emitted = match self.output {
            ValueOutput::ValueOnly => true,
            ValueOutput::Axis(axis) => {
                let position = if axis.is_trigger() || self.is_one_sided {
                    value
                } else {
                    2.0 * value - 1.0
                };
                self.emit_axis(axis, position.clamp(-1.0, 1.0), time, out);
                true
            }
            ValueOutput::Taps {
                increase, decrease, ..
            } => return self.emit_taps(increase, decrease, due, time, out),
            _ if due == 0 => true,
            ValueOutput::ScrollX(_) => out.emit(time, EventKind::Scroll(due, 0)),
            ValueOutput::ScrollY(_) => out.emit(time, EventKind::Scroll(0, due)),
            ValueOutput::MoveX(_) => out.emit(time, EventKind::MoveBy(due, 0)),
            ValueOutput::MoveY(_) => out.emit(time, EventKind::MoveBy(0, -due)),
        };
        if is_emitted {
            self.emitted = units;
        }
    }

    fn emit_axis(&mut self, axis: Axis, position: f32, time: Timestamp, out: &mut DeviceOutput) {
        if position != self.axis && out.emit(time, EventKind::Axis(axis, position)) {
            self.axis = position;
        }
    }

    fn emit_taps(
        &mut self,
        increase: KeyAction,
        decrease: KeyAction,
        due: i32,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let side = out.arbiter.step_side();
        if self.waits_for.is_some_and(|by| by != side) {
            // What is due waits for a step of the other hand.
            return;
        }
        self.waits_for = None;
        let source = PressSource::Part(self.target, 0);
        let action = if due > 0 { increase } else { decrease };
        let is_command = matches!(action, KeyAction::Command(_));
        for left in (1..=due.abs()).rev() {
            if !is_command && !out.arbiter.may_tap(time) {
                self.waits_for = Some(side);
                self.emitted += due.signum() * (left - MAX_WAITING_TAPS).max(0);
                return;
            }
            if !out.tap(source, action, time) {
                return;
            }
            self.emitted += due.signum();
        }
    }

    fn units(&self, value: f32) -> i32 {
        let range = match self.output {
            ValueOutput::ValueOnly | ValueOutput::Axis(_) => 0.0,
            ValueOutput::ScrollX(detents) | ValueOutput::ScrollY(detents) => {
                detents * DETENT as f32
            }
            ValueOutput::MoveX(pixels) | ValueOutput::MoveY(pixels) => pixels,
            ValueOutput::Taps { steps, .. } => f32::from(steps),
        };
        (value * range).round() as i32
    }
}

/// Emits taps that wait for the pace, in a step of their hand; each control is paired with its emitter.
pub(super) fn catch_up<T>(
    controls: &mut [(T, ValueEmitter)],
    time: Timestamp,
    out: &mut DeviceOutput,
) {
    for (_, emitter) in controls {
        emitter.catch_up(time, out);
    }
}

/// Drops the taps that wait for the pace in steps of a hand that is lost; each control is paired with its emitter.
pub(super) fn drop_waiting<T>(controls: &mut [(T, ValueEmitter)], side: Side) {
    for (_, emitter) in controls {
        if emitter.waits_for == Some(side) {
            emitter.drop_waiting();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::device::key_arbiter::KeyArbiter;
    use crate::device::{Events, TimedCommands};

    #[test]
    fn a_hand_that_may_only_point_adds_no_taps_to_those_that_wait_for_the_other_hand() {
        let key = |name: &str| KeyAction::Key(name.parse().expect("the name of a key"));
        let output = ValueOutput::Taps {
            increase: key("A"),
            decrease: key("B"),
            steps: 100,
        };
        let mut emitter = ValueEmitter::new(TargetId(0), output, 0.0);
        let mut arbiter = KeyArbiter::default();
        arbiter.set_tap_gap(Duration::from_millis(100));
        // Returns the number of taps in a step of a hand, which may move the control.
        let mut taps = |side: Side, seconds: u64, value: Option<f32>| {
            let time = Timestamp(seconds * 1_000_000);
            let (mut events, mut commands) = (Events::new(), TimedCommands::new());
            // The left hand may only point.
            arbiter.begin_step(side, [true, false]);
            let mut out = DeviceOutput {
                arbiter: &mut arbiter,
                events: &mut events,
                commands: &mut commands,
            };
            if let Some(moved_to) = value {
                emitter.set(moved_to, time, &mut out);
            }
            emitter.catch_up(time, &mut out);
            let is_press = |kind: EventKind| matches!(kind, EventKind::KeyDown(_));
            events.iter().filter(|event| is_press(event.kind)).count()
        };
        // Ten steps: six taps at once, and the others wait for the right hand.
        assert_eq!(taps(Side::Right, 1, Some(0.1)), 6);
        assert_eq!(taps(Side::Left, 2, Some(0.1)), 0);
        assert_eq!(taps(Side::Right, 2, None), 4);
        assert_eq!(taps(Side::Right, 10, Some(0.2)), 6);
        assert_eq!(taps(Side::Left, 11, Some(0.9)), 0);
        assert_eq!(taps(Side::Right, 12, None), 0);
        assert_eq!(taps(Side::Right, 20, Some(0.91)), 1);
    }
}

//! A device with the state of its keys and axes.

use std::io;

use arrayvec::ArrayVec;
use evdev::{AbsoluteAxisCode, EventType, InputEvent, RelativeAxisCode};

use super::node::{DeviceNode, MAX_EVENTS};
use super::spec::{DeviceKind, DeviceSpec, POINTER_MAX, STICK_MAX, TRIGGER_MAX, axis_range};
use crate::output::RETRIES;
use crate::output::axis_state::AxisState;
use crate::output::watchdog::DeviceHandle;
use ademan_core::device::pressed_keys::PressedKeys;
use ademan_core::device::{Axis, DETENT, EventKind, KeyCode, KeyKind};

/// Maximum number of input events per output event.
const MAX_INPUT_EVENTS: usize = 4;

/// A device, the state of its keys and axes, and the report under construction.
pub struct TrackedDevice<N> {
    /// The declared capabilities.
    pub spec: DeviceSpec,
    node: N,
    state: DeviceState,
    /// The state before the report.
    previous_state: DeviceState,
    report: ArrayVec<InputEvent, MAX_EVENTS>,
    /// Less than one detent of the wheel, to the right and up.
    wheel_remainder: (i32, i32),
}

#[derive(Clone, Default)]
struct DeviceState {
    pressed: PressedKeys,
    axes: AxisState,
}

impl DeviceState {
    /// Adds the pressed keys and deflected axes of another state.
    fn merge(&mut self, other: &Self) {
        // In release order, so that the order of presses is unchanged if no key is added.
        for key in other.pressed.release_order() {
            self.pressed.press(key);
        }
        for axis in other.axes.deflected_axes() {
            self.axes.set(axis, 1.0);
        }
    }
}

impl<N: DeviceNode> TrackedDevice<N> {
    /// Creates a device with no key pressed and all axes centered.
    pub fn new(spec: DeviceSpec, node: N) -> Self {
        Self {
            spec,
            node,
            state: DeviceState::default(),
            previous_state: DeviceState::default(),
            report: ArrayVec::new(),
            wheel_remainder: (0, 0),
        }
    }

    /// Adds an event to the report. A full report is sent first, and so is one with an event of the same button: libinput compares the
    /// buttons before and after a report (`fallback_debounce_handle_state` in evdev-debounce.c), so a click in one report is lost.
    pub fn push(&mut self, event: EventKind) -> io::Result<()> {
        let is_full = self.report.remaining_capacity() < MAX_INPUT_EVENTS;
        let mut result = Ok(());
        if is_full || self.reports_button_of(event) {
            result = self.flush();
        }
        self.translate(event);
        result
    }

    /// Returns `true` if the report has an event of the button that an event presses or releases.
    fn reports_button_of(&self, event: EventKind) -> bool {
        let (EventKind::KeyDown(key) | EventKind::KeyUp(key)) = event else {
            return false;
        };
        let is_of_key = |reported: &InputEvent| {
            reported.event_type() == EventType::KEY && reported.code() == key.event_code()
        };
        key.kind() != KeyKind::Keyboard && self.report.iter().any(is_of_key)
    }

    /// Sends the report. If that fails, everything that may be pressed stays in the state.
    ///
    /// It is repeated at once: the session loop, which must not wait, calls this, and waiting would not help. The kernel takes a report
    /// whole, or refuses every one because the device is gone; a signal that interrupts a report is over by then (`uinput_write` in
    /// drivers/input/misc/uinput.c).
    pub fn flush(&mut self) -> io::Result<()> {
        if self.report.is_empty() {
            return Ok(());
        }
        let mut result = self.node.write_report(&self.report);
        for _ in 0..RETRIES {
            if result.is_ok() {
                break;
            }
            result = self.node.write_report(&self.report);
        }
        self.report.clear();
        if result.is_err() {
            self.state.merge(&self.previous_state);
        }
        self.previous_state.clone_from(&self.state);
        result
    }

    /// Returns `true` if the key is, or may be, pressed.
    pub fn is_pressed(&self, key: KeyCode) -> bool {
        self.state.pressed.contains(key)
    }

    /// Returns `true` if an axis is, or may be, off center.
    pub fn is_deflected(&self) -> bool {
        self.state.axes.deflected_axes().next().is_some()
    }

    /// Duplicates the device for the watchdog.
    pub fn watchdog_handle(&self) -> io::Result<DeviceHandle> {
        Ok(DeviceHandle {
            node: self.node.try_clone_fd()?,
            has_axes: self.spec.kind == DeviceKind::Gamepad,
        })
    }

    /// Releases all keys and centers all axes.
    pub fn release_all(&mut self) -> io::Result<()> {
        let DeviceState { pressed, axes } = self.state.clone();
        let mut result = Ok(());
        let releases = pressed.release_order().map(EventKind::KeyUp);
        for event in releases.chain(axes.deflected_axes().map(AxisState::center)) {
            result = result.and(self.push(event));
        }
        self.wheel_remainder = (0, 0);
        result.and(self.flush())
    }

    /// Adds the input events for an output event; none if it does not change the state.
    fn translate(&mut self, event: EventKind) {
        match event {
            EventKind::KeyDown(key) if self.state.pressed.press(key) => {
                self.add(EventType::KEY, key.event_code(), 1);
            }
            EventKind::KeyUp(key) if self.state.pressed.release(key) => {
                self.add(EventType::KEY, key.event_code(), 0);
            }
            EventKind::MoveBy(x, y) => {
                self.add_relative(RelativeAxisCode::REL_X, x);
                self.add_relative(RelativeAxisCode::REL_Y, y);
            }
            EventKind::MoveTo(x, y) if x.is_finite() && y.is_finite() => {
                self.add_absolute(AbsoluteAxisCode::ABS_X, pointer_position(x));
                self.add_absolute(AbsoluteAxisCode::ABS_Y, pointer_position(y));
            }
            EventKind::Scroll(x, y) => self.scroll(x, y),
            EventKind::Axis(axis, value) => {
                self.state.axes.set(axis, value);
                self.add_absolute(axis_range(axis).0, axis_value(axis, value));
            }
            _ => {}
        }
    }

    /// Adds the high-resolution rotation, and the detents that it completes: a receiver that supports the former
    /// ignores the latter.
    fn scroll(&mut self, x: i32, y: i32) {
        let (right, up) = (
            self.wheel_remainder.0.saturating_add(x),
            self.wheel_remainder.1.saturating_add(y),
        );
        self.wheel_remainder = (right % DETENT, up % DETENT);
        self.add_relative(RelativeAxisCode::REL_WHEEL_HI_RES, y);
        self.add_relative(RelativeAxisCode::REL_WHEEL, up / DETENT);
        self.add_relative(RelativeAxisCode::REL_HWHEEL_HI_RES, x);
        self.add_relative(RelativeAxisCode::REL_HWHEEL, right / DETENT);
    }

    fn add_relative(&mut self, axis: RelativeAxisCode, value: i32) {
        if value != 0 {
            self.add(EventType::RELATIVE, axis.0, value);
        }
    }

    fn add_absolute(&mut self, axis: AbsoluteAxisCode, value: i32) {
        self.add(EventType::ABSOLUTE, axis.0, value);
    }

    fn add(&mut self, kind: EventType, code: u16, value: i32) {
        // `push` has made room for it.
        let _ = self.report.try_push(InputEvent::new(kind.0, code, value));
    }
}

/// Releases a key of a device, no matter which process pressed it.
pub fn release_key(node: &mut impl DeviceNode, key: KeyCode) -> io::Result<()> {
    node.write_report(&[InputEvent::new(EventType::KEY.0, key.event_code(), 0)])
}

/// Centers all axes of a gamepad.
pub fn center_axes(node: &mut impl DeviceNode) -> io::Result<()> {
    let center = |axis: &Axis| InputEvent::new(EventType::ABSOLUTE.0, axis_range(*axis).0.0, 0);
    let events: ArrayVec<_, { Axis::COUNT }> = Axis::ALL.iter().map(center).collect();
    node.write_report(&events)
}

/// Converts a fraction of the screen to the range of the absolute pointer.
fn pointer_position(fraction: f32) -> i32 {
    (fraction.clamp(0.0, 1.0) * POINTER_MAX as f32).round() as i32
}

/// Converts an axis position −1..=1 to the range of the kernel, where Y points down. NaN results in 0.
fn axis_value(axis: Axis, value: f32) -> i32 {
    let value = value.clamp(-1.0, 1.0);
    let (fraction, maximum) = match axis {
        Axis::LeftY | Axis::RightY => (-value, STICK_MAX),
        _ if axis.is_trigger() => (value.max(0.0), TRIGGER_MAX),
        _ => (value, STICK_MAX),
    };
    (fraction * maximum as f32).round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stick_values_are_negative_when_up_and_trigger_values_are_never_negative() {
        let table = [
            (Axis::LeftX, 1.0, 32_767),
            (Axis::LeftX, -2.0, -32_767),
            (Axis::LeftY, 1.0, -32_767),
            (Axis::RightY, -0.5, 16_384),
            (Axis::LeftTrigger, 0.5, 128),
            (Axis::RightTrigger, -1.0, 0),
            (Axis::RightTrigger, 9.0, 255),
            (Axis::Wheel, -0.5, -16_384),
            (Axis::Rudder, 1.0, 32_767),
            (Axis::Throttle, 1.0, 255),
            (Axis::Brake, -0.5, 0),
            (Axis::LeftX, f32::NAN, 0),
            (Axis::LeftTrigger, f32::NAN, 0),
        ];
        for (axis, value, expected) in table {
            assert_eq!(axis_value(axis, value), expected, "{axis} {value}");
        }
    }

    #[test]
    fn the_screen_edges_are_the_ends_of_the_pointer_range() {
        let positions = [-1.0, 0.0, 0.5, 1.0, 2.0].map(pointer_position);
        assert_eq!(positions, [0, 0, 32_768, 65_535, 65_535]);
    }
}

//! One device with the account of what is down on it.

use std::{io, thread};

use arrayvec::ArrayVec;
use evdev::{AbsoluteAxisCode, EventType, InputEvent, RelativeAxisCode};

use super::node::{DeviceNode, FRAME};
use super::spec::{DeviceKind, DeviceSpec, EDGE, STICK, TRIGGER, range};
use crate::device::{Axis, EventKind, KeyCode};
use crate::output::axis_state::AxisState;
use crate::output::pressed_keys::PressedKeys;
use crate::output::watchdog::DeviceHandle;
use crate::output::{RETRIES, RETRY_DELAY};

/// A click of the wheel, in the unit of [`Action::Scroll`].
const CLICK: i32 = 120;

/// The most events that one action makes.
const OF_ACTION: usize = 4;

/// A device, what is down on it, and the frame that is on its way.
pub struct TrackedDevice<N> {
    /// What it has.
    pub declared: DeviceSpec,
    node: N,
    account: DeviceState,
    /// As it was when the frame began.
    before: DeviceState,
    frame: ArrayVec<InputEvent, FRAME>,
    /// Less than a click of the wheel, to the right and up.
    wheel: (i32, i32),
}

#[derive(Clone, Default)]
struct DeviceState {
    held: PressedKeys,
    deflected: AxisState,
}

impl DeviceState {
    /// Adds what may be down as well.
    fn add(&mut self, other: &Self) {
        // Backwards, so that it is in its order again when nothing new is down.
        for key in other.held.release_order() {
            self.held.press(key);
        }
        for axis in other.deflected.deflected_axes() {
            self.deflected.set(axis, 1.0);
        }
    }
}

impl<N: DeviceNode> TrackedDevice<N> {
    /// A device of which nothing is down.
    pub fn new(declared: DeviceSpec, node: N) -> Self {
        Self {
            declared,
            node,
            account: DeviceState::default(),
            before: DeviceState::default(),
            frame: ArrayVec::new(),
            wheel: (0, 0),
        }
    }

    /// Puts an action into the frame. One that is full is delivered first.
    pub fn push(&mut self, action: EventKind) -> io::Result<()> {
        let mut outcome = Ok(());
        if self.frame.remaining_capacity() < OF_ACTION {
            outcome = self.flush();
        }
        self.translate(action);
        outcome
    }

    /// Delivers the frame; when that fails, what may still be down stays in the account.
    pub fn flush(&mut self) -> io::Result<()> {
        if self.frame.is_empty() {
            return Ok(());
        }
        let mut outcome = self.node.emit(&self.frame);
        for _ in 0..RETRIES {
            if outcome.is_ok() {
                break;
            }
            thread::sleep(RETRY_DELAY);
            outcome = self.node.emit(&self.frame);
        }
        self.frame.clear();
        if outcome.is_err() {
            self.account.add(&self.before);
        }
        self.before.clone_from(&self.account);
        outcome
    }

    /// Whether a key is down, as far as anybody knows.
    pub fn is_pressed(&self, key: KeyCode) -> bool {
        self.account.held.contains(key)
    }

    /// Whether an axis is away from its rest.
    pub fn is_deflected(&self) -> bool {
        self.account.deflected.deflected_axes().next().is_some()
    }

    /// A second handle of the device, for a guardian.
    pub fn watchdog_handle(&self) -> io::Result<DeviceHandle> {
        Ok(DeviceHandle {
            node: self.node.try_clone_fd()?,
            has_axes: self.declared.kind == DeviceKind::Pad,
        })
    }

    /// Lets go of everything and brings the axes back.
    pub fn release_all(&mut self) -> io::Result<()> {
        let DeviceState { held, deflected } = self.account.clone();
        let mut outcome = Ok(());
        let ups = held.release_order().map(EventKind::KeyUp);
        for action in ups.chain(deflected.deflected_axes().map(AxisState::center)) {
            outcome = outcome.and(self.push(action));
        }
        self.wheel = (0, 0);
        outcome.and(self.flush())
    }

    /// What the kernel is told of an action; nothing of one that changes nothing about what is down.
    fn translate(&mut self, action: EventKind) {
        match action {
            EventKind::KeyDown(key) if self.account.held.press(key) => {
                self.put(EventType::KEY, key.event_code(), 1);
            }
            EventKind::KeyUp(key) if self.account.held.release(key) => {
                self.put(EventType::KEY, key.event_code(), 0);
            }
            EventKind::MoveBy(x, y) => {
                self.put_relative(RelativeAxisCode::REL_X, x);
                self.put_relative(RelativeAxisCode::REL_Y, y);
            }
            EventKind::MoveTo(x, y) if x.is_finite() && y.is_finite() => {
                self.put_absolute(AbsoluteAxisCode::ABS_X, place(x));
                self.put_absolute(AbsoluteAxisCode::ABS_Y, place(y));
            }
            EventKind::Scroll(x, y) => self.scroll(x, y),
            EventKind::Axis(axis, value) => {
                self.account.deflected.set(axis, value);
                self.put_absolute(range(axis).0, deflection(axis, value));
            }
            _ => {}
        }
    }

    /// Tells the fine turn, and the clicks that it completes: whoever knows the fine one ignores them.
    fn scroll(&mut self, x: i32, y: i32) {
        let (right, up) = (
            self.wheel.0.saturating_add(x),
            self.wheel.1.saturating_add(y),
        );
        self.wheel = (right % CLICK, up % CLICK);
        self.put_relative(RelativeAxisCode::REL_WHEEL_HI_RES, y);
        self.put_relative(RelativeAxisCode::REL_WHEEL, up / CLICK);
        self.put_relative(RelativeAxisCode::REL_HWHEEL_HI_RES, x);
        self.put_relative(RelativeAxisCode::REL_HWHEEL, right / CLICK);
    }

    fn put_relative(&mut self, axis: RelativeAxisCode, value: i32) {
        if value != 0 {
            self.put(EventType::RELATIVE, axis.0, value);
        }
    }

    fn put_absolute(&mut self, axis: AbsoluteAxisCode, value: i32) {
        self.put(EventType::ABSOLUTE, axis.0, value);
    }

    fn put(&mut self, kind: EventType, code: u16, value: i32) {
        // `take` has made room for it.
        let _ = self.frame.try_push(InputEvent::new(kind.0, code, value));
    }
}

/// Lets go of a key, whoever has pressed it on this device.
pub fn release_key(node: &mut impl DeviceNode, key: KeyCode) -> io::Result<()> {
    node.emit(&[InputEvent::new(EventType::KEY.0, key.event_code(), 0)])
}

/// Brings all axes of a gamepad back to their rest.
pub fn center_axes(node: &mut impl DeviceNode) -> io::Result<()> {
    let at_rest = |axis: &Axis| InputEvent::new(EventType::ABSOLUTE.0, range(*axis).0.0, 0);
    let events: ArrayVec<_, { Axis::COUNT }> = Axis::ALL.iter().map(at_rest).collect();
    node.emit(&events)
}

/// A share of the screen as the pointer tells it.
fn place(share: f32) -> i32 {
    (share.clamp(0.0, 1.0) * EDGE as f32).round() as i32
}

/// Where an axis stands as the kernel counts: sticks down and to the right, no number as 0.
fn deflection(axis: Axis, value: f32) -> i32 {
    let value = value.clamp(-1.0, 1.0);
    let (share, end) = match axis {
        Axis::LeftY | Axis::RightY => (-value, STICK),
        Axis::LeftTrigger | Axis::RightTrigger => (value.max(0.0), TRIGGER),
        _ => (value, STICK),
    };
    (share * end as f32).round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stick_goes_up_to_the_negative_and_a_trigger_never_below_its_rest() {
        let table = [
            (Axis::LeftX, 1.0, 32_767),
            (Axis::LeftX, -2.0, -32_767),
            (Axis::LeftY, 1.0, -32_767),
            (Axis::RightY, -0.5, 16_384),
            (Axis::LeftTrigger, 0.5, 128),
            (Axis::RightTrigger, -1.0, 0),
            (Axis::RightTrigger, 9.0, 255),
            (Axis::LeftX, f32::NAN, 0),
            (Axis::LeftTrigger, f32::NAN, 0),
        ];
        for (axis, value, told) in table {
            assert_eq!(deflection(axis, value), told, "{axis} {value}");
        }
    }

    #[test]
    fn the_edges_of_the_screen_are_the_ends_of_the_pointer() {
        let told = [-1.0, 0.0, 0.5, 1.0, 2.0].map(place);
        assert_eq!(told, [0, 0, 32_768, 65_535, 65_535]);
    }
}

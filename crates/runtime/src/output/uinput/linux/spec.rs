//! The devices that a layout requires. Each has exactly the required capabilities, and the ones without which udev and libinput
//! would not recognize it.

use std::collections::BTreeSet;

use arrayvec::ArrayVec;
use evdev::{AbsoluteAxisCode, AttributeSet, RelativeAxisCode};

use ademan_core::device::{Axis, Capabilities, Capability, KeyCode, KeyKind};

/// The right and lower edge of the screen in the range of the absolute pointer, which starts at 0.
pub const POINTER_MAX: i32 = 65_535;

/// Value of a stick at its end to the right or down; its minimum is −32768.
pub const STICK_MAX: i32 = 32_767;

/// Value of a fully pulled trigger; its minimum is 0.
pub const TRIGGER_MAX: i32 = 255;

/// The kind of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceKind {
    /// Keys.
    Keyboard,
    /// Relative motion, wheel and buttons.
    Mouse,
    /// Absolute motion and buttons.
    Pointer,
    /// Sticks, triggers and the buttons of a gamepad.
    Gamepad,
}

impl DeviceKind {
    /// Returns the suffix of the name of the device.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Keyboard => "keyboard",
            Self::Mouse => "mouse",
            Self::Pointer => "pointer",
            Self::Gamepad => "gamepad",
        }
    }

    /// Returns the product id for udev rules.
    pub const fn product(self) -> u16 {
        self as u16 + 1
    }
}

/// An absolute axis with its minimum and maximum.
pub type AxisRange = (AbsoluteAxisCode, i32, i32);

/// The declared capabilities of a device.
#[derive(Clone, Debug)]
pub struct DeviceSpec {
    /// The kind of the device.
    pub kind: DeviceKind,
    /// Keys and buttons.
    pub keys: AttributeSet<evdev::KeyCode>,
    /// Relative axes.
    pub relative_axes: AttributeSet<RelativeAxisCode>,
    /// Absolute axes.
    pub absolute_axes: ArrayVec<AxisRange, { Axis::COUNT }>,
}

impl DeviceSpec {
    /// Returns the devices that are needed for `required`; the first that supports a capability carries it.
    pub fn for_capabilities(required: &Capabilities) -> Vec<Self> {
        let devices = [
            keyboard(required),
            mouse(required),
            pointer(required),
            gamepad(required),
        ];
        devices.into_iter().flatten().collect()
    }

    /// Returns `true` if the device supports a capability.
    pub fn supports(&self, capability: Capability) -> bool {
        match capability {
            Capability::Key(key) => self.keys.contains(kernel_code(key)),
            Capability::RelativeMotion | Capability::Scroll => self.kind == DeviceKind::Mouse,
            Capability::AbsoluteMotion => self.kind == DeviceKind::Pointer,
            Capability::Axis(axis) => self.kind == DeviceKind::Gamepad && axis.is_gamepad(),
            Capability::Text => false,
        }
    }

    fn new(kind: DeviceKind, keys: impl IntoIterator<Item = KeyCode>) -> Self {
        Self {
            kind,
            keys: keys.into_iter().map(kernel_code).collect(),
            relative_axes: AttributeSet::new(),
            absolute_axes: ArrayVec::new(),
        }
    }
}

fn kernel_code(key: KeyCode) -> evdev::KeyCode {
    evdev::KeyCode(key.event_code())
}

fn keys_of_kind(required: &Capabilities, kind: KeyKind) -> BTreeSet<KeyCode> {
    let keys = required.keys.iter().copied();
    keys.filter(|key| key.kind() == kind).collect()
}

fn keyboard(required: &Capabilities) -> Option<DeviceSpec> {
    let keys = keys_of_kind(required, KeyKind::Keyboard);
    (!keys.is_empty()).then(|| DeviceSpec::new(DeviceKind::Keyboard, keys))
}

/// Returns a mouse, always with both axes and two buttons: udev's `input_id`, and with it libinput and X11, ignores a
/// mouse without them.
fn mouse(required: &Capabilities) -> Option<DeviceSpec> {
    let buttons = keys_of_kind(required, KeyKind::Mouse);
    let has_buttons_only = !buttons.is_empty() && !required.absolute_motion;
    if !(required.relative_motion || required.scroll || has_buttons_only) {
        return None;
    }
    let mut mouse = DeviceSpec::new(DeviceKind::Mouse, buttons);
    add_main_buttons(&mut mouse);
    let motion = [RelativeAxisCode::REL_X, RelativeAxisCode::REL_Y];
    let wheel = [
        RelativeAxisCode::REL_WHEEL,
        RelativeAxisCode::REL_HWHEEL,
        RelativeAxisCode::REL_WHEEL_HI_RES,
        RelativeAxisCode::REL_HWHEEL_HI_RES,
    ];
    let wheel = wheel.into_iter().filter(|_| required.scroll);
    mouse.relative_axes = motion.into_iter().chain(wheel).collect();
    Some(mouse)
}

/// Returns an absolute pointer as virtual machines have it: absolute axes and the buttons of a mouse. `BTN_TOUCH`
/// would make it a touch screen, on which motion is a touch; `BTN_TOOL_PEN` would make it a tablet, which needs
/// resolution and proximity. udev's `input_id` classifies it as a mouse, libinput as a pointer with absolute motion.
fn pointer(required: &Capabilities) -> Option<DeviceSpec> {
    if !required.absolute_motion {
        return None;
    }
    let buttons = keys_of_kind(required, KeyKind::Mouse);
    let mut pointer = DeviceSpec::new(DeviceKind::Pointer, buttons);
    add_main_buttons(&mut pointer);
    let axes = [AbsoluteAxisCode::ABS_X, AbsoluteAxisCode::ABS_Y];
    let ranges = axes.into_iter().map(|axis| (axis, 0, POINTER_MAX));
    pointer.absolute_axes = ranges.collect();
    Some(pointer)
}

fn add_main_buttons(device: &mut DeviceSpec) {
    device.keys.insert(evdev::KeyCode::BTN_LEFT);
    device.keys.insert(evdev::KeyCode::BTN_RIGHT);
}

/// Returns a gamepad, always with `BTN_SOUTH`, by which udev and games recognize it, and `BTN_EAST`: udev's `input_id`
/// ignores a device with one button and no axis.
fn gamepad(required: &Capabilities) -> Option<DeviceSpec> {
    let buttons = keys_of_kind(required, KeyKind::Gamepad);
    let axes = required.axes.iter().filter(|axis| axis.is_gamepad());
    let ranges: ArrayVec<_, { Axis::COUNT }> = axes.map(|axis| axis_range(*axis)).collect();
    if buttons.is_empty() && ranges.is_empty() {
        return None;
    }
    let mut gamepad = DeviceSpec::new(DeviceKind::Gamepad, buttons);
    gamepad.keys.insert(evdev::KeyCode::BTN_SOUTH);
    gamepad.keys.insert(evdev::KeyCode::BTN_EAST);
    gamepad.absolute_axes = ranges;
    Some(gamepad)
}

/// Returns the kernel's axis with its range. Sticks and triggers follow the driver `xpad`, which games know; the others
/// have the kernel's codes for wheels and pedals, which udev's `input_id` takes for a joystick too.
pub fn axis_range(axis: Axis) -> AxisRange {
    let stick = |code| (code, -STICK_MAX - 1, STICK_MAX);
    let trigger = |code| (code, 0, TRIGGER_MAX);
    match axis {
        Axis::LeftX => stick(AbsoluteAxisCode::ABS_X),
        Axis::LeftY => stick(AbsoluteAxisCode::ABS_Y),
        Axis::RightX => stick(AbsoluteAxisCode::ABS_RX),
        Axis::RightY => stick(AbsoluteAxisCode::ABS_RY),
        Axis::LeftTrigger => trigger(AbsoluteAxisCode::ABS_Z),
        Axis::RightTrigger => trigger(AbsoluteAxisCode::ABS_RZ),
        Axis::Wheel => stick(AbsoluteAxisCode::ABS_WHEEL),
        Axis::Rudder => stick(AbsoluteAxisCode::ABS_RUDDER),
        Axis::Throttle => trigger(AbsoluteAxisCode::ABS_THROTTLE),
        Axis::Brake => trigger(AbsoluteAxisCode::ABS_BRAKE),
        // No device declares them.
        Axis::MoveX | Axis::MoveY | Axis::MoveZ | Axis::TurnX | Axis::TurnY | Axis::TurnZ => {
            stick(AbsoluteAxisCode::ABS_MISC)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::key;

    fn code(name: &str) -> Capability {
        Capability::Key(key(name))
    }

    /// Returns each device as `kind: keys / relative axes / absolute axes`, in event codes.
    fn specs(required: &[Capability]) -> Vec<String> {
        let numbers = |codes: &mut dyn Iterator<Item = u16>| {
            let numbers: Vec<_> = codes.map(|code| code.to_string()).collect();
            numbers.join(" ")
        };
        DeviceSpec::for_capabilities(&required.iter().copied().collect())
            .iter()
            .map(|device| {
                let keys = numbers(&mut device.keys.iter().map(|code| code.0));
                let relative = numbers(&mut device.relative_axes.iter().map(|code| code.0));
                let absolute = numbers(&mut device.absolute_axes.iter().map(|axis| axis.0.0));
                format!("{}: {keys} / {relative} / {absolute}", device.kind.name())
            })
            .collect()
    }

    #[test]
    fn each_device_has_the_required_capabilities_only() {
        let table: [(&[Capability], &[&str]); 10] = [
            (&[], &[]),
            (&[code("Q"), code("ArrowUp")], &["keyboard: 16 103 /  / "]),
            (&[Capability::RelativeMotion], &["mouse: 272 273 / 0 1 / "]),
            (
                &[Capability::Scroll],
                &["mouse: 272 273 / 0 1 6 8 11 12 / "],
            ),
            (&[code("MouseBack")], &["mouse: 272 273 275 / 0 1 / "]),
            (
                &[Capability::AbsoluteMotion, code("MouseMiddle")],
                &["pointer: 272 273 274 /  / 0 1"],
            ),
            (
                &[
                    Capability::AbsoluteMotion,
                    Capability::Scroll,
                    code("MouseMiddle"),
                ],
                &[
                    "mouse: 272 273 274 / 0 1 6 8 11 12 / ",
                    "pointer: 272 273 274 /  / 0 1",
                ],
            ),
            (
                &[
                    Capability::Axis(Axis::RightX),
                    Capability::Axis(Axis::LeftTrigger),
                ],
                &["gamepad: 304 305 /  / 3 2"],
            ),
            (
                &[Capability::Axis(Axis::Wheel), Capability::Axis(Axis::Brake)],
                &["gamepad: 304 305 /  / 8 10"],
            ),
            (&[code("PadMode")], &["gamepad: 304 305 316 /  / "]),
        ];
        for (required, devices) in table {
            assert_eq!(specs(required), devices, "{required:?}");
        }
    }

    #[test]
    fn each_gamepad_axis_has_its_own_code_and_range() {
        let ranges: Vec<_> = Axis::ALL
            .iter()
            .filter(|axis| axis.is_gamepad())
            .map(|axis| axis_range(*axis))
            .map(|(code, low, high)| (code.0, low, high))
            .collect();
        let stick = |code| (code, -32_768, 32_767);
        let expected = [
            stick(0),
            stick(1),
            stick(3),
            stick(4),
            (2, 0, 255),
            (5, 0, 255),
            stick(8),
            stick(7),
            (6, 0, 255),
            (10, 0, 255),
        ];
        assert_eq!(ranges, expected);
    }

    #[test]
    fn mouse_and_pointer_have_buttons_and_everything_else_is_on_one_device() {
        let required = Capabilities::from_iter([
            Capability::AbsoluteMotion,
            Capability::RelativeMotion,
            code("MouseLeft"),
        ]);
        let devices = DeviceSpec::for_capabilities(&required);
        let supporters = |capability| {
            let supporters = devices.iter().filter(|device| device.supports(capability));
            supporters.map(|device| device.kind).collect::<Vec<_>>()
        };
        let both = [DeviceKind::Mouse, DeviceKind::Pointer];
        assert_eq!(supporters(code("MouseLeft")), both);
        assert_eq!(supporters(Capability::RelativeMotion), [DeviceKind::Mouse]);
        assert_eq!(
            supporters(Capability::AbsoluteMotion),
            [DeviceKind::Pointer]
        );
        assert_eq!(supporters(code("A")), []);
        assert_eq!(supporters(Capability::Axis(Axis::LeftX)), []);
    }
}

//! Which devices a layout needs, and what each says it has: no more than that, and what makes the
//! system take it for what it is.

use std::collections::BTreeSet;

use arrayvec::ArrayVec;
use evdev::{AbsoluteAxisCode, AttributeSet, RelativeAxisCode};

use crate::device::{Axis, Capabilities, Capability, KeyCode, KeyKind};

/// The right and lower edge of the screen on an absolute pointer.
pub const EDGE: i32 = 65_535;

/// A stick at its end, to the right or down; to the left and up it is one less than the negative.
pub const STICK: i32 = 32_767;

/// A trigger at its end.
pub const TRIGGER: i32 = 255;

/// A device that the kernel is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceKind {
    /// Keys.
    Keyboard,
    /// Relative motion, wheel and buttons.
    Mouse,
    /// Places on the screen, and buttons.
    Pointer,
    /// Sticks, triggers and the buttons of a gamepad.
    Pad,
}

impl DeviceKind {
    /// What its name ends with.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Keyboard => "keyboard",
            Self::Mouse => "mouse",
            Self::Pointer => "pointer",
            Self::Pad => "gamepad",
        }
    }

    /// The number that tells it from the others, for rules about devices.
    pub const fn product(self) -> u16 {
        self as u16 + 1
    }
}

/// An absolute axis with its ends.
pub type Range = (AbsoluteAxisCode, i32, i32);

/// What a device says it has.
#[derive(Clone, Debug)]
pub struct DeviceSpec {
    /// What it is.
    pub kind: DeviceKind,
    /// Its keys and buttons.
    pub keys: AttributeSet<evdev::KeyCode>,
    /// Its relative axes.
    pub relative: AttributeSet<RelativeAxisCode>,
    /// Its absolute axes.
    pub absolute: ArrayVec<Range, { Axis::COUNT }>,
}

impl DeviceSpec {
    /// The devices that are needed, in the order in which they are asked whether they have something.
    pub fn for_capabilities(needs: &Capabilities) -> Vec<Self> {
        let devices = [keyboard(needs), mouse(needs), pointer(needs), pad(needs)];
        devices.into_iter().flatten().collect()
    }

    /// Whether it has what this takes.
    pub fn has(&self, need: Capability) -> bool {
        match need {
            Capability::Key(code) => self.keys.contains(kernel_code(code)),
            Capability::RelativeMotion | Capability::Scroll => self.kind == DeviceKind::Mouse,
            Capability::AbsoluteMotion => self.kind == DeviceKind::Pointer,
            Capability::Axis(axis) => self.kind == DeviceKind::Pad && axis.is_gamepad(),
            Capability::Text => false,
        }
    }

    fn new(kind: DeviceKind, codes: impl IntoIterator<Item = KeyCode>) -> Self {
        Self {
            kind,
            keys: codes.into_iter().map(kernel_code).collect(),
            relative: AttributeSet::new(),
            absolute: ArrayVec::new(),
        }
    }
}

fn kernel_code(key: KeyCode) -> evdev::KeyCode {
    evdev::KeyCode(key.event_code())
}

fn of_kind(needs: &Capabilities, kind: KeyKind) -> BTreeSet<KeyCode> {
    let codes = needs.keys.iter().copied();
    codes.filter(|code| code.kind() == kind).collect()
}

fn keyboard(needs: &Capabilities) -> Option<DeviceSpec> {
    let keys = of_kind(needs, KeyKind::Keyboard);
    (!keys.is_empty()).then(|| DeviceSpec::new(DeviceKind::Keyboard, keys))
}

/// A mouse without buttons, or without both axes, is ignored: by udev's `input_id`, and so by whoever
/// asks it, libinput and X11.
fn mouse(needs: &Capabilities) -> Option<DeviceSpec> {
    let buttons = of_kind(needs, KeyKind::Mouse);
    let is_needed =
        needs.relative_motion || needs.scroll || (!buttons.is_empty() && !needs.absolute_motion);
    if !is_needed {
        return None;
    }
    let mut mouse = DeviceSpec::new(DeviceKind::Mouse, buttons);
    declare_two_buttons(&mut mouse);
    let ways = [RelativeAxisCode::REL_X, RelativeAxisCode::REL_Y];
    let wheel = [
        RelativeAxisCode::REL_WHEEL,
        RelativeAxisCode::REL_HWHEEL,
        RelativeAxisCode::REL_WHEEL_HI_RES,
        RelativeAxisCode::REL_HWHEEL_HI_RES,
    ];
    let wheel = wheel.into_iter().filter(|_| needs.scroll);
    mouse.relative = ways.into_iter().chain(wheel).collect();
    Some(mouse)
}

/// The kind of device that virtual machines give to their guests: absolute axes and the buttons of a
/// mouse. Neither `BTN_TOUCH`, which would make a touch screen of it, on which motion is a touch, nor
/// `BTN_TOOL_PEN`, which would make a tablet of it that needs resolution and proximity. udev's
/// `input_id` takes it for a mouse, libinput for a pointer with absolute motion.
fn pointer(needs: &Capabilities) -> Option<DeviceSpec> {
    if !needs.absolute_motion {
        return None;
    }
    let mut pointer = DeviceSpec::new(DeviceKind::Pointer, of_kind(needs, KeyKind::Mouse));
    declare_two_buttons(&mut pointer);
    let axes = [AbsoluteAxisCode::ABS_X, AbsoluteAxisCode::ABS_Y];
    pointer.absolute = axes.into_iter().map(|axis| (axis, 0, EDGE)).collect();
    Some(pointer)
}

fn declare_two_buttons(device: &mut DeviceSpec) {
    device.keys.insert(evdev::KeyCode::BTN_LEFT);
    device.keys.insert(evdev::KeyCode::BTN_RIGHT);
}

/// With the lowest gamepad button always, which is what makes udev and games take it for one, and with the
/// next: one button and no axis are too little for udev's `input_id`.
fn pad(needs: &Capabilities) -> Option<DeviceSpec> {
    let buttons = of_kind(needs, KeyKind::Gamepad);
    let axes: ArrayVec<_, { Axis::COUNT }> = needs
        .axes
        .iter()
        .filter(|axis| axis.is_gamepad())
        .map(|axis| range(*axis))
        .collect();
    if buttons.is_empty() && axes.is_empty() {
        return None;
    }
    let mut pad = DeviceSpec::new(DeviceKind::Pad, buttons);
    pad.keys.insert(evdev::KeyCode::BTN_SOUTH);
    pad.keys.insert(evdev::KeyCode::BTN_EAST);
    pad.absolute = axes;
    Some(pad)
}

/// The kernel's axis of a gamepad, with its ends: where its driver `xpad` has them, which games know.
pub fn range(axis: Axis) -> Range {
    let stick = |code| (code, -STICK - 1, STICK);
    let trigger = |code| (code, 0, TRIGGER);
    match axis {
        Axis::LeftX => stick(AbsoluteAxisCode::ABS_X),
        Axis::LeftY => stick(AbsoluteAxisCode::ABS_Y),
        Axis::RightX => stick(AbsoluteAxisCode::ABS_RX),
        Axis::RightY => stick(AbsoluteAxisCode::ABS_RY),
        Axis::LeftTrigger => trigger(AbsoluteAxisCode::ABS_Z),
        Axis::RightTrigger => trigger(AbsoluteAxisCode::ABS_RZ),
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

    /// Each device as `kind: keys / relative axes / absolute axes`, in the kernel's numbers.
    fn declared(needs: &[Capability]) -> Vec<String> {
        let numbers = |codes: &mut dyn Iterator<Item = u16>| {
            let numbers: Vec<_> = codes.map(|code| code.to_string()).collect();
            numbers.join(" ")
        };
        DeviceSpec::for_capabilities(&needs.iter().copied().collect())
            .iter()
            .map(|device| {
                let keys = numbers(&mut device.keys.iter().map(|code| code.0));
                let relative = numbers(&mut device.relative.iter().map(|code| code.0));
                let absolute = numbers(&mut device.absolute.iter().map(|axis| axis.0.0));
                format!("{}: {keys} / {relative} / {absolute}", device.kind.name())
            })
            .collect()
    }

    #[test]
    fn a_device_is_made_when_it_is_needed_and_has_what_is_needed() {
        let table: [(&[Capability], &[&str]); 9] = [
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
            (&[code("PadMode")], &["gamepad: 304 305 316 /  / "]),
        ];
        for (needs, devices) in table {
            assert_eq!(declared(needs), devices, "{needs:?}");
        }
    }

    #[test]
    fn each_axis_of_a_gamepad_has_a_place_of_its_own() {
        let ranges: Vec<_> = Axis::ALL
            .iter()
            .filter(|axis| axis.is_gamepad())
            .map(|axis| range(*axis))
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
        ];
        assert_eq!(ranges, expected);
    }

    #[test]
    fn buttons_are_of_mouse_and_pointer_and_the_rest_of_one_device() {
        let needs = Capabilities::from_iter([
            Capability::AbsoluteMotion,
            Capability::RelativeMotion,
            code("MouseLeft"),
        ]);
        let devices = DeviceSpec::for_capabilities(&needs);
        let holders = |need| {
            let holders = devices.iter().filter(|device| device.has(need));
            holders.map(|device| device.kind).collect::<Vec<_>>()
        };
        let both = [DeviceKind::Mouse, DeviceKind::Pointer];
        assert_eq!(holders(code("MouseLeft")), both);
        assert_eq!(holders(Capability::RelativeMotion), [DeviceKind::Mouse]);
        assert_eq!(holders(Capability::AbsoluteMotion), [DeviceKind::Pointer]);
        assert_eq!(holders(code("A")), []);
        assert_eq!(holders(Capability::Axis(Axis::LeftX)), []);
    }
}

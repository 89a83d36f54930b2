//! Touchscreens, where a position is a position on the screen, and touchpads, where motion moves the pointer.

mod touchpad;
mod touchscreen;

pub use self::touchpad::TouchpadSettings;

use parry3d::math::Vec2;

use self::touchpad::Touchpad;
use self::touchscreen::Touchscreen;
use super::target_index::TargetIndex;
use super::{
    Capabilities, Capability, DeviceInput, DeviceOutput, KeyAction, KeyCode, PressSource,
    VirtualDevice,
};
use crate::contact::{TargetId, Touch};
use crate::time::Timestamp;

const LEFT: KeyAction = KeyAction::Key(KeyCode::MOUSE_LEFT);
const RIGHT: KeyAction = KeyAction::Key(KeyCode::MOUSE_RIGHT);

/// A touchscreen or touchpad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchSurface {
    /// The target that is touched, a box.
    pub target: TargetId,
    /// The effect of touching it.
    pub mode: TouchMode,
}

/// The effect of touching a touch surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TouchMode {
    /// The pointer moves to the finger; pressing holds the left mouse button. Only the first finger counts.
    /// The value is the half extents of the surface, in metres; beyond its edge the pointer stays at the edge.
    Touchscreen(Vec2),
    /// One finger moves the pointer, two scroll, and a short touch clicks.
    Touchpad(TouchpadSettings),
}

/// The touchscreens and touchpads of a layout.
#[derive(Clone, Debug)]
pub struct TouchSurfaces {
    devices: Vec<(TargetId, TouchDevice)>,
    index: TargetIndex,
}

#[derive(Clone, Debug)]
enum TouchDevice {
    Screen(Touchscreen),
    Pad(Box<Touchpad>),
}

impl TouchSurfaces {
    /// Creates the touch surfaces, with no finger on them.
    pub fn new(surfaces: Vec<TouchSurface>) -> Self {
        let device = |surface: TouchSurface| match surface.mode {
            TouchMode::Touchscreen(half_extents) => {
                TouchDevice::Screen(Touchscreen::new(half_extents))
            }
            TouchMode::Touchpad(settings) => TouchDevice::Pad(Box::new(Touchpad::new(settings))),
        };
        Self {
            index: TargetIndex::new(surfaces.iter().map(|surface| surface.target)),
            devices: surfaces
                .into_iter()
                .map(|surface| (surface.target, device(surface)))
                .collect(),
        }
    }

    fn device(&mut self, touch: &Touch) -> Option<(MouseButton, &mut TouchDevice)> {
        let (target, device) = self.devices.get_mut(self.index.get(touch.target)?)?;
        Some((MouseButton(*target), device))
    }
}

impl VirtualDevice for TouchSurfaces {
    fn add_capabilities(&self, required: &mut Capabilities) {
        for (_, device) in &self.devices {
            required.insert(Capability::Key(KeyCode::MOUSE_LEFT));
            match device {
                TouchDevice::Screen(_) => required.insert(Capability::AbsoluteMotion),
                TouchDevice::Pad(_) => required.extend([
                    Capability::Key(KeyCode::MOUSE_RIGHT),
                    Capability::RelativeMotion,
                    Capability::Scroll,
                ]),
            }
        }
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        for touch in input.touches {
            match self.device(touch) {
                Some((button, TouchDevice::Screen(screen))) => screen.handle(touch, button, out),
                Some((button, TouchDevice::Pad(pad))) => {
                    pad.handle(touch, input.pose.is_after_gap, button, out);
                }
                None => {}
            }
        }
        // Motion follows once the positions of all fingers in this step are known.
        for touch in input.touches {
            if let Some((button, TouchDevice::Pad(pad))) = self.device(touch) {
                pad.emit_motion(input.pose.time, button, out);
            }
        }
    }

    fn release_all(&mut self, _: Timestamp, _: &mut DeviceOutput) {
        for (_, device) in &mut self.devices {
            match device {
                TouchDevice::Screen(screen) => screen.reset(),
                TouchDevice::Pad(pad) => pad.reset(),
            }
        }
    }
}

/// The mouse button that a touch surface presses.
#[derive(Clone, Copy, Debug)]
struct MouseButton(TargetId);

impl MouseButton {
    /// Presses the left button.
    fn press(self, time: Timestamp, out: &mut DeviceOutput) -> bool {
        out.press(self.source(), LEFT, time)
    }

    fn release(self, time: Timestamp, out: &mut DeviceOutput) {
        out.release(self.source(), time);
    }

    fn cancel(self, time: Timestamp, out: &mut DeviceOutput) {
        out.cancel(self.source(), time);
    }

    /// Clicks the button of an action.
    fn click(self, action: KeyAction, time: Timestamp, out: &mut DeviceOutput) -> bool {
        out.tap(self.source(), action, time)
    }

    fn source(self) -> PressSource {
        PressSource::Part(self.0, 0)
    }
}

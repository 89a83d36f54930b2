//! Touch surfaces: touch screens, where a place is a place on the screen, and touch pads, where a way is
//! a way of the pointer.

mod touchpad;
mod touchscreen;

pub use self::touchpad::TouchpadSettings;

use parry3d::math::Vec2;

use self::touchpad::Pad;
use self::touchscreen::Screen;
use super::target_index::Places;
use super::{
    Capabilities, Capability, DeviceInput, DeviceOutput, KeyAction, KeyCode, PressSource,
    VirtualDevice,
};
use crate::contact::{TargetId, Touch};
use crate::time::Timestamp;

const LEFT: KeyAction = KeyAction::Key(KeyCode::MOUSE_LEFT);
const RIGHT: KeyAction = KeyAction::Key(KeyCode::MOUSE_RIGHT);

/// One surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchSurface {
    /// The target that is touched, a box.
    pub target: TargetId,
    /// What touching it does.
    pub mode: TouchMode,
}

/// What touching a surface does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TouchMode {
    /// The pointer goes to where the finger is; pressing holds the left mouse button. Of several fingers
    /// the first counts. The surface has these half extents, in metres; beyond its edge the pointer stays
    /// at the edge.
    Touchscreen(Vec2),
    /// One finger moves the pointer, two turn the wheel; a short touch clicks.
    Touchpad(TouchpadSettings),
}

/// The touch surfaces of a layout.
#[derive(Clone, Debug)]
pub struct TouchSurfaces {
    surfaces: Vec<(TargetId, Surface)>,
    places: Places,
}

#[derive(Clone, Debug)]
enum Surface {
    Screen(Screen),
    Pad(Box<Pad>),
}

impl TouchSurfaces {
    /// With no finger on any of them.
    pub fn new(surfaces: Vec<TouchSurface>) -> Self {
        let surface = |surface: TouchSurface| match surface.mode {
            TouchMode::Touchscreen(half) => Surface::Screen(Screen::new(half)),
            TouchMode::Touchpad(settings) => Surface::Pad(Box::new(Pad::new(settings))),
        };
        Self {
            places: Places::new(surfaces.iter().map(|surface| surface.target)),
            surfaces: surfaces
                .into_iter()
                .map(|it| (it.target, surface(it)))
                .collect(),
        }
    }

    fn surface(&mut self, touch: &Touch) -> Option<(Button, &mut Surface)> {
        let (target, surface) = self.surfaces.get_mut(self.places.of(touch.target)?)?;
        Some((Button(*target), surface))
    }
}

impl VirtualDevice for TouchSurfaces {
    fn add_capabilities(&self, needs: &mut Capabilities) {
        for (_, surface) in &self.surfaces {
            needs.insert(Capability::Key(KeyCode::MOUSE_LEFT));
            match surface {
                Surface::Screen(_) => needs.insert(Capability::AbsoluteMotion),
                Surface::Pad(_) => needs.extend([
                    Capability::Key(KeyCode::MOUSE_RIGHT),
                    Capability::RelativeMotion,
                    Capability::Scroll,
                ]),
            }
        }
    }

    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        for touch in seen.touches {
            match self.surface(touch) {
                Some((button, Surface::Screen(screen))) => screen.take(touch, button, out),
                Some((button, Surface::Pad(pad))) => pad.take(touch, button, out),
                None => {}
            }
        }
        // Only now is it known where all fingers of the frame are.
        for touch in seen.touches {
            if let Some((button, Surface::Pad(pad))) = self.surface(touch) {
                pad.follow(seen.pose.time, button, out);
            }
        }
    }

    fn release_all(&mut self, _: Timestamp, _: &mut DeviceOutput) {
        for (_, surface) in &mut self.surfaces {
            match surface {
                Surface::Screen(screen) => screen.forget(),
                Surface::Pad(pad) => pad.forget(),
            }
        }
    }
}

/// The mouse button that a surface presses.
#[derive(Clone, Copy, Debug)]
struct Button(TargetId);

impl Button {
    fn press(self, time: Timestamp, out: &mut DeviceOutput) -> bool {
        out.press(self.owner(), LEFT, time)
    }

    fn end(self, time: Timestamp, out: &mut DeviceOutput) {
        out.release(self.owner(), time);
    }

    fn cancel(self, time: Timestamp, out: &mut DeviceOutput) {
        out.cancel(self.owner(), time);
    }

    fn click(self, action: KeyAction, time: Timestamp, out: &mut DeviceOutput) -> bool {
        out.tap(self.owner(), action, time)
    }

    fn owner(self) -> PressSource {
        PressSource::Part(self.0, 0)
    }
}

//! Touch surfaces: touch screens, where a place is a place on the screen, and touch pads, where a way is
//! a way of the pointer.

mod pad;
mod screen;

pub use self::pad::PadSettings;

use parry3d::math::Vec2;

use self::pad::Pad;
use self::screen::Screen;
use super::places::Places;
use super::{KeyAction, KeyCode, Need, Needs, Out, Owner, Seen, VirtualDevice};
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
    Screen(Vec2),
    /// One finger moves the pointer, two turn the wheel; a short touch clicks.
    Pad(PadSettings),
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
            TouchMode::Screen(half) => Surface::Screen(Screen::new(half)),
            TouchMode::Pad(settings) => Surface::Pad(Box::new(Pad::new(settings))),
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
    fn add_needs(&self, needs: &mut Needs) {
        for (_, surface) in &self.surfaces {
            needs.insert(Need::Code(KeyCode::MOUSE_LEFT));
            match surface {
                Surface::Screen(_) => needs.insert(Need::Place),
                Surface::Pad(_) => {
                    needs.extend([Need::Code(KeyCode::MOUSE_RIGHT), Need::Move, Need::Scroll])
                }
            }
        }
    }

    fn update(&mut self, seen: &Seen, out: &mut Out) {
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

    fn release_all(&mut self, _: Timestamp, _: &mut Out) {
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
    fn press(self, time: Timestamp, out: &mut Out) -> bool {
        out.press(self.owner(), LEFT, time)
    }

    fn end(self, time: Timestamp, out: &mut Out) {
        out.end(self.owner(), time);
    }

    fn cancel(self, time: Timestamp, out: &mut Out) {
        out.cancel(self.owner(), time);
    }

    fn click(self, action: KeyAction, time: Timestamp, out: &mut Out) -> bool {
        out.tap(self.owner(), action, time)
    }

    fn owner(self) -> Owner {
        Owner::Part(self.0, 0)
    }
}

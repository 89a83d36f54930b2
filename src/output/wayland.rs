//! A connection to a Wayland compositor that lets programs be keyboards and pointers: the protocols
//! `zwp_virtual_keyboard_v1` and `zwlr_virtual_pointer_v1`.
//!
//! Keys and characters come from two keyboards: one with the keymap of the seat, so that a key writes what the
//! same key of the user's keyboard does, and one whose keymap has nothing but the character to write. A
//! compositor tells whoever has the focus of the keymap before the key, so no character races with it.
//!
//! When the connection ends, however that comes about, the compositor takes the keyboards away and lets go
//! of their keys, though not of the buttons of the pointer. A guardian has a second handle of it, for a program that is
//! stopped. Nothing is sent on a connection that has failed: what waits in it would arrive twice.

use std::ffi::OsStr;
use std::os::fd::AsFd;
use std::thread;
use std::time::{Duration, Instant};

use enigo::Direction;
use wayland_client::Proxy;
use wayland_client::protocol::wl_pointer::{Axis, AxisSource, ButtonState};
use wayland_protocols_misc::zwp_virtual_keyboard_v1::client::zwp_virtual_keyboard_v1::ZwpVirtualKeyboardV1;
use wayland_protocols_wlr::virtual_pointer::v1::client::zwlr_virtual_pointer_v1::ZwlrVirtualPointerV1;

use super::pending_motion::StatelessAction;
use super::watchdog::ReleaseTarget;
use super::worker::Injector;
use crate::device::{KeyCode, KeyKind};
use keymap::{CHARACTER_KEY, Keymap};
use link::CompositorConnection;

mod keymap;
mod link;

/// Programs hear of a new keyboard some time after the compositor does; keys that come earlier are lost.
const SETTLES: Duration = Duration::from_millis(200);

/// How far the pointer scrolls for a click of the wheel, as `libinput` has it for wheels of 15° a click.
const SCROLL_OF_A_CLICK: f64 = 15.0;

/// The width and height of everything that is on show, in steps of the absolute pointer.
const EXTENT: u32 = 1 << 16;

/// A keyboard, another one for characters, and a pointer where the compositor has it.
pub struct WaylandInjector {
    link: CompositorConnection,
    keys: ZwpVirtualKeyboardV1,
    keymap: Keymap,
    writer: Option<Writer>,
    pointer: Option<ZwlrVirtualPointerV1>,
    start: Instant,
}

/// The keyboard for characters, and the one that it has.
struct Writer {
    keyboard: ZwpVirtualKeyboardV1,
    has: char,
}

/// Connects to the compositor with this name, as `WAYLAND_DISPLAY` has it; the pointer has to be there only when
/// something needs it.
pub fn connect(name: &OsStr, needs_pointer: bool) -> Result<Box<dyn Injector>, String> {
    let mut link = CompositorConnection::open(name)?;
    let keymap = Keymap::of_seat(link.seat_keymap()?)?;
    let keys = link.make_keyboard()?;
    keymap.give_to(&keys);
    let pointer = link.make_pointer(needs_pointer)?;
    link.wait_until_taken()?;
    thread::sleep(SETTLES);
    Ok(Box::new(WaylandInjector {
        link,
        keys,
        keymap,
        writer: None,
        pointer,
        start: Instant::now(),
    }))
}

impl WaylandInjector {
    /// Milliseconds since the connection was made; they begin again after 49 days, as those of others do.
    fn now(&self) -> u32 {
        self.start.elapsed().as_millis() as u32
    }

    fn press_key(&mut self, key: KeyCode, direction: Direction) {
        let state = u32::from(direction == Direction::Press);
        self.keys
            .key(self.now(), u32::from(key.event_code()), state);
        // The compositor leaves it to the keyboard to know what its keys are good for.
        if let Some(modifiers) = self.keymap.modifiers_after(key, direction) {
            let [depressed, latched, locked, group] = modifiers;
            self.keys.modifiers(depressed, latched, locked, group);
        }
    }

    fn press_button(&self, key: KeyCode, direction: Direction) -> Result<(), String> {
        let pointer = self.pointer()?;
        let state = match direction {
            Direction::Press => ButtonState::Pressed,
            Direction::Release | Direction::Click => ButtonState::Released,
        };
        pointer.button(self.now(), u32::from(key.event_code()), state);
        pointer.frame();
        Ok(())
    }

    fn write(&mut self, character: char) -> Result<(), String> {
        let writer = match self.writer.take() {
            Some(writer) if writer.has == character => writer,
            other => {
                let keymap = Keymap::of_character(character)?;
                let keyboard = match other {
                    Some(writer) => writer.keyboard,
                    None => self.link.make_keyboard()?,
                };
                keymap.give_to(&keyboard);
                Writer {
                    keyboard,
                    has: character,
                }
            }
        };
        writer.keyboard.key(self.now(), CHARACTER_KEY, 1);
        writer.keyboard.key(self.now(), CHARACTER_KEY, 0);
        self.writer = Some(writer);
        Ok(())
    }

    fn move_pointer(&self, impulse: StatelessAction) -> Result<(), String> {
        let pointer = self.pointer()?;
        let now = self.now();
        let steps = |share: f32| (share * EXTENT as f32) as u32;
        match impulse {
            StatelessAction::MoveBy(x, y) => pointer.motion(now, f64::from(x), f64::from(y)),
            StatelessAction::MoveTo(x, y) => {
                pointer.motion_absolute(now, steps(x), steps(y), EXTENT, EXTENT);
            }
            StatelessAction::Scroll(right, up) => {
                pointer.axis_source(AxisSource::Wheel);
                turn(pointer, now, Axis::HorizontalScroll, right);
                turn(pointer, now, Axis::VerticalScroll, -up);
            }
            StatelessAction::Write(_) => {}
        }
        pointer.frame();
        Ok(())
    }

    fn pointer(&self) -> Result<&ZwlrVirtualPointerV1, String> {
        self.pointer.as_ref().ok_or_else(link::no_pointer)
    }
}

fn turn(pointer: &ZwlrVirtualPointerV1, now: u32, axis: Axis, clicks: i32) {
    if clicks != 0 {
        let way = f64::from(clicks) * SCROLL_OF_A_CLICK;
        pointer.axis_discrete(now, axis, way, clicks);
    }
}

impl Injector for WaylandInjector {
    fn inject(&mut self, key: KeyCode, direction: Direction) -> Result<(), String> {
        self.link.listen()?;
        match key.kind() {
            KeyKind::Keyboard => self.press_key(key, direction),
            KeyKind::Mouse => self.press_button(key, direction)?,
            KeyKind::Gamepad => return Err("a desktop has no such button".into()),
        }
        self.link.deliver()
    }

    fn perform(&mut self, impulse: StatelessAction) -> Result<(), String> {
        self.link.listen()?;
        match impulse {
            StatelessAction::Write(character) => self.write(character)?,
            motion => self.move_pointer(motion)?,
        }
        self.link.deliver()
    }

    fn release_target(&self) -> ReleaseTarget {
        match self.link.handle() {
            Ok(connection) => {
                ReleaseTarget::WaylandKeyboard(connection, self.keys.id().protocol_id())
            }
            Err(_) => ReleaseTarget::default(),
        }
    }
}

impl Drop for WaylandInjector {
    fn drop(&mut self) {
        let keyboards = self.writer.iter().map(|writer| &writer.keyboard);
        for keyboard in keyboards.chain([&self.keys]) {
            keyboard.destroy();
        }
        if let Some(pointer) = &self.pointer {
            pointer.destroy();
        }
        // A compositor may forget what it has not read when the connection is closed.
        let _ = self.link.wait_until_taken();
    }
}

impl Keymap {
    /// Says which key of a keyboard is good for what.
    fn give_to(&self, keyboard: &ZwpVirtualKeyboardV1) {
        keyboard.keymap(keymap::FORMAT, self.file().as_fd(), self.size());
    }
}

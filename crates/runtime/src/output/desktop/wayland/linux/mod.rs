//! A connection to a Wayland compositor that supports virtual keyboards and pointers, through the protocols
//! `zwp_virtual_keyboard_v1` and `zwlr_virtual_pointer_v1`.
//!
//! Keys and characters come from two keyboards. One has the keymap of the seat, so a key has the meaning that it has
//! on the user's keyboard. The other has a keymap of a single character. A compositor sends the keymap to the focused
//! client before the key, so there is no race between them.
//!
//! When the connection ends, the compositor removes the keyboards and releases their keys, but not the buttons of the
//! pointer. The watchdog has a duplicate of the connection, for a process that is stopped. Nothing is sent on a
//! connection that has failed, as its buffered requests would arrive twice.

use std::ffi::OsStr;
use std::os::fd::AsFd;
use std::thread;
use std::time::{Duration, Instant};

use wayland_client::Proxy;
use wayland_client::protocol::wl_pointer::{Axis, AxisSource, ButtonState};
use wayland_protocols_misc::zwp_virtual_keyboard_v1::client::zwp_virtual_keyboard_v1::ZwpVirtualKeyboardV1;
use wayland_protocols_wlr::virtual_pointer::v1::client::zwlr_virtual_pointer_v1::ZwlrVirtualPointerV1;

use crate::output::desktop::burst::Stroke;
#[cfg(feature = "ime")]
use crate::output::desktop::composing::Composing;
use crate::output::desktop::injector::Injector;
use crate::output::desktop::key_reporter::KeyReporter;
use crate::output::desktop::pending_motion::StatelessAction;
use crate::output::watchdog::ReleaseTarget;
use ademan_core::device::pressed_keys::KeyDirection;
use ademan_core::device::{KeyCode, KeyKind};
use connection::CompositorConnection;
#[cfg(feature = "ime")]
use input_method::InputMethod;
#[cfg(feature = "ime")]
pub use input_method::connect_composing;
use keymap::{CHARACTER_KEY, Keymap};

mod connection;
#[cfg(feature = "ime")]
mod input_method;
mod keymap;

/// Delay until clients know a new keyboard; they miss keys that are pressed earlier.
const KEYBOARD_DELAY: Duration = Duration::from_millis(200);

/// Scroll distance per wheel detent, as `libinput` reports it for wheels with 15° per detent.
const SCROLL_PER_DETENT: f64 = 15.0;

/// Width and height of the output layout in units of the absolute pointer.
const EXTENT: u32 = 1 << 16;

/// A virtual keyboard, a second one for characters, and a virtual pointer if the compositor supports it.
pub struct WaylandInjector {
    connection: CompositorConnection,
    keyboard: ZwpVirtualKeyboardV1,
    keymap: Keymap,
    character_keyboard: Option<CharacterKeyboard>,
    pointer: Option<ZwlrVirtualPointerV1>,
    #[cfg(feature = "ime")]
    input_method: Option<InputMethod>,
    start: Instant,
}

/// The keyboard for characters, and the character of its keymap.
struct CharacterKeyboard {
    keyboard: ZwpVirtualKeyboardV1,
    character: char,
}

/// Connects to the compositor of this name, which has the form of `WAYLAND_DISPLAY`. Fails if the compositor has no
/// virtual keyboard, or no virtual pointer and one is needed.
pub fn connect(name: &OsStr, needs_pointer: bool) -> Result<Box<dyn Injector>, String> {
    WaylandInjector::connect(name, needs_pointer).map(|injector| Box::new(injector) as _)
}

impl WaylandInjector {
    fn connect(name: &OsStr, needs_pointer: bool) -> Result<Self, String> {
        let mut connection = CompositorConnection::open(name)?;
        let keymap = Keymap::from_seat(connection.seat_keymap()?)?;
        let keyboard = connection.create_keyboard();
        keymap.assign_to(&keyboard);
        let pointer = connection.create_pointer(needs_pointer)?;
        connection.roundtrip()?;
        thread::sleep(KEYBOARD_DELAY);
        Ok(Self {
            connection,
            keyboard,
            keymap,
            character_keyboard: None,
            pointer,
            #[cfg(feature = "ime")]
            input_method: None,
            start: Instant::now(),
        })
    }

    /// Returns the time since the connection was made, in milliseconds; it wraps around after 49 days, as event times
    /// of Wayland do.
    fn now(&self) -> u32 {
        self.start.elapsed().as_millis() as u32
    }

    fn inject_key(&mut self, key: KeyCode, direction: KeyDirection) {
        let state = u32::from(direction == KeyDirection::Press);
        self.keyboard
            .key(self.now(), u32::from(key.event_code()), state);
        // The client of a virtual keyboard computes the modifier state; the compositor does not.
        if let Some(modifiers) = self.keymap.update(key, direction) {
            let [depressed, latched, locked, group] = modifiers;
            self.keyboard.modifiers(depressed, latched, locked, group);
        }
    }

    fn inject_button(&self, key: KeyCode, direction: KeyDirection) -> Result<(), String> {
        let pointer = self.pointer()?;
        let state = match direction {
            KeyDirection::Press => ButtonState::Pressed,
            KeyDirection::Release => ButtonState::Released,
        };
        pointer.button(self.now(), u32::from(key.event_code()), state);
        pointer.frame();
        Ok(())
    }

    fn type_character(&mut self, character: char, keymap: &Keymap) {
        let keyboard = match self.character_keyboard.take() {
            Some(keyboard) if keyboard.character == character => keyboard,
            other => {
                let keyboard = other.map(|other| other.keyboard);
                let keyboard = keyboard.unwrap_or_else(|| self.connection.create_keyboard());
                keymap.assign_to(&keyboard);
                CharacterKeyboard {
                    keyboard,
                    character,
                }
            }
        };
        keyboard.keyboard.key(self.now(), CHARACTER_KEY, 1);
        keyboard.keyboard.key(self.now(), CHARACTER_KEY, 0);
        self.character_keyboard = Some(keyboard);
    }

    fn move_pointer(&self, action: StatelessAction) -> Result<(), String> {
        let pointer = self.pointer()?;
        let now = self.now();
        let units = |fraction: f32| (fraction * EXTENT as f32) as u32;
        match action {
            StatelessAction::MoveBy(x, y) => pointer.motion(now, f64::from(x), f64::from(y)),
            StatelessAction::MoveTo(x, y) => {
                pointer.motion_absolute(now, units(x), units(y), EXTENT, EXTENT);
            }
            StatelessAction::Scroll(right, up) => {
                pointer.axis_source(AxisSource::Wheel);
                scroll(pointer, now, Axis::HorizontalScroll, right);
                scroll(pointer, now, Axis::VerticalScroll, -up);
            }
        }
        pointer.frame();
        Ok(())
    }

    fn pointer(&self) -> Result<&ZwlrVirtualPointerV1, String> {
        self.pointer.as_ref().ok_or_else(connection::no_pointer)
    }
}

fn scroll(pointer: &ZwlrVirtualPointerV1, now: u32, axis: Axis, detents: i32) {
    if detents != 0 {
        let distance = f64::from(detents) * SCROLL_PER_DETENT;
        pointer.axis_discrete(now, axis, distance, detents);
    }
}

impl Injector for WaylandInjector {
    fn inject(&mut self, key: KeyCode, direction: KeyDirection) -> Result<(), String> {
        self.connection.dispatch()?;
        match key.kind() {
            KeyKind::Keyboard => self.inject_key(key, direction),
            KeyKind::Mouse => self.inject_button(key, direction)?,
            KeyKind::Gamepad => return Err("a desktop has no such button".into()),
        }
        self.connection.flush()
    }

    fn perform(&mut self, action: StatelessAction) -> Result<(), String> {
        self.connection.dispatch()?;
        self.move_pointer(action)?;
        self.connection.flush()
    }

    fn check_connection(&mut self) -> Result<(), String> {
        self.connection.dispatch()
    }

    fn type_burst(&mut self, burst: &[Stroke], _: &mut KeyReporter) -> Result<bool, String> {
        self.connection.dispatch()?;
        let keymaps: Result<Vec<_>, _> = burst
            .iter()
            .map(|stroke| stroke.character().map(Keymap::from_character).transpose())
            .collect();
        let Ok(keymaps) = keymaps else {
            return Ok(false);
        };
        for (stroke, keymap) in burst.iter().zip(&keymaps) {
            match (*stroke, keymap) {
                (Stroke::Key(key, direction), _) => self.inject_key(key, direction),
                (Stroke::Character(character), Some(keymap)) => {
                    self.type_character(character, keymap);
                    // The connection holds a few file descriptors only.
                    self.connection.flush()?;
                }
                (Stroke::Character(_), None) => {}
            }
        }
        self.connection.flush()?;
        Ok(true)
    }

    #[cfg(feature = "ime")]
    fn compose(&mut self, composing: &Composing) -> Result<bool, String> {
        self.connection.dispatch()?;
        let input_method = self.input_method.as_ref();
        input_method.map_or(Ok(false), |input_method| input_method.compose(composing))
    }

    fn wait_until_responsive(&mut self) -> Result<(), String> {
        self.connection.roundtrip()
    }

    fn release_target(&self) -> ReleaseTarget {
        match self.connection.try_clone_fd() {
            Ok(connection) => {
                ReleaseTarget::WaylandKeyboard(connection, self.keyboard.id().protocol_id())
            }
            Err(_) => ReleaseTarget::default(),
        }
    }
}

impl Drop for WaylandInjector {
    fn drop(&mut self) {
        let keyboards = self.character_keyboard.iter();
        let keyboards = keyboards.map(|keyboard| &keyboard.keyboard);
        for keyboard in keyboards.chain([&self.keyboard]) {
            keyboard.destroy();
        }
        if let Some(pointer) = &self.pointer {
            pointer.destroy();
        }
        // A compositor may discard what it has not read when the connection is closed.
        let _ = self.connection.roundtrip();
    }
}

impl Keymap {
    /// Sends the keymap for a virtual keyboard.
    fn assign_to(&self, keyboard: &ZwpVirtualKeyboardV1) {
        keyboard.keymap(keymap::FORMAT, self.file().as_fd(), self.size());
    }
}

//! A connection to an X server that injects keys through the extension XTEST.
//!
//! The connection is impervious to grabs of the server (`XTestGrabControl`). A screen locker, a window manager or a
//! screenshot tool that grabs the server would otherwise delay a release, and the key would repeat until the grab ends.

mod characters;
mod device_watch;
mod direct;
mod focus_watch;
mod keymap;

use std::ops::RangeInclusive;

use x11rb::connection::Connection;
use x11rb::errors::ReplyError;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ConnectionExt as _, KEY_PRESS_EVENT,
    KEY_RELEASE_EVENT, KeyButMask, MOTION_NOTIFY_EVENT,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

use crate::advice;
use crate::output::character_key::CharacterKey;
use crate::output::desktop::burst::{self, Stroke};
use crate::output::desktop::direct_keys::DirectConnection;
use crate::output::desktop::injector::{Injector, WindowId};
use crate::output::desktop::key_reporter::KeyReporter;
use crate::output::desktop::pending_motion::StatelessAction;
use crate::output::desktop::system;
use ademan_core::device::pressed_keys::{KeyDirection, PressedKeys};
use ademan_core::device::{KeyCode, KeyKind};
use characters::CharacterKeys;
use device_watch::DeviceWatch;
use focus_watch::FocusWatch;

/// The version of XTEST that has `XTestGrabControl`.
const XTEST_VERSION: (u8, u16) = (2, 2);

/// Wheel detents are clicks of these buttons.
const WHEEL_UP: u8 = 4;
const WHEEL_DOWN: u8 = 5;
const WHEEL_LEFT: u8 = 6;
const WHEEL_RIGHT: u8 = 7;

/// Buttons whose state `QueryPointer` reports.
const QUERIED_BUTTONS: RangeInclusive<u8> = 1..=5;

/// Values of the detail field of a motion.
const ABSOLUTE: u8 = 0;
const RELATIVE: u8 = 1;

/// A connection to an X server.
pub struct X11Injector {
    name: Option<String>,
    server: RustConnection,
    root: u32,
    character_keys: CharacterKeys,
    focus_watch: Option<FocusWatch>,
    /// The window that had the focus at the last wait.
    focus: Option<WindowId>,
    device_watch: Option<DeviceWatch>,
}

/// Connects to the X server of this name, or to the server in `DISPLAY`.
pub fn connect(name: Option<&str>) -> Result<Box<dyn Injector>, String> {
    let (server, screen) = x11rb::connect(name).map_err(|error| {
        let refusal = advice::refused_by_display(&error);
        refusal.map_or_else(|| system::no_display(name), |advice| advice.to_string())
    })?;
    let (major, minor) = XTEST_VERSION;
    let version = server.xtest_get_version(major, minor);
    version
        .map_err(ReplyError::from)
        .and_then(|version| version.reply())
        .map_err(|error| format!("the X server has no extension XTEST ({error}); enable it"))?;
    ignore_grabs(&server).map_err(message)?;
    let injector = X11Injector {
        name: name.map(str::to_owned),
        root: server.setup().roots[screen].root,
        character_keys: CharacterKeys::new(&server),
        focus_watch: None,
        focus: None,
        device_watch: None,
        server,
    };
    Ok(Box::new(injector))
}

/// Exempts a connection from grabs of the server by other clients.
fn ignore_grabs(server: &RustConnection) -> Result<(), ReplyError> {
    server.xtest_grab_control(true)?.check()
}

impl X11Injector {
    /// Sends an input event and waits until the server has executed it.
    fn fake(&self, kind: u8, detail: u8) -> Result<(), ReplyError> {
        self.discard_events()?;
        let event = self
            .server
            .xtest_fake_input(kind, detail, 0, self.root, 0, 0, 0)?;
        event.check()
    }

    /// Sends input events, all in one write, and waits until the server has executed them: if this process is killed, the
    /// server executes all or none.
    fn fake_all(&self, inputs: impl IntoIterator<Item = (u8, u8)>) -> Result<(), ReplyError> {
        let mut events = Vec::new();
        for (kind, detail) in inputs {
            let event = self
                .server
                .xtest_fake_input(kind, detail, 0, self.root, 0, 0, 0)?;
            events.push(event);
        }
        events.into_iter().try_for_each(|event| event.check())
    }

    /// Clicks a button `count` times, if the pointer of the server has it.
    fn click(&self, button: u8, count: u32) -> Result<(), ReplyError> {
        let click = [BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT].map(|kind| (kind, button));
        match self.fake_all((0..count).flat_map(|_| click)) {
            Err(ReplyError::X11Error(_)) => Ok(()),
            clicked => clicked,
        }
    }

    /// Returns the key codes of the characters of a burst, which it adds to the keymap where they are missing. Returns `None` if
    /// the server cannot type all of them now.
    fn character_codes(
        &mut self,
        burst: &[Stroke],
        reporter: &mut KeyReporter,
    ) -> Result<Option<Vec<u8>>, ReplyError> {
        let text = burst::text(burst);
        if text.is_empty() {
            return Ok(Some(Vec::new()));
        }
        let keys = &mut self.character_keys;
        keys.prepare(&self.server, self.root, &text, reporter)
    }

    /// Releases a key that types a character, in case the process that pressed it was killed, and removes it from the keymap.
    fn remove_character_key(&self, key: CharacterKey) -> Result<(), ReplyError> {
        let bits = self.server.query_keymap()?.reply()?.keys;
        if keymap::is_pressed(&bits, key.code) {
            self.fake(KEY_RELEASE_EVENT, key.code)?;
        }
        keymap::remove(&self.server, key)
    }

    fn move_pointer(&self, detail: u8, x: i16, y: i16) -> Result<(), ReplyError> {
        let (kind, none) = (MOTION_NOTIFY_EVENT, x11rb::NONE);
        let event = self
            .server
            .xtest_fake_input(kind, detail, 0, none, x, y, 0)?;
        event.check()
    }

    fn move_to(&self, x: f32, y: f32) -> Result<(), ReplyError> {
        // Queried each time, as the size of the screen changes with its monitors.
        let screen = self.server.get_geometry(self.root)?.reply()?;
        let pixel = |fraction: f32, size: u16| (fraction * (f32::from(size) - 1.0)).round() as i16;
        self.move_pointer(ABSOLUTE, pixel(x, screen.width), pixel(y, screen.height))
    }

    fn scroll(&self, right: i32, up: i32) -> Result<(), ReplyError> {
        let horizontal = if right > 0 { WHEEL_RIGHT } else { WHEEL_LEFT };
        let vertical = if up > 0 { WHEEL_UP } else { WHEEL_DOWN };
        self.click(horizontal, right.unsigned_abs())?;
        self.click(vertical, up.unsigned_abs())
    }

    /// Waits until the server has executed all requests.
    fn wait(&mut self) -> Result<(), ReplyError> {
        self.focus = Some(self.server.get_input_focus()?.reply()?.focus);
        // The server has sent all events of the time before its reply.
        self.discard_events()
    }

    /// Discards events, but for the presses of other devices: a server sends changes of the keymap to every client, and the library
    /// would collect them.
    fn discard_events(&self) -> Result<(), ReplyError> {
        while let Some(event) = self.server.poll_for_event()? {
            if let Some(watch) = &self.device_watch {
                watch.observe(&event);
            }
        }
        Ok(())
    }

    /// Returns the pressed ones among `keys`. A button whose state the server does not report counts as pressed.
    fn pressed_among(&self, keys: &PressedKeys) -> Result<PressedKeys, ReplyError> {
        let bits = self.server.query_keymap()?.reply()?.keys;
        let buttons = u16::from(self.server.query_pointer(self.root)?.reply()?.mask);
        let first_button = u16::from(KeyButMask::BUTTON1);
        let has = |key: &KeyCode| match input(*key) {
            Ok(Input::Key(code)) => keymap::is_pressed(&bits, code),
            Ok(Input::Button(button)) if QUERIED_BUTTONS.contains(&button) => {
                buttons & first_button << (button - 1) != 0
            }
            Ok(Input::Button(_)) => true,
            Err(_) => false,
        };
        let mut pressed = PressedKeys::default();
        let mut pressed_keys: Vec<_> = keys.release_order().filter(has).collect();
        pressed_keys.reverse();
        for key in pressed_keys {
            pressed.press(key);
        }
        Ok(pressed)
    }
}

impl Injector for X11Injector {
    fn inject(&mut self, key: KeyCode, direction: KeyDirection) -> Result<(), String> {
        let (kind, detail) = fake_input(key, direction)?;
        self.fake(kind, detail).map_err(message)
    }

    fn perform(&mut self, action: StatelessAction) -> Result<(), String> {
        let performed = match action {
            StatelessAction::MoveBy(x, y) => self.move_pointer(RELATIVE, x as i16, y as i16),
            StatelessAction::MoveTo(x, y) => self.move_to(x, y),
            StatelessAction::Scroll(right, up) => self.scroll(right, up),
        };
        performed
            .and_then(|()| self.discard_events())
            .map_err(message)
    }

    fn check_connection(&mut self) -> Result<(), String> {
        self.discard_events().map_err(message)
    }

    fn type_burst(&mut self, burst: &[Stroke], reporter: &mut KeyReporter) -> Result<bool, String> {
        let Some(codes) = self.character_codes(burst, reporter).map_err(message)? else {
            return self.discard_events().map_err(message).map(|()| false);
        };
        let inputs = inputs(burst, &codes)?;
        let keys = keys_with_codes(&codes);
        // The server may have read a press and not the release when this process is killed.
        let is_reported = keys
            .release_order()
            .all(|key| reporter.report(key, KeyDirection::Press));
        let executed = if is_reported {
            self.character_keys.note_use(&codes);
            self.fake_all(inputs)
                .and_then(|()| self.discard_events())
                .map_err(message)?;
            true
        } else {
            false
        };
        for key in keys.release_order() {
            reporter.report(key, KeyDirection::Release);
        }
        Ok(executed)
    }

    fn restore_keymap(&mut self, reporter: &mut KeyReporter) {
        // A server that is gone has no keymap to restore.
        let _ = self.character_keys.restore(&self.server, reporter);
    }

    fn remove_character_keys(&mut self, keys: &[CharacterKey]) -> Result<(), String> {
        let mut keys = keys.iter();
        keys.try_for_each(|key| self.remove_character_key(*key))
            .and_then(|()| self.discard_events())
            .map_err(message)
    }

    fn wait_until_responsive(&mut self) -> Result<(), String> {
        self.wait().map_err(message)
    }

    fn watch_focus(&mut self) {
        self.focus_watch = FocusWatch::open(self.name.as_deref());
        self.device_watch = Some(DeviceWatch::new(&self.server));
    }

    fn focus(&self) -> Option<WindowId> {
        self.focus
    }

    fn poll_focus(&mut self) -> Option<WindowId> {
        self.focus_watch.as_mut()?.poll()
    }

    fn poll_foreign_press(&mut self) -> bool {
        let Some(watch) = &mut self.device_watch else {
            return false;
        };
        // A connection that has failed shows at the next check.
        let _ = watch.start(&self.server, self.root);
        let _ = self.discard_events();
        self.device_watch
            .as_ref()
            .is_some_and(DeviceWatch::take_press)
    }

    fn open_direct_connection(&mut self) -> Option<DirectConnection> {
        direct::open(self.name.as_deref())
    }

    fn query_pressed(&mut self, keys: &PressedKeys) -> Result<Option<PressedKeys>, String> {
        self.pressed_among(keys).map(Some).map_err(message)
    }
}

/// A key or button as the server numbers it.
enum Input {
    Key(u8),
    Button(u8),
}

fn input(key: KeyCode) -> Result<Input, String> {
    if key.kind() == KeyKind::Keyboard {
        let code = u8::try_from(key.x11_code());
        return code
            .map(Input::Key)
            .map_err(|_| format!("an X server has no key {key}; remove it from the layout"));
    }
    Ok(Input::Button(match key.name() {
        "MouseLeft" => 1,
        "MouseMiddle" => 2,
        "MouseRight" => 3,
        "MouseBack" => 8,
        "MouseForward" => 9,
        _ => return Err("a desktop has no such button; remove it from the layout".into()),
    }))
}

/// Returns the kind and the detail of the event that presses or releases a key.
fn fake_input(key: KeyCode, direction: KeyDirection) -> Result<(u8, u8), String> {
    let is_press = direction == KeyDirection::Press;
    Ok(match (input(key)?, is_press) {
        (Input::Key(code), true) => (KEY_PRESS_EVENT, code),
        (Input::Key(code), false) => (KEY_RELEASE_EVENT, code),
        (Input::Button(button), true) => (BUTTON_PRESS_EVENT, button),
        (Input::Button(button), false) => (BUTTON_RELEASE_EVENT, button),
    })
}

/// Returns the keys with these codes. A code of no key is of one that was added to the keymap, which the watchdog knows.
fn keys_with_codes(codes: &[u8]) -> PressedKeys {
    let mut keys = PressedKeys::default();
    let known = codes
        .iter()
        .filter_map(|code| KeyCode::from_x11_code(*code));
    known.for_each(|key| _ = keys.press(key));
    keys
}

/// Returns the kinds and details of the events that execute a burst, whose characters have these key codes.
fn inputs(burst: &[Stroke], codes: &[u8]) -> Result<Vec<(u8, u8)>, String> {
    let mut inputs = Vec::with_capacity(2 * burst.len());
    let mut codes = codes.iter();
    for stroke in burst {
        match *stroke {
            Stroke::Key(key, direction) => inputs.push(fake_input(key, direction)?),
            Stroke::Character(_) => {
                let kinds = [KEY_PRESS_EVENT, KEY_RELEASE_EVENT];
                if let Some(code) = codes.next() {
                    inputs.extend(kinds.map(|kind| (kind, *code)));
                }
            }
        }
    }
    Ok(inputs)
}

fn message(error: ReplyError) -> String {
    match error {
        ReplyError::ConnectionError(error) => {
            format!("the connection to the X server failed: {error}; check that it runs")
        }
        ReplyError::X11Error(error) => format!("the X server rejected a request: {error:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read, Write};
    use std::net::TcpListener;
    use std::thread;

    /// Returns the error of a connection to a server that refuses it for this reason.
    fn refused_connection(reason: &str) -> String {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        // Display 0 is port 6000.
        let display = listener.local_addr().unwrap().port() - 6000;
        let words = reason.len().div_ceil(4);
        let mut refusal = vec![0, reason.len() as u8];
        refusal.extend([11, 0, words as u16].map(u16::to_ne_bytes).concat());
        refusal.extend(reason.as_bytes());
        refusal.resize(8 + words * 4, 0);
        let server = thread::spawn(move || {
            let (mut client, _) = listener.accept().unwrap();
            client.read_exact(&mut [0; 12]).unwrap();
            client.write_all(&refusal).unwrap();
        });
        let error = connect(Some(&format!("127.0.0.1:{display}"))).err();
        let error = error.expect("a refusal");
        server.join().unwrap();
        error
    }

    #[test]
    fn a_server_that_refuses_the_connection_is_not_missing() {
        let unauthorized = refused_connection("No authorization\n...");
        let expected = "the X server refuses the connection: No authorization\\n...; start this as";
        assert!(unauthorized.starts_with(expected), "{unauthorized}");
        let full = refused_connection("Maximum number of clients reached");
        let clients = "the X server refuses the connection: Maximum number of clients reached; close a program that uses it";
        assert_eq!(full, clients);
    }
}

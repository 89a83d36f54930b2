//! A key on an X server, and a client that receives it.

use std::os::unix::process::CommandExt;
use std::process::Command;
use std::sync::Arc;
use std::thread;
use std::time::Instant;

use ademan::device::{Capabilities, EventKind, KeyCode, OutputEvent};
use ademan::output::Sink;
use ademan::output::desktop::Desktop;
use ademan::output::watchdog::WatchdogSettings;
use ademan::time::Timestamp;
use crossbeam_channel::{Sender, bounded};
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    ConnectionExt as _, CreateWindowAux, EventMask, InputFocus, KEY_PRESS_EVENT, KEY_RELEASE_EVENT,
    WindowClass,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

use super::programs::{Output, Writer};
use super::support::x11::{XServer, wait_for};

/// The argument with which this program starts itself as the watchdog of an output, before its display.
pub const WATCHDOG: &str = "--watchdog";

/// The X11 key codes of A and S. A pressed key cannot be pressed again, so each program has its own.
const PLAIN_KEYS: [u8; 2] = [38, 39];

/// The keys of the output `desktop`.
const KEYS: [&str; 2] = ["D", "F"];

/// Starts an X server and opens its writers. Returns `None` if it is not installed.
pub fn output() -> Option<Output> {
    let server = XServer::start()?;
    let (done, arrivals) = bounded(16);
    listen(server.display(), done);
    let display = server.display().to_owned();
    let plain = |key| -> Box<dyn Writer> {
        let (connection, _) = x11rb::connect(Some(&display)).expect("the server answers");
        Box::new(Plain {
            connection,
            key,
            is_pressed: false,
        })
    };
    let server = Arc::new(server);
    let watchdog = WatchdogSettings {
        program: std::env::current_exe().expect("this program has a path"),
        arguments: vec![WATCHDOG.into(), display.clone().into()],
        on_lost: Arc::new(|| {}),
    };
    let ours = |key: &str| -> Box<dyn Writer> {
        let required = Capabilities::default();
        let desktop = Desktop::open_with_watchdog(Some(&display), Some(&watchdog), &required);
        Box::new(Ours {
            desktop: desktop.expect("the server answers"),
            key: key.parse().expect("a key"),
            is_pressed: false,
            _server: Arc::clone(&server),
        })
    };
    let writers = PLAIN_KEYS.map(plain).into_iter().chain(KEYS.map(ours));
    Some(Output {
        name: "a client of an X server",
        writers: writers.collect(),
        arrivals,
    })
}

/// Becomes the watchdog of an output on this display: the program with another environment.
pub fn become_watchdog(display: &str) -> ! {
    let error = Command::new(env!("CARGO_BIN_EXE_ademan"))
        .arg("watchdog")
        .env("DISPLAY", display)
        .env_remove("WAYLAND_DISPLAY")
        .exec();
    panic!("the watchdog does not start: {error}");
}

/// Reports the time of each key event.
fn listen(display: &str, done: Sender<Instant>) {
    let (connection, screen) = x11rb::connect(Some(display)).expect("the server answers");
    let root = connection.setup().roots[screen].root;
    let window = connection.generate_id().expect("an id for the window");
    let settings = CreateWindowAux::new()
        .override_redirect(1)
        .event_mask(EventMask::KEY_PRESS | EventMask::KEY_RELEASE);
    let (depth, visual) = (x11rb::COPY_DEPTH_FROM_PARENT, x11rb::COPY_FROM_PARENT);
    let class = WindowClass::INPUT_OUTPUT;
    connection
        .create_window(depth, window, root, 0, 0, 9, 9, 0, class, visual, &settings)
        .expect("the server runs");
    connection.map_window(window).expect("the server runs");
    let has_focus = wait_for(|| {
        let focus = connection.set_input_focus(InputFocus::PARENT, window, x11rb::CURRENT_TIME);
        focus.expect("the server runs").check().is_ok()
    });
    assert!(has_focus, "a visible window can have the focus");
    thread::spawn(move || {
        while let Ok(event) = connection.wait_for_event() {
            let end = Instant::now();
            if matches!(event, Event::KeyPress(_) | Event::KeyRelease(_)) {
                let _ = done.try_send(end);
            }
        }
    });
}

/// The minimum: one request.
struct Plain {
    connection: RustConnection,
    key: u8,
    is_pressed: bool,
}

impl Writer for Plain {
    fn write(&mut self) {
        self.is_pressed = !self.is_pressed;
        let kind = if self.is_pressed {
            KEY_PRESS_EVENT
        } else {
            KEY_RELEASE_EVENT
        };
        let root = self.connection.setup().roots[0].root;
        self.connection
            .xtest_fake_input(kind, self.key, x11rb::CURRENT_TIME, root, 0, 0, 0)
            .expect("the server runs");
        self.connection.flush().expect("the server runs");
    }
}

/// The output `desktop`, with its watchdog.
struct Ours {
    desktop: Desktop,
    key: KeyCode,
    is_pressed: bool,
    _server: Arc<XServer>,
}

impl Ours {
    fn set(&mut self, is_pressed: bool) {
        self.is_pressed = is_pressed;
        let kind = if is_pressed {
            EventKind::KeyDown(self.key)
        } else {
            EventKind::KeyUp(self.key)
        };
        let time = Timestamp(0);
        let sent = self.desktop.send(&[OutputEvent { time, kind }]);
        sent.expect("the server runs");
    }
}

impl Writer for Ours {
    fn write(&mut self) {
        if self.desktop.has_stalled() {
            // A session releases everything then; otherwise the output would drop all later presses.
            self.desktop.void_presses();
            self.set(false);
        }
        self.set(!self.is_pressed);
    }
}

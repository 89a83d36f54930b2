//! An X server for one test, a terminal and a window that receive input, and queries of the state of keyboard and pointer.

use std::fs;
use std::io::{BufRead, BufReader, ErrorKind};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use tempfile::TempDir;
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ButtonPressEvent, ConnectionExt, CreateWindowAux,
    EventMask, InputFocus, KeyButMask, MOTION_NOTIFY_EVENT, MapState, QueryPointerReply, Window,
    WindowClass,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

use super::process::{Process, signal};

/// Longest time for anything on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Polls `condition` until it is `true`. Returns `false` after 60 s.
pub fn wait_for(condition: impl FnMut() -> bool) -> bool {
    wait_at_most(TIMEOUT, condition)
}

/// Polls `condition` until it is `true`. Returns `false` after the time-out.
pub fn wait_at_most(timeout: Duration, mut condition: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed() < timeout {
        if condition() {
            return true;
        }
        thread::sleep(Duration::from_millis(5));
    }
    false
}

/// `Xvfb` with a client that queries it.
///
/// The server does not reset when its last client disconnects: a reset would release stuck keys and hide the fault.
pub struct XServer {
    client: RustConnection,
    display: String,
    process: Process,
}

impl XServer {
    /// Starts a server on a free display. Returns `None` with a message if Xvfb is not installed.
    pub fn start() -> Option<Self> {
        Self::with_screen("800x600x24")
    }

    /// Starts a server with a screen of this width, height and depth.
    pub fn with_screen(screen: &str) -> Option<Self> {
        let arguments = "-displayfd 1 -noreset -nolisten tcp -screen 0";
        let mut command = Command::new("Xvfb");
        command
            .args(arguments.split(' ').chain([screen]))
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut process = match Process::start(&mut command) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                println!("SKIPPED: Xvfb is not installed");
                return None;
            }
            started => started.expect("Xvfb starts"),
        };
        let stdout = process.0.stdout.take().expect("stdout is piped");
        let mut number = String::new();
        BufReader::new(stdout)
            .read_line(&mut number)
            .expect("Xvfb writes the number of its display");
        let display = format!(":{}", number.trim());
        let (client, _) = x11rb::connect(Some(&display)).expect("the server answers");
        Some(Self {
            client,
            display,
            process,
        })
    }

    /// Returns the name of the display.
    pub fn display(&self) -> &str {
        &self.display
    }

    /// Returns the X11 key codes of the pressed keys.
    pub fn pressed_keys(&self) -> Vec<u16> {
        let reply = self.client.query_keymap().expect("the server runs");
        let bits = reply.reply().expect("the server answers").keys;
        let is_pressed = |code: &u16| bits[usize::from(code / 8)] & (1 << (code % 8)) != 0;
        (0..256).filter(is_pressed).collect()
    }

    /// Waits until exactly these keys are pressed. Returns `false` after the time-out.
    pub fn wait_for_keys(&self, codes: &[u16]) -> bool {
        wait_for(|| self.pressed_keys() == codes)
    }

    /// Returns the position of the pointer, in pixels from the left and from the top.
    pub fn pointer(&self) -> (i16, i16) {
        let reply = self.query_pointer();
        (reply.root_x, reply.root_y)
    }

    /// Waits until the pointer is at this position. Returns `false` after the time-out.
    pub fn wait_for_pointer(&self, position: (i16, i16)) -> bool {
        wait_for(|| self.pointer() == position)
    }

    /// Returns the pressed buttons among left (1), middle (2) and right (3).
    pub fn pressed_buttons(&self) -> Vec<u8> {
        let mask = u16::from(self.query_pointer().mask);
        let is_pressed = |button: &u8| mask & (u16::from(KeyButMask::BUTTON1) << (button - 1)) != 0;
        (1..=3).filter(is_pressed).collect()
    }

    fn query_pointer(&self) -> QueryPointerReply {
        let root = self.client.setup().roots[0].root;
        let reply = self.client.query_pointer(root);
        let reply = reply.expect("the server runs").reply();
        reply.expect("the server answers")
    }

    /// Moves the pointer to a position, in pixels from the left and from the top, and clicks with the left button.
    pub fn click(&self, x: i16, y: i16) {
        let root = self.client.setup().roots[0].root;
        for (event, button) in [
            (MOTION_NOTIFY_EVENT, 0),
            (BUTTON_PRESS_EVENT, 1),
            (BUTTON_RELEASE_EVENT, 1),
        ] {
            let fake = self
                .client
                .xtest_fake_input(event, button, 0, root, x, y, 0);
            let fake = fake.expect("the server runs").check();
            fake.expect("the server has XTEST");
        }
    }

    /// Kills the server.
    pub fn kill(&mut self) {
        self.process.0.kill().expect("the server runs");
        self.process.0.wait().expect("the server exits");
    }

    /// Grabs the server for the client of this test, as a screen locker does: requests of other clients wait.
    pub fn grab(&self) {
        let grab = self.client.grab_server().expect("the server runs");
        grab.check().expect("no other client has a grab");
    }

    /// Ends the grab.
    pub fn ungrab(&self) {
        let ungrab = self.client.ungrab_server().expect("the server runs");
        ungrab.check().expect("the server answers");
    }

    /// Stops the server and waits until it stands still; requests wait until it [continues](Self::thaw).
    pub fn freeze(&self) {
        let process = self.process.0.id();
        signal("STOP", process);
        let is_stopped = || {
            let stat = fs::read_to_string(format!("/proc/{process}/stat"));
            stat.is_ok_and(|stat| stat.contains(") T "))
        };
        assert!(wait_for(is_stopped), "the server stops");
    }

    /// Continues the server.
    pub fn thaw(&self) {
        signal("CONT", self.process.0.id());
    }

    fn windows(&self) -> Vec<Window> {
        let root = self.client.setup().roots[0].root;
        let tree = self.client.query_tree(root).expect("the server runs");
        tree.reply().expect("the server answers").children
    }

    fn is_visible(&self, window: Window) -> bool {
        self.client
            .get_window_attributes(window)
            .ok()
            .and_then(|attributes| attributes.reply().ok())
            .is_some_and(|attributes| attributes.map_state == MapState::VIEWABLE)
    }

    /// Waits until a window is visible, and gives it the focus.
    pub fn focus_visible_window(&self) {
        let visible = || {
            let mut windows = self.windows().into_iter();
            windows.rfind(|window| self.is_visible(*window))
        };
        assert!(wait_for(|| visible().is_some()), "no visible window");
        self.focus(visible().expect("a visible window"));
    }

    fn focus(&self, window: Window) {
        let time = x11rb::CURRENT_TIME;
        self.client
            .set_input_focus(InputFocus::PARENT, window, time)
            .expect("the server runs")
            .check()
            .expect("a visible window can have the focus");
    }
}

/// A window over the whole screen that has the focus and receives all events of keyboard and mouse.
///
/// A grab of another client hides events from it; a [`KeyLog`](super::key_log::KeyLog) has them all.
pub struct InputWindow {
    connection: RustConnection,
}

impl InputWindow {
    /// Opens a window.
    pub fn open(server: &XServer) -> Self {
        let (connection, screen) =
            x11rb::connect(Some(server.display())).expect("the server answers");
        let root = &connection.setup().roots[screen];
        let window = connection.generate_id().expect("an id for it");
        let received = EventMask::KEY_PRESS
            | EventMask::KEY_RELEASE
            | EventMask::BUTTON_PRESS
            | EventMask::BUTTON_RELEASE
            | EventMask::POINTER_MOTION;
        let (width, height) = (root.width_in_pixels, root.height_in_pixels);
        let settings = CreateWindowAux::new()
            .override_redirect(1)
            .event_mask(received);
        connection
            .create_window(
                x11rb::COPY_DEPTH_FROM_PARENT,
                window,
                root.root,
                0,
                0,
                width,
                height,
                0,
                WindowClass::INPUT_OUTPUT,
                x11rb::COPY_FROM_PARENT,
                &settings,
            )
            .expect("the server runs");
        connection.map_window(window).expect("the server runs");
        connection.flush().expect("the server runs");
        assert!(
            wait_for(|| server.is_visible(window)),
            "the window is visible"
        );
        server.focus(window);
        Self { connection }
    }

    /// Returns the codes of the keys that were pressed since the previous call.
    pub fn pressed_keys(&self) -> Vec<u8> {
        let focus = self.connection.get_input_focus().expect("the server runs");
        focus.reply().expect("the server answers");
        let mut next = || self.connection.poll_for_event().expect("the server runs");
        let events = std::iter::from_fn(&mut next);
        let code = |event| match event {
            Event::KeyPress(press) => Some(press.detail),
            _ => None,
        };
        events.filter_map(code).collect()
    }

    /// Waits for the event `last` and returns all events since the previous call: `down 1 at 3,4`, `up 1 at 3,4`,
    /// `move to 3,4` and, with the left button pressed, `drag to 3,4`.
    pub fn events_until(&self, last: &str) -> Vec<String> {
        let mut events = Vec::new();
        wait_for(|| {
            while let Some(event) = self.connection.poll_for_event().expect("the server runs") {
                events.extend(describe(&event));
            }
            events.last().is_some_and(|line| line == last)
        });
        events
    }
}

fn describe(event: &Event) -> Option<String> {
    let button = |what: &str, press: &ButtonPressEvent| {
        let (x, y) = (press.event_x, press.event_y);
        Some(format!("{what} {} at {x},{y}", press.detail))
    };
    match event {
        Event::ButtonPress(event) => button("down", event),
        Event::ButtonRelease(event) => button("up", event),
        Event::MotionNotify(event) => {
            let is_drag = event.state.contains(KeyButMask::BUTTON1);
            let what = if is_drag { "drag" } else { "move" };
            Some(format!("{what} to {},{}", event.event_x, event.event_y))
        }
        _ => None,
    }
}

/// An `xterm` that has the focus and writes the typed bytes to a file.
pub struct TerminalWindow {
    folder: TempDir,
    _process: Process,
}

impl TerminalWindow {
    /// Starts a terminal. Returns `None` with a message if xterm is not installed.
    pub fn start(server: &XServer) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        let script = "stty -icanon -echo; exec cat > typed";
        let mut command = Command::new("xterm");
        command
            .args(["-u8", "-e", "sh", "-c", script])
            .env("DISPLAY", server.display())
            .env("LC_ALL", "C.UTF-8")
            .current_dir(folder.path())
            .stderr(Stdio::null());
        let process = match Process::start(&mut command) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                println!("SKIPPED: xterm is not installed");
                return None;
            }
            started => started.expect("xterm starts"),
        };
        let terminal = Self {
            folder,
            _process: process,
        };
        assert!(
            wait_for(|| terminal.path("typed").exists()),
            "xterm runs its script"
        );
        server.focus_visible_window();
        Some(terminal)
    }

    /// Waits until as many bytes as in `expected` are typed, and returns the typed text.
    pub fn typed(&self, expected: &str) -> String {
        let typed = || fs::read(self.path("typed")).unwrap_or_default();
        wait_for(|| typed().len() >= expected.len());
        String::from_utf8_lossy(&typed()).into_owned()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

//! An X server of the test's own, a program that takes keys, a window that takes what a mouse does, and
//! somebody who watches keyboard and pointer.

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
    ButtonPressEvent, ConnectionExt, CreateWindowAux, EventMask, InputFocus, KeyButMask, MapState,
    QueryPointerReply, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;

use super::process::Process;

/// How long anything on a busy machine may take before the test gives up.
const PATIENCE: Duration = Duration::from_secs(60);

/// Asks `done` until it says yes; whether it did in time.
pub fn wait_for(done: impl FnMut() -> bool) -> bool {
    wait_up_to(PATIENCE, done)
}

/// Asks `done` until it says yes, up to a limit; whether it did in time.
pub fn wait_up_to(limit: Duration, mut done: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed() < limit {
        if done() {
            return true;
        }
        thread::sleep(Duration::from_millis(5));
    }
    false
}

/// `Xvfb` with a watcher connected.
///
/// It does not reset when its last client leaves: that would let go of stuck keys and hide the fault.
pub struct XServer {
    watcher: RustConnection,
    display: String,
    process: Process,
}

impl XServer {
    /// Starts a server on a free display, or says why not and gives `None`.
    pub fn start() -> Option<Self> {
        let arguments = "-displayfd 1 -noreset -nolisten tcp -screen 0 800x600x24";
        let mut command = Command::new("Xvfb");
        command
            .args(arguments.split(' '))
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut process = match Process::start(&mut command) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                println!("SKIPPED: Xvfb is not installed");
                return None;
            }
            started => started.expect("Xvfb starts"),
        };
        let stdout = process.0.stdout.take().expect("it is piped");
        let mut number = String::new();
        BufReader::new(stdout)
            .read_line(&mut number)
            .expect("Xvfb writes the number of its display");
        let display = format!(":{}", number.trim());
        let (watcher, _) = x11rb::connect(Some(&display)).expect("the server answers");
        Some(Self {
            watcher,
            display,
            process,
        })
    }

    /// The name of the display.
    pub fn display(&self) -> &str {
        &self.display
    }

    /// The X11 codes of the keys that are down, as the server sees it.
    pub fn keys_down(&self) -> Vec<u16> {
        let reply = self.watcher.query_keymap().expect("the server is there");
        let bits = reply.reply().expect("the server answers").keys;
        let is_down = |code: &u16| bits[usize::from(code / 8)] & (1 << (code % 8)) != 0;
        (0..256).filter(is_down).collect()
    }

    /// Waits until just these keys are down; whether that came about.
    pub fn wait_for_keys(&self, codes: &[u16]) -> bool {
        wait_for(|| self.keys_down() == codes)
    }

    /// Where the pointer is, in pixels from the left and from the top.
    pub fn pointer(&self) -> (i16, i16) {
        let reply = self.query_pointer();
        (reply.root_x, reply.root_y)
    }

    /// Waits until the pointer is there; whether it came.
    pub fn wait_for_pointer(&self, place: (i16, i16)) -> bool {
        wait_for(|| self.pointer() == place)
    }

    /// Which of the buttons left (1), middle (2) and right (3) are down, as the server sees it.
    pub fn buttons_down(&self) -> Vec<u8> {
        let mask = u16::from(self.query_pointer().mask);
        let is_down = |button: &u8| mask & (u16::from(KeyButMask::BUTTON1) << (button - 1)) != 0;
        (1..=3).filter(is_down).collect()
    }

    fn query_pointer(&self) -> QueryPointerReply {
        let root = self.watcher.setup().roots[0].root;
        let reply = self.watcher.query_pointer(root);
        let reply = reply.expect("the server is there").reply();
        reply.expect("the server answers")
    }

    /// Ends the server as a crash would.
    pub fn kill(&mut self) {
        self.process.0.kill().expect("it runs");
        self.process.0.wait().expect("it ends");
    }

    fn windows(&self) -> Vec<Window> {
        let root = self.watcher.setup().roots[0].root;
        let tree = self.watcher.query_tree(root).expect("the server is there");
        tree.reply().expect("the server answers").children
    }

    fn is_seen(&self, window: Window) -> bool {
        self.watcher
            .get_window_attributes(window)
            .ok()
            .and_then(|attributes| attributes.reply().ok())
            .is_some_and(|attributes| attributes.map_state == MapState::VIEWABLE)
    }

    /// Waits until there is a window, and gives it the focus.
    pub fn focus_what_is_seen(&self) {
        let seen = || {
            let mut windows = self.windows().into_iter();
            windows.rfind(|window| self.is_seen(*window))
        };
        assert!(wait_for(|| seen().is_some()), "a program shows a window");
        self.focus(seen().expect("it has been seen"));
    }

    fn focus(&self, window: Window) {
        let time = x11rb::CURRENT_TIME;
        self.watcher
            .set_input_focus(InputFocus::PARENT, window, time)
            .expect("the server is there")
            .check()
            .expect("a window that is seen can have the focus");
    }
}

/// A window over the whole screen that has the focus and receives all events of keyboard and mouse.
///
/// The server sends every event. A key that is down for less than the interval between two looks at the keymap is
/// received all the same.
pub struct InputWindow {
    connection: RustConnection,
}

impl InputWindow {
    /// Opens one on the server.
    pub fn open(server: &XServer) -> Self {
        let (connection, screen) = x11rb::connect(Some(server.display())).expect("it answers");
        let root = &connection.setup().roots[screen];
        let window = connection.generate_id().expect("a number for it");
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
            .expect("the server is there");
        connection.map_window(window).expect("the server is there");
        connection.flush().expect("the server is there");
        assert!(wait_for(|| server.is_seen(window)), "the window is seen");
        server.focus(window);
        Self { connection }
    }

    /// Waits for the press of any key; returns `false` if none comes in time. Earlier events are dropped.
    pub fn receives_a_key(&self) -> bool {
        wait_for(|| {
            let mut next = || self.connection.poll_for_event().expect("the server runs");
            std::iter::from_fn(&mut next).any(|event| matches!(event, Event::KeyPress(_)))
        })
    }

    /// What it has heard since it was last asked, once it has heard `last` or no more comes: `down 1 at 3,4`, `up 1 at 3,4`, `move to 3,4` and, with the left button down, `drag to 3,4`.
    pub fn heard(&self, last: &str) -> Vec<String> {
        let mut heard = Vec::new();
        wait_for(|| {
            while let Some(event) = self.connection.poll_for_event().expect("it is there") {
                heard.extend(line(&event));
            }
            heard.last().is_some_and(|line| line == last)
        });
        heard
    }
}

fn line(event: &Event) -> Option<String> {
    let button = |what: &str, event: &ButtonPressEvent| {
        let (x, y) = (event.event_x, event.event_y);
        Some(format!("{what} {} at {x},{y}", event.detail))
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

/// An `xterm` that has the focus and writes the bytes that are typed into a file.
pub struct Typewriter {
    folder: TempDir,
    _process: Process,
}

impl Typewriter {
    /// Starts one on the server, or says why not and gives `None`.
    pub fn start(server: &XServer) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder can be made");
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
        let typewriter = Self {
            folder,
            _process: process,
        };
        assert!(
            wait_for(|| typewriter.path("typed").exists()),
            "xterm runs its script"
        );
        server.focus_what_is_seen();
        Some(typewriter)
    }

    /// What has been typed, once it is as long as `expected` or no more comes.
    pub fn typed(&self, expected: &str) -> String {
        let typed = || fs::read(self.path("typed")).unwrap_or_default();
        wait_for(|| typed().len() >= expected.len());
        String::from_utf8_lossy(&typed()).into_owned()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

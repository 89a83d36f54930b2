//! Events that a window receives, as printed by `xev`.

use std::io::ErrorKind;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};

use ademan::device::{Capabilities, EventKind, KeyCode, OutputEvent};
use ademan::output::{Desktop, Sink};
use ademan::time::Timestamp;

use super::{arrives, repeat};
use crate::support::process::{Process, collect_lines};
use crate::support::x11::XServer;

/// A full-screen window of `xev` that has the focus.
struct Window {
    _process: Process,
    lines: Arc<Mutex<Vec<String>>>,
}

impl Window {
    /// Opens a window. Returns `None` with a message if xev is not installed.
    fn open(server: &XServer) -> Option<Self> {
        // Disables the buffering of lines.
        let mut command = Command::new("stdbuf");
        command
            .args(["-oL", "xev", "-geometry", "800x600+0+0"])
            .args(["-event", "keyboard", "-event", "mouse"])
            .env("DISPLAY", server.display())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        if let Err(error) = Command::new("xev").arg("-version").output()
            && error.kind() == ErrorKind::NotFound
        {
            println!("SKIPPED: xev is not installed");
            return None;
        }
        let mut process = Process::start(&mut command).expect("xev starts");
        let stdout = process.0.stdout.take().expect("stdout is piped");
        let lines = collect_lines(stdout);
        server.focus_visible_window();
        Some(Self {
            _process: process,
            lines,
        })
    }

    /// Returns the events so far: `KeyPress 38 a with 0x1`, `ButtonPress 1 with 0x0`, `MotionNotify 3,4 with 0x100`.
    fn events(&self) -> Vec<String> {
        let lines = self.lines.lock().unwrap();
        let events = lines.split(|line| line.is_empty());
        events.filter_map(event).collect()
    }

    /// Returns the events from the first one of a key on.
    fn events_since_a_key(&self) -> Vec<String> {
        let events = self.events().into_iter();
        events.skip_while(|line| !line.starts_with("Key")).collect()
    }
}

/// Returns an event, which has three or more lines, in one line.
fn event(lines: &[String]) -> Option<String> {
    let (kind, _) = lines.first()?.split_once(" event")?;
    let text = lines.join(" ");
    let after = |word: &str| {
        let (_, rest) = text.split_once(word)?;
        rest.split([',', ' ', ')']).next()
    };
    let what = match kind {
        "KeyPress" | "KeyRelease" => {
            let (_, keysym) = text.split_once("keysym ")?;
            let (name, _) = keysym.split_once(", ")?.1.split_once(')')?;
            format!("{} {name}", after("keycode ")?)
        }
        "ButtonPress" | "ButtonRelease" => after("button ")?.to_owned(),
        "MotionNotify" => {
            let (_, position) = text.split_once("root:(")?;
            position.split_once(')')?.0.to_owned()
        }
        _ => return None,
    };
    Some(format!("{kind} {what} with {}", after("state ")?))
}

fn key(name: &str) -> KeyCode {
    name.parse().expect("the name of a key")
}

#[test]
fn xev_receives_keys_modifiers_buttons_wheel_and_a_drag() {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let Some(window) = Window::open(&server) else {
            return true;
        };
        let sink = Desktop::open(Some(server.display()), &Capabilities::default());
        let mut sink = sink.expect("the server runs");
        let is_received = parts().into_iter().all(|(kinds, count)| {
            let time = Timestamp(0);
            let events = kinds.into_iter().map(|kind| OutputEvent { time, kind });
            let events: Vec<_> = events.collect();
            arrives(&mut sink, &events, || {
                window.events_since_a_key().len() >= count
            })
        });
        sink.close().expect("everything is sent");
        if is_received {
            assert_eq!(window.events_since_a_key(), EXPECTED);
        }
        is_received
    });
}

/// Returns what is sent at once, and the number of events that the window has received after it.
fn parts() -> Vec<(Vec<EventKind>, usize)> {
    let down = |name| EventKind::KeyDown(key(name));
    let up = |name| EventKind::KeyUp(key(name));
    vec![
        (vec![EventKind::MoveTo(0.5, 0.5)], 0),
        (vec![down("ShiftLeft")], 1),
        (vec![down("A"), up("A")], 3),
        (vec![up("ShiftLeft")], 4),
        (vec![down("ControlLeft")], 5),
        (vec![down("F5"), up("F5")], 7),
        (vec![up("ControlLeft")], 8),
        (vec![down("MouseLeft")], 9),
        (vec![EventKind::MoveBy(10, -5)], 10),
        (vec![up("MouseLeft")], 11),
        (vec![EventKind::Scroll(0, 120)], 13),
        (vec![EventKind::Scroll(0, -120)], 15),
        (vec![down("MouseRight"), up("MouseRight")], 17),
    ]
}

/// The events that the window receives.
const EXPECTED: [&str; 17] = [
    "KeyPress 50 Shift_L with 0x0",
    "KeyPress 38 A with 0x1",
    "KeyRelease 38 A with 0x1",
    "KeyRelease 50 Shift_L with 0x1",
    "KeyPress 37 Control_L with 0x0",
    "KeyPress 71 F5 with 0x4",
    "KeyRelease 71 F5 with 0x4",
    "KeyRelease 37 Control_L with 0x4",
    "ButtonPress 1 with 0x0",
    "MotionNotify 410,295 with 0x100",
    "ButtonRelease 1 with 0x100",
    "ButtonPress 4 with 0x0",
    "ButtonRelease 4 with 0x800",
    "ButtonPress 5 with 0x0",
    "ButtonRelease 5 with 0x1000",
    "ButtonPress 3 with 0x0",
    "ButtonRelease 3 with 0x400",
];

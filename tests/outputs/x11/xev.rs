//! Events that a window receives, as printed by `xev`.

use std::io::ErrorKind;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};

use ademan::device::{Capabilities, EventKind, KeyCode, OutputEvent};
use ademan::output::{Desktop, Sink};
use ademan::time::Timestamp;

use crate::support::process::{Process, collect_lines};
use crate::support::x11::{XServer, wait_for};

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
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(window) = Window::open(&server) else {
        return;
    };
    let actions = [
        EventKind::MoveTo(0.5, 0.5),
        EventKind::KeyDown(key("ShiftLeft")),
        EventKind::KeyDown(key("A")),
        EventKind::KeyUp(key("A")),
        EventKind::KeyUp(key("ShiftLeft")),
        EventKind::KeyDown(key("ControlLeft")),
        EventKind::KeyDown(key("F5")),
        EventKind::KeyUp(key("F5")),
        EventKind::KeyUp(key("ControlLeft")),
        EventKind::KeyDown(key("MouseLeft")),
        EventKind::MoveBy(10, -5),
        EventKind::KeyUp(key("MouseLeft")),
        EventKind::Scroll(0, 120),
        EventKind::Scroll(0, -120),
        EventKind::KeyDown(key("MouseRight")),
        EventKind::KeyUp(key("MouseRight")),
    ];
    let mut sink = Desktop::open(Some(server.display()), &Capabilities::default());
    let sink = sink.as_mut().expect("the server runs");
    for action in actions {
        let time = Timestamp(0);
        sink.send(&[OutputEvent { time, kind: action }])
            .expect("the queue has room");
    }
    sink.close().expect("everything is sent");
    let last = "ButtonRelease 3 with 0x400";
    let is_there = || window.events().last().is_some_and(|line| line == last);
    assert!(wait_for(is_there), "{:#?}", window.events());
    let events = window.events();
    let start = events.iter().position(|line| line.starts_with("Key"));
    let expected = [
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
        last,
    ];
    assert_eq!(events[start.expect("a key")..], expected);
}

//! Windows of other programs.

use std::fs;
use std::io::ErrorKind;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};

use super::compositor::Compositor;
use crate::support::process::{Process, collect_lines};
use crate::support::x11::wait_for;

/// A window of `wev`, which prints its events. It has the focus.
pub struct Window {
    _process: Process,
    lines: Arc<Mutex<Vec<String>>>,
}

impl Window {
    /// Opens a window. Returns `None` with a message if wev is not installed.
    pub fn open(compositor: &Compositor) -> Option<Self> {
        // Disables the buffering of lines.
        let mut command = compositor.client("stdbuf");
        command.args(["-oL", "wev"]).stdout(Stdio::piped());
        let mut process = start("wev", &mut command)?;
        let stdout = process.0.stdout.take().expect("stdout is piped");
        let lines = collect_lines(stdout);
        let window = Self {
            _process: process,
            lines,
        };
        let is_visible = || window.lines().iter().any(|line| line.contains("activated"));
        assert!(wait_for(is_visible), "wev shows no window");
        Some(window)
    }

    fn lines(&self) -> Vec<String> {
        self.lines.lock().unwrap().clone()
    }

    /// Returns the events so far: `down h`, `up h`, `held Shift` or `held -`, `button 272 down`, `move to 3,4`,
    /// `axis 0 by 15`, `clicks 0 by 1`.
    pub fn events(&self) -> Vec<String> {
        let lines = self.lines();
        // With a further keyboard, wev creates another object that receives the same events.
        let first = |kind: &str| lines.iter().filter_map(|line| number(line, kind)).min();
        let numbers = [first("wl_keyboard"), first("wl_pointer")];
        let mut events = Vec::new();
        for (index, line) in lines.iter().enumerate() {
            let number = number(line, "wl_keyboard").or(number(line, "wl_pointer"));
            if number.is_some() && numbers.contains(&number) {
                let next = lines.get(index + 1).map_or("", String::as_str);
                events.extend(event(line, next));
            }
        }
        events
    }

    /// Waits for the event `last` and returns all events.
    pub fn events_until(&self, last: &str) -> Vec<String> {
        let is_there = || self.events().last().is_some_and(|line| line == last);
        let is_received = wait_for(is_there);
        println!("received {last:?}: {is_received}");
        self.events()
    }

    /// Waits until each press of a key is followed by its release. Returns `false` after the time-out, or if no key was pressed.
    pub fn has_all_releases(&self) -> bool {
        wait_for(|| {
            let events = self.events();
            let count = |kind: &str| events.iter().filter(|line| line.starts_with(kind)).count();
            count("down ") > 0 && count("down ") == count("up ")
        })
    }

    /// Waits for an event. Returns `false` after the time-out.
    pub fn receives(&self, line: &str) -> bool {
        wait_for(|| self.events().iter().any(|events| events == line))
    }
}

/// Returns the id of the object in a line if it has this interface.
fn number(line: &str, kind: &str) -> Option<u32> {
    let (number, rest) = line.strip_prefix('[')?.split_once(':')?;
    let (found, _) = rest.split_once(']')?;
    (found.trim() == kind).then(|| number.parse().ok())?
}

/// Returns the event of a line and its continuation.
fn event(line: &str, next: &str) -> Option<String> {
    let (_, text) = line.split_once("] ")?;
    let (kind, values) = text.split_once(':')?;
    let value = |name: &str| {
        let (_, rest) = values.split_once(&format!(" {name}: "))?;
        rest.split([';', ' ']).next()
    };
    let way = || {
        if text.contains("(pressed)") {
            "down"
        } else {
            "up"
        }
    };
    Some(match kind {
        "key" => format!("{} {}", way(), next.split_whitespace().nth(1)?),
        "modifiers" => {
            let held = next.rsplit(':').next()?.trim();
            let is_none = held.chars().all(|digit| digit == '0');
            format!("held {}", if is_none { "-" } else { held })
        }
        "button" => format!("button {} {}", value("button")?, way()),
        "motion" => {
            let (_, position) = text.split_once("x, y: ")?;
            let mut numbers = position.split(", ").map(|word| word.trim().parse::<f64>());
            let (x, y) = (numbers.next()?.ok()?, numbers.next()?.ok()?);
            format!("move to {x},{y}")
        }
        "axis" => {
            let by: f64 = value("value")?.parse().ok()?;
            format!("axis {} by {by}", value("axis")?)
        }
        // The name depends on the version of wev.
        "axis_discrete" | "axis_stop" => {
            format!("clicks {} by {}", value("axis")?, value("discrete")?)
        }
        _ => return None,
    })
}

/// A terminal `foot` that has the focus and writes the typed bytes to a file.
pub struct Terminal<'a> {
    compositor: &'a Compositor,
    _process: Process,
}

impl<'a> Terminal<'a> {
    /// Starts a terminal. Returns `None` with a message if foot is not installed.
    pub fn start(compositor: &'a Compositor) -> Option<Self> {
        let script = "stty -icanon -echo; exec cat > typed";
        let mut command = compositor.client("foot");
        command.args(["sh", "-c", script]);
        let process = start("foot", &mut command)?;
        let typed = compositor.folder().join("typed");
        assert!(wait_for(|| typed.exists()), "foot runs its script");
        let terminal = Self {
            compositor,
            _process: process,
        };
        assert!(wait_for(|| terminal.has_focus()), "foot has the focus");
        Some(terminal)
    }

    fn has_focus(&self) -> bool {
        let tree = self.compositor.query("get_tree");
        let node = tree.split("\"focused\": true").nth(1);
        node.is_some_and(|node| node.contains("\"app_id\": \"foot\""))
    }

    /// Waits until as many bytes as in `expected` are typed, and returns the typed text.
    pub fn typed(&self, expected: &str) -> String {
        let typed = || fs::read(self.compositor.folder().join("typed")).unwrap_or_default();
        wait_for(|| typed().len() >= expected.len());
        String::from_utf8_lossy(&typed()).into_owned()
    }
}

fn start(name: &str, command: &mut Command) -> Option<Process> {
    if let Err(error) = Command::new(name).arg("--version").output()
        && error.kind() == ErrorKind::NotFound
    {
        println!("SKIPPED: {name} is not installed");
        return None;
    }
    command.stderr(Stdio::null());
    Some(Process::start(command).expect("it starts"))
}

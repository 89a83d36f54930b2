//! A desktop on a message bus.

use std::io::Write;
use std::process::ChildStdin;
use std::sync::{Arc, Mutex};

use serde_json::Value;

use crate::session_bus::Bus;
use crate::support::process::{Process, collect_lines};
use crate::support::x11::wait_for;

/// A desktop with a tray and notifications.
pub struct Desktop {
    process: Process,
    stdin: ChildStdin,
    lines: Arc<Mutex<Vec<String>>>,
}

impl Desktop {
    /// Starts a desktop. Returns `None` with a message if Python has no GLib.
    pub fn start(bus: &Bus) -> Option<Self> {
        let mut process = bus.start_script("tests/outputs/tray/desktop.py")?;
        let stdin = process.0.stdin.take().expect("stdin is piped");
        let stdout = process.0.stdout.take().expect("stdout is piped");
        Some(Self {
            process,
            stdin,
            lines: collect_lines(stdout),
        })
    }

    pub fn id(&self) -> u32 {
        self.process.0.id()
    }

    /// Returns the lines that have a field.
    pub fn lines(&self, field: &str) -> Vec<Value> {
        let lines = self.lines.lock().expect("no panic");
        let lines = lines.iter().map(|line| serde_json::from_str::<Value>(line));
        let mut lines: Vec<_> = lines.map(|line| line.expect("JSON")).collect();
        lines.retain(|line| line.get(field).is_some());
        lines
    }

    /// Waits until the last line with a field fulfils a condition.
    pub fn wait_for(&self, field: &str, condition: impl Fn(&Value) -> bool) {
        let is_fulfilled = || self.lines(field).last().is_some_and(&condition);
        assert!(wait_for(is_fulfilled), "{:#?}", self.lines(field));
    }

    /// Clicks an entry of the menu.
    pub fn click(&mut self, label: &str) {
        writeln!(self.stdin, "{label}").expect("the desktop reads");
    }
}

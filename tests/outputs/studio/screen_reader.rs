//! The widgets of a window, as it describes them to screen readers through AT-SPI.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{ChildStdin, ChildStdout, Command, Stdio};

use serde::Deserialize;
use tempfile::TempDir;

use crate::session_bus::Bus;
use crate::support::process::{Process, signal};
use crate::support::x11::{XServer, wait_for};

/// The program that starts the accessibility bus.
const LAUNCHER: &str = "/usr/libexec/at-spi-bus-launcher";

/// A message bus whose accessibility is on, and a program that reads widgets from it.
pub(super) struct ScreenReader {
    stdin: ChildStdin,
    stdout: BufReader<ChildStdout>,
    _script: Process,
    launcher: Process,
    _folder: TempDir,
    bus: Bus,
}

/// A widget of a window.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(super) struct Widget {
    pub(super) name: String,
    pub(super) is_checked: bool,
    /// Left, top, width and height, in pixels.
    area: [i16; 4],
}

impl ScreenReader {
    /// Starts the buses and the reader. Returns `None` with a message if a program for it is not installed.
    pub(super) fn start() -> Option<Self> {
        if !Path::new(LAUNCHER).exists() {
            println!("SKIPPED: at-spi2-core is not installed");
            return None;
        }
        let bus = Bus::start()?;
        let mut script = bus.start_script("tests/outputs/studio/screen_reader.py")?;
        let folder = tempfile::tempdir().expect("a folder");
        let mut launcher = Command::new(LAUNCHER);
        launcher
            .args(["--launch-immediately", "--a11y=1"])
            .env("DBUS_SESSION_BUS_ADDRESS", bus.address())
            .env("XDG_RUNTIME_DIR", folder.path())
            // The setting that turns accessibility on is not kept.
            .env("GSETTINGS_BACKEND", "memory")
            .env_remove("DISPLAY")
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let launcher = Process::start(&mut launcher).expect("the launcher starts");
        let mut reader = Self {
            stdin: script.0.stdin.take().expect("stdin is piped"),
            stdout: BufReader::new(script.0.stdout.take().expect("stdout is piped")),
            _script: script,
            launcher,
            _folder: folder,
            bus,
        };
        // A program that starts later finds the accessibility bus.
        reader.widgets();
        Some(reader)
    }

    /// Returns the address of the message bus, which programs get as `DBUS_SESSION_BUS_ADDRESS`.
    pub(super) fn bus_address(&self) -> String {
        self.bus.address()
    }

    /// Returns the widgets of all windows.
    fn widgets(&mut self) -> Vec<Widget> {
        writeln!(self.stdin).expect("the reader runs");
        let mut line = String::new();
        self.stdout.read_line(&mut line).expect("the reader runs");
        serde_json::from_str(&line).expect("a list of widgets")
    }

    /// Waits until there is a widget with this name.
    pub(super) fn wait_for(&mut self, name: &str) -> Widget {
        self.wait_until(name, |_| true)
    }

    /// Waits until a widget with this name fulfils a condition and stays as it is.
    pub(super) fn wait_until(&mut self, name: &str, condition: impl Fn(&Widget) -> bool) -> Widget {
        let (mut before, mut widgets) = (None, Vec::new());
        let mut still = None;
        wait_for(|| {
            widgets = self.widgets();
            let is_found = |widget: &&Widget| widget.name == name && condition(widget);
            let found = widgets.iter().find(is_found).cloned();
            still = found.clone().filter(|_| found == before);
            before = found;
            still.is_some()
        });
        still.unwrap_or_else(|| panic!("no such widget {name:?}: {widgets:#?}"))
    }

    /// Clicks on the middle of the widget with this name, once it is shown.
    pub(super) fn click(&mut self, server: &XServer, name: &str) {
        let [left, top, width, height] = self.wait_for(name).area;
        server.click(left + width / 2, top + height / 2);
    }
}

impl Drop for ScreenReader {
    /// Ends the accessibility bus, which outlives a launcher that is killed.
    fn drop(&mut self) {
        signal("TERM", self.launcher.0.id());
        _ = self.launcher.0.wait();
    }
}

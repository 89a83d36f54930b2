//! A desktop with an input method: an X server, a message bus, the IBus daemon, and a window with a text field.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use tempfile::TempDir;

use crate::session_bus::{Bus, PYTHON};
use crate::support::binary::{self, ademan};
use crate::support::process::{Process, collect_lines};
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_at_most, wait_for};

/// A running desktop.
pub struct Desk {
    pub server: XServer,
    pub folder: TempDir,
    /// Fields of GTK 4 show their keys only to a daemon that is on the bus of the session.
    bus: Bus,
    daemon: Option<Process>,
    /// The candidate that the panel clicks.
    candidate: String,
}

impl Desk {
    /// Starts a server and a daemon. Returns `None` with a message if a program is missing.
    pub fn start() -> Option<Self> {
        let mut desk = Self::without_daemon()?;
        desk.start_daemon("disable");
        Some(desk)
    }

    /// Starts a server, and a daemon with a panel that clicks a candidate.
    pub fn with_panel(candidate: &str) -> Option<Self> {
        let mut desk = Self::without_daemon()?;
        let gi = "import gi; gi.require_version('IBus', '1.0')";
        if !succeeds(Command::new(PYTHON).args(["-c", gi]), "gir1.2-ibus-1.0") {
            return None;
        }
        desk.candidate = candidate.to_owned();
        desk.start_daemon(&path("panel.py").display().to_string());
        Some(desk)
    }

    /// Returns the lists of candidates that the panel has shown, as `a, b, c`.
    pub fn lists(&self) -> Vec<String> {
        let log = fs::read_to_string(self.folder.path().join("panel")).unwrap_or_default();
        log.lines().map(|line| line.replace('\t', ", ")).collect()
    }

    fn without_daemon() -> Option<Self> {
        let server = XServer::start()?;
        let mut ibus = Command::new("ibus-daemon");
        if !succeeds(ibus.arg("--version"), "ibus") || !has_gtk() {
            return None;
        }
        let bus = Bus::start()?;
        let folder = tempfile::tempdir().expect("a folder");
        Some(Self {
            server,
            folder,
            bus,
            daemon: None,
            candidate: String::new(),
        })
    }

    /// Starts the daemon with this panel and the engine of a US keymap.
    pub fn start_daemon(&mut self, panel: &str) {
        let mut command = self.command("ibus-daemon");
        command
            .args(["--xim", "--panel", panel, "--config", "disable"])
            .args(["--emoji-extension", "disable"])
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        self.daemon = Some(Process::start(&mut command).expect("the daemon starts"));
        let is_up = || {
            let mut engine = self.command("ibus");
            let selected = engine.args(["engine", "xkb:us::eng"]).output();
            selected.is_ok_and(|output| output.status.success())
        };
        assert!(wait_for(is_up), "the IBus daemon does not answer");
    }

    pub fn kill_daemon(&mut self) {
        drop(self.daemon.take());
    }

    /// Returns the name of the engine of the desktop.
    pub fn engine(&self) -> String {
        let output = self.command("ibus").arg("engine").output();
        let output = output.expect("ibus runs");
        String::from_utf8_lossy(&output.stdout).trim().to_owned()
    }

    /// Returns a command on this desktop, with settings of its own.
    pub fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        self.set_environment(&mut command);
        command
    }

    fn set_environment(&self, command: &mut Command) {
        let folder = |name: &str| {
            let path = self.folder.path().join(name);
            fs::create_dir_all(&path).expect("space on the disk");
            path
        };
        command
            .env("DISPLAY", self.server.display())
            .env("XDG_CONFIG_HOME", folder("config"))
            .env("XDG_CACHE_HOME", folder("cache"))
            .env("XDG_RUNTIME_DIR", folder("runtime"))
            .env("DBUS_SESSION_BUS_ADDRESS", self.bus.address())
            .env("GTK_IM_MODULE", "ibus")
            .env("QT_IM_MODULE", "ibus")
            .env("XMODIFIERS", "@im=ibus")
            .env("LC_ALL", "C.UTF-8")
            .env("ADEMAN_PANEL", self.folder.path().join("panel"))
            .env("ADEMAN_CLICK", &self.candidate)
            .env_remove("IBUS_ADDRESS")
            .env_remove("WAYLAND_DISPLAY");
    }

    /// Runs a simulated hand that types a text through the input method, with a text decoder.
    pub fn type_text(&self, text: &str) -> Program {
        let mut command = ademan(["run", "--control", "off"]);
        command.arg(write_setup(self.folder.path(), text));
        self.set_environment(&mut command);
        Program::from_command(command)
    }
}

/// A library of windows beside GTK 3, with a program that opens a text field.
pub struct Toolkit {
    program: &'static str,
    /// The second argument of the program.
    version: &'static str,
    /// Imports of the program, in Python.
    needs: &'static str,
    packages: &'static str,
}

pub const GTK_4: Toolkit = Toolkit {
    program: "field_gtk4.py",
    version: "4",
    needs: "import gi, glob; gi.require_version('Gtk', '4.0'); assert glob.glob('/usr/lib/*/gtk-4.0/*/immodules/libim-ibus.so')",
    packages: "gir1.2-gtk-4.0 and ibus-gtk4",
};
pub const QT_5: Toolkit = Toolkit {
    program: "field_qt.py",
    version: "5",
    needs: "import PyQt5.QtWidgets",
    packages: "python3-pyqt5",
};
pub const QT_6: Toolkit = Toolkit {
    program: "field_qt.py",
    version: "6",
    needs: "import PyQt6.QtWidgets",
    packages: "python3-pyqt6",
};

impl Toolkit {
    /// Returns `true` if its text fields can be opened. Prints a message if not.
    pub fn is_installed(&self) -> bool {
        succeeds(Command::new(PYTHON).args(["-c", self.needs]), self.packages)
    }
}

/// A window with a text field that has the focus.
pub struct Field {
    _process: Process,
    lines: Arc<Mutex<Vec<String>>>,
}

impl Field {
    /// Opens a window. `kind` is the argument of `field.py`.
    pub fn open(desk: &Desk, kind: &str) -> Self {
        Self::open_program(desk, &["field.py", kind])
    }

    /// Opens a window of another library.
    pub fn open_with(toolkit: &Toolkit, desk: &Desk, kind: &str) -> Self {
        Self::open_program(desk, &[toolkit.program, kind, toolkit.version])
    }

    fn open_program(desk: &Desk, words: &[&str]) -> Self {
        let field = Self::start(desk.command(PYTHON), words);
        desk.server.focus_visible_window();
        field.wait_for("focused\t");
        field
    }

    /// Opens a window of a compositor, which focuses it.
    #[cfg(feature = "wayland")]
    pub fn open_on_wayland(mut command: Command, kind: &str) -> Self {
        command
            .env("GDK_BACKEND", "wayland")
            .env("DBUS_SESSION_BUS_ADDRESS", "disabled:")
            .env("XDG_CONFIG_HOME", binary::NO_FOLDER)
            .env_remove("GTK_IM_MODULE");
        let field = Self::start(command, &["field.py", kind]);
        field.wait_for("focused\t");
        field
    }

    fn start(mut command: Command, words: &[&str]) -> Self {
        command
            .arg(path(words[0]))
            .args(&words[1..])
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut process = Process::start(&mut command).expect("Python starts");
        let stdout = process.0.stdout.take().expect("it is piped");
        Self {
            lines: collect_lines(stdout),
            _process: process,
        }
    }

    /// Returns what the field has said.
    pub fn lines(&self) -> Vec<String> {
        self.lines
            .lock()
            .expect("nothing panics in its thread")
            .clone()
    }

    /// Waits for a line, and returns all lines.
    pub fn wait_for(&self, line: &str) -> Vec<String> {
        let has_it = wait_for(|| self.lines().iter().any(|said| said == line));
        assert!(has_it, "{line:?} is missing: {:#?}", self.lines());
        self.lines()
    }

    /// Waits for a text with this end, then until the field says nothing more, and returns its text.
    pub fn text(&self, end: &str) -> String {
        // On a busy machine the field may say nothing for longer before it has the end.
        wait_for(|| self.last_text().ends_with(end));
        let mut count = 0;
        wait_at_most(Duration::from_secs(10), || {
            std::thread::sleep(Duration::from_millis(300));
            std::mem::replace(&mut count, self.lines().len()) == self.lines().len()
        });
        self.last_text()
    }

    /// Returns the present text.
    fn last_text(&self) -> String {
        let lines = self.lines();
        let last = lines
            .iter()
            .rev()
            .find_map(|line| line.strip_prefix("text\t"));
        last.unwrap_or_default().to_owned()
    }
}

/// Writes the setup of a simulated hand that types a text through the input method, with a text decoder. Returns its path. A busy machine
/// must not cause a stall.
pub fn write_setup(folder: &Path, text: &str) -> PathBuf {
    let setup = folder.join("setup.ron");
    let text = format!(
        "Setup(source: \"typist:{text}\", layout: \"qwerty-flat\", output: \"ime\", text: (mode: Auto), \
         stall_timeout_ms: 5000)"
    );
    fs::write(&setup, text).expect("space on the disk");
    setup
}

/// Returns `true` if text fields can be opened. Prints a message if not.
pub fn has_gtk() -> bool {
    let gtk = "import gi; gi.require_version('Gtk', '3.0')";
    let mut python = Command::new(PYTHON);
    succeeds(python.args(["-c", gtk]), "python3-gi and gir1.2-gtk-3.0")
}

/// Returns `true` if a command succeeds. Prints that its package is missing if not.
fn succeeds(command: &mut Command, package: &str) -> bool {
    let is_installed = command.output().is_ok_and(|output| output.status.success());
    if !is_installed {
        println!("SKIPPED: Debian's {package} is not installed");
    }
    is_installed
}

/// Returns the path of a program of this test.
fn path(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    folder.join("tests/outputs/ime").join(name)
}

/// Starts a program that may be missing. Returns `None` with a message then.
pub fn start_if_installed(command: &mut Command, package: &str) -> Option<Process> {
    match Process::start(command) {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("SKIPPED: Debian's {package} is not installed");
            None
        }
        started => Some(started.expect("it starts")),
    }
}

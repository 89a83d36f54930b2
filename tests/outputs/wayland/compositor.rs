//! A headless Wayland compositor for one test.

use std::ffi::OsStr;
use std::fs;
use std::io::ErrorKind;
use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use ademan::device::{Capabilities, Capability, EventKind, OutputEvent};
use ademan::output::Desktop;
use ademan::time::Timestamp;
use tempfile::TempDir;

use crate::support::binary::ademan;
use crate::support::process::Process;
use crate::support::program::Program;
use crate::support::x11::wait_for;

/// User and group id of `nobody`.
const NOBODY: u32 = 65534;

/// Configuration: one full-screen window and no XWayland.
const SWAY_CONFIG: &str =
    "output HEADLESS-1 resolution 1024x768\nxwayland disable\ndefault_border none\n";

/// A running compositor.
pub struct Compositor {
    folder: TempDir,
    socket: PathBuf,
    process: Process,
}

impl Compositor {
    /// Starts `sway`, which supports virtual keyboards and pointers. Returns `None` with a message if it is not installed.
    pub fn sway() -> Option<Self> {
        Self::sway_with("")
    }

    /// Starts `sway` with additional configuration.
    pub fn sway_with(lines: &str) -> Option<Self> {
        let folder = new_folder();
        let settings = folder.path().join("settings");
        fs::write(&settings, format!("{SWAY_CONFIG}{lines}")).expect("space on the disk");
        let mut command = as_nobody("sway", folder.path());
        command
            .arg("-c")
            .arg(settings)
            .env("WLR_BACKENDS", "headless")
            .env("WLR_LIBINPUT_NO_DEVICES", "1")
            .env("WLR_RENDERER", "pixman");
        Self::start(folder, command)
    }

    /// Starts `weston`, which supports no virtual keyboards. Returns `None` with a message if it is not installed.
    pub fn weston() -> Option<Self> {
        let folder = new_folder();
        let mut command = as_nobody("weston", folder.path());
        command.args(["--backend=headless-backend.so", "--socket=wayland-5"]);
        Self::start(folder, command)
    }

    fn start(folder: TempDir, mut command: Command) -> Option<Self> {
        let name = command.get_args().chain([command.get_program()]);
        let name = name.into_iter().find(|word| is_a_compositor(word));
        let name = name.expect("one of two compositors").to_owned();
        if let Err(error) = Command::new(&name).arg("--version").output() {
            assert_eq!(error.kind(), ErrorKind::NotFound, "{name:?}: {error}");
            println!("SKIPPED: {} is not installed", name.display());
            return None;
        }
        let log = fs::File::create(folder.path().join("log")).expect("space on the disk");
        command.stdout(Stdio::null()).stderr(log);
        let process = Process::start(&mut command).expect("the compositor starts");
        let mut socket = None;
        let read_log = || fs::read_to_string(folder.path().join("log")).unwrap_or_default();
        let is_up = || {
            socket = socket_in(folder.path());
            socket.is_some()
        };
        assert!(wait_for(is_up), "no socket: {}", read_log());
        Some(Self {
            socket: socket.expect("it exists"),
            folder,
            process,
        })
    }

    /// Returns the path of the socket.
    pub fn socket(&self) -> &str {
        self.socket.to_str().expect("a UTF-8 path")
    }

    /// Returns the runtime folder.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Returns a command of another program, with this compositor and without an X server.
    pub fn client(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command
            .env("WAYLAND_DISPLAY", &self.socket)
            .env("XDG_RUNTIME_DIR", self.folder())
            .env("LC_ALL", "C.UTF-8")
            .env_remove("DISPLAY")
            .current_dir(self.folder());
        command
    }

    /// Returns the command `ademan` with these arguments, with this compositor and without an X server.
    pub fn ademan<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Command {
        let mut command = ademan(arguments);
        command
            .env("WAYLAND_DISPLAY", &self.socket)
            .env_remove("XDG_RUNTIME_DIR")
            .env_remove("DISPLAY");
        command
    }

    /// Starts `ademan` with these arguments.
    pub fn run<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Program {
        Program::from_command(self.ademan(arguments))
    }

    /// Opens the output `desktop` on this compositor, with a pointer.
    pub fn desktop(&self) -> Desktop {
        let needs: Capabilities = [Capability::RelativeMotion].into_iter().collect();
        Desktop::open(Some(self.socket()), &needs).expect("the compositor runs")
    }

    /// Returns the path of the IPC socket of `sway`.
    pub fn ipc_socket(&self) -> PathBuf {
        let entries = fs::read_dir(self.folder()).expect("it exists").flatten();
        let is_ipc_socket = |path: &PathBuf| path.to_string_lossy().contains("sway-ipc.");
        let socket = entries.map(|entry| entry.path()).find(is_ipc_socket);
        socket.expect("the IPC socket of sway")
    }

    /// Returns the reply of `sway` to an IPC message of this type.
    pub fn query(&self, kind: &str) -> String {
        self.message(&["-t", kind])
    }

    /// Returns the reply of `sway` to a command of its configuration.
    pub fn execute(&self, command: &str) -> String {
        self.message(&[command])
    }

    fn message(&self, arguments: &[&str]) -> String {
        let mut command = Command::new("swaymsg");
        command.arg("-s").arg(self.ipc_socket()).arg("-r");
        let output = command.args(arguments).output();
        let output = output.expect("swaymsg is part of sway").stdout;
        String::from_utf8_lossy(&output).into_owned()
    }

    /// Stops the process with SIGSTOP.
    pub fn stop(&self) {
        self.signal("STOP");
    }

    /// Continues the process.
    pub fn resume(&self) {
        self.signal("CONT");
    }

    /// Kills the process.
    pub fn kill(&mut self) {
        self.process.0.kill().expect("the compositor runs");
        self.process.0.wait().expect("the compositor exits");
    }

    fn signal(&self, name: &str) {
        let process = self.process.0.id().to_string();
        let mut kill = Command::new("sh");
        kill.args(["-c", &format!("kill -s {name} {process}")]);
        let mut kill = Process::start(&mut kill).expect("a shell");
        assert!(kill.0.wait().expect("the shell exits").success());
    }
}

/// Returns an event at time 0.
pub fn event(action: EventKind) -> OutputEvent {
    OutputEvent {
        time: Timestamp(0),
        kind: action,
    }
}

fn is_a_compositor(word: &OsStr) -> bool {
    word == "sway" || word == "weston"
}

/// Creates a runtime folder. As root, it belongs to `nobody`, because `sway` refuses to run as root.
fn new_folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    if is_root(folder.path()) {
        chown(folder.path(), Some(NOBODY), Some(NOBODY)).expect("root may change the owner");
    }
    let only_the_owner = fs::Permissions::from_mode(0o700);
    fs::set_permissions(folder.path(), only_the_owner).expect("the owner may change the mode");
    folder
}

fn is_root(folder: &Path) -> bool {
    fs::metadata(folder).expect("it exists").uid() == 0
}

/// Returns the command of a program that does not run as root. It has no parent in between, so it receives signals.
fn as_nobody(program: &str, folder: &Path) -> Command {
    let owner = fs::metadata(folder).expect("it exists").uid();
    let mut command = match owner {
        NOBODY => {
            let mut command = Command::new("setpriv");
            command.args(["--reuid=65534", "--regid=65534", "--clear-groups", program]);
            command
        }
        _ => Command::new(program),
    };
    command
        .env("XDG_RUNTIME_DIR", folder)
        .env("HOME", folder)
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("DISPLAY");
    command
}

/// Returns the socket that a compositor has created in a folder.
fn socket_in(folder: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(folder).ok()?.flatten();
    entries.map(|entry| entry.path()).find(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("wayland-") && !name.ends_with(".lock")
    })
}

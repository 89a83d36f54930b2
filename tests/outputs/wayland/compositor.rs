//! A Wayland compositor of the test's own, without a screen.

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

/// The user and the group that own nothing.
const NOBODY: u32 = 65534;

/// The one window covers the whole screen, and no program of X11 is expected.
const SWAY: &str = "output HEADLESS-1 resolution 1024x768\nxwayland disable\ndefault_border none\n";

/// A compositor that runs.
pub struct Compositor {
    folder: TempDir,
    socket: PathBuf,
    process: Process,
}

impl Compositor {
    /// Starts `sway`, which lets programs be keyboards and pointers, or says why not and gives `None`.
    pub fn sway() -> Option<Self> {
        Self::sway_with("")
    }

    /// The same with more lines of configuration.
    pub fn sway_with(lines: &str) -> Option<Self> {
        let folder = new_folder();
        let settings = folder.path().join("settings");
        fs::write(&settings, format!("{SWAY}{lines}")).expect("room on the disk");
        let mut command = as_nobody("sway", folder.path());
        command
            .arg("-c")
            .arg(settings)
            .env("WLR_BACKENDS", "headless")
            .env("WLR_LIBINPUT_NO_DEVICES", "1")
            .env("WLR_RENDERER", "pixman");
        Self::start(folder, command)
    }

    /// Starts `weston`, which lets no program be a keyboard, or says why not and gives `None`.
    pub fn weston() -> Option<Self> {
        let folder = new_folder();
        let mut command = as_nobody("weston", folder.path());
        command.args(["--backend=headless-backend.so", "--socket=wayland-5"]);
        Self::start(folder, command)
    }

    fn start(folder: TempDir, mut command: Command) -> Option<Self> {
        let name = command.get_args().chain([command.get_program()]);
        let name = name.into_iter().find(|word| is_a_compositor(word));
        let name = name.expect("it is one of two").to_owned();
        if let Err(error) = Command::new(&name).arg("--version").output() {
            assert_eq!(error.kind(), ErrorKind::NotFound, "{name:?}: {error}");
            println!("SKIPPED: {} is not installed", name.display());
            return None;
        }
        let log = fs::File::create(folder.path().join("log")).expect("room on the disk");
        command.stdout(Stdio::null()).stderr(log);
        let process = Process::start(&mut command).expect("it starts");
        let mut socket = None;
        let told = || fs::read_to_string(folder.path().join("log")).unwrap_or_default();
        let is_up = || {
            socket = socket_in(folder.path());
            socket.is_some()
        };
        assert!(wait_for(is_up), "no socket: {}", told());
        Some(Self {
            socket: socket.expect("it is there"),
            folder,
            process,
        })
    }

    /// The path of its socket.
    pub fn socket(&self) -> &str {
        self.socket.to_str().expect("a plain name")
    }

    /// A folder that goes with it.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// A program for this compositor, and for no X server.
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

    /// `ademan` with these arguments, for this compositor and for no X server.
    pub fn ademan<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Command {
        let mut command = ademan(arguments);
        command
            .env("WAYLAND_DISPLAY", &self.socket)
            .env_remove("XDG_RUNTIME_DIR")
            .env_remove("DISPLAY");
        command
    }

    /// The same, running.
    pub fn run<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Program {
        Program::from_command(self.ademan(arguments))
    }

    /// The output `desktop` at this compositor, with a pointer.
    pub fn desktop(&self) -> Desktop {
        let needs: Capabilities = [Capability::RelativeMotion].into_iter().collect();
        Desktop::open(Some(self.socket()), &needs).expect("the compositor is there")
    }

    /// What `sway` answers to a question of this kind.
    pub fn tell(&self, kind: &str) -> String {
        let entries = fs::read_dir(self.folder()).expect("it is there").flatten();
        let is_for_questions = |path: &PathBuf| path.to_string_lossy().contains("sway-ipc.");
        let socket = entries.map(|entry| entry.path()).find(is_for_questions);
        let mut command = Command::new("swaymsg");
        command.arg("-s").arg(socket.expect("sway has made it"));
        let answer = command.args(["-r", "-t", kind]).output();
        let answer = answer.expect("it comes with sway").stdout;
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// Lets it do nothing until it is told to go on.
    pub fn stop(&self) {
        self.signal("STOP");
    }

    /// Lets it go on.
    pub fn go_on(&self) {
        self.signal("CONT");
    }

    fn signal(&self, name: &str) {
        let process = self.process.0.id().to_string();
        let mut kill = Command::new("sh");
        kill.args(["-c", &format!("kill -s {name} {process}")]);
        let mut kill = Process::start(&mut kill).expect("a shell");
        assert!(kill.0.wait().expect("it ends").success());
    }
}

/// An event that an output takes.
pub fn event(action: EventKind) -> OutputEvent {
    OutputEvent {
        time: Timestamp(0),
        kind: action,
    }
}

fn is_a_compositor(word: &OsStr) -> bool {
    word == "sway" || word == "weston"
}

/// A runtime folder; nobody's where this is root, because `sway` refuses to be root's.
fn new_folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    if is_root(folder.path()) {
        chown(folder.path(), Some(NOBODY), Some(NOBODY)).expect("root may");
    }
    let only_the_owner = fs::Permissions::from_mode(0o700);
    fs::set_permissions(folder.path(), only_the_owner).expect("its owner may");
    folder
}

fn is_root(folder: &Path) -> bool {
    fs::metadata(folder).expect("it is there").uid() == 0
}

/// A program that does not run as root. It is the process that is started, so a signal reaches it.
fn as_nobody(program: &str, folder: &Path) -> Command {
    let owner = fs::metadata(folder).expect("it is there").uid();
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

/// The socket that a compositor has made in a folder.
fn socket_in(folder: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(folder).ok()?.flatten();
    entries.map(|entry| entry.path()).find(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("wayland-") && !name.ends_with(".lock")
    })
}

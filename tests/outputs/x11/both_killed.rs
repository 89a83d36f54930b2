//! A program that is killed in the same instant as its watchdog.

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use super::ends::{are_held, held_keys};
use super::start_until;
use crate::support::binary::ademan;
use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::process::Process;
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_for};

const ATTEMPTS: usize = 5;

/// A run that holds two keys on a server, and the runtime folder of the user.
struct Holding {
    program: Program,
    glove: Glove,
    runtime: TempDir,
    server: XServer,
}

impl Holding {
    /// Starts a run and presses the keys. Returns `None` without an X server.
    fn start() -> Option<Self> {
        start_until(Self::start_armed, |run| {
            are_held(&run.server, &run.program, &run.glove)
        })
    }

    /// Starts a run and waits until it is armed.
    fn start_armed() -> Option<Self> {
        let server = XServer::start()?;
        let press = Press::for_text("H");
        // Real users have a runtime folder in memory; with it the loop writes the keys.
        let runtime = tempfile::tempdir_in("/dev/shm").expect("a folder in memory");
        let port = runtime.path().join("glove");
        let glove = Glove::plug_in(&port, press.clear());
        let source = format!("serial:{}", port.display());
        let run = ademan(["run", "--output", "desktop", "--source", &source]);
        let program = Program::from_command(in_session(run, &server, runtime.path()));
        program.wait_for_line("armed", 1);
        Some(Self {
            program,
            glove,
            runtime,
            server,
        })
    }
}

/// A server on which a killed run has left keys pressed, and the runtime folder of the user.
struct Killed {
    server: XServer,
    runtime: TempDir,
    _glove: Glove,
}

/// Adds the environment of the user to a command.
pub fn in_session(mut command: Command, server: &XServer, runtime: &Path) -> Command {
    command
        .env("DISPLAY", server.display())
        .env("XDG_RUNTIME_DIR", runtime)
        .env_remove("WAYLAND_DISPLAY");
    command
}

/// Returns the names of the records of pressed keys in the folder of the program.
fn records(runtime: &Path) -> Vec<String> {
    let folder = fs::read_dir(runtime.join("ademan")).expect("it exists");
    let name_of = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let names = folder.flatten().map(name_of);
    names.filter(|name| name.starts_with("pressed-")).collect()
}

impl Killed {
    /// Kills a run that holds two keys, and its watchdog. Returns `None` without an X server.
    fn new() -> Option<Self> {
        // On a busy machine the watchdog may notice that the program is stopped, and release the keys.
        for _ in 0..ATTEMPTS {
            let killed = Self::attempt()?;
            if killed.server.pressed_keys() == held_keys() {
                return Some(killed);
            }
        }
        panic!("the keys never stayed pressed");
    }

    fn attempt() -> Option<Self> {
        let Holding {
            mut program,
            glove,
            runtime,
            server,
        } = Holding::start()?;
        let [watchdog] = program.children()[..] else {
            panic!("one child: {:?}", program.children());
        };
        // A program that is stopped does not release its keys when the watchdog is killed first.
        let program_id = program.id();
        let kill = format!("kill -s STOP {program_id}; kill -s KILL {watchdog} {program_id}");
        let mut shell = Process::start(Command::new("sh").args(["-c", &kill])).expect("a shell");
        shell.0.wait().expect("the shell exits");
        assert_eq!(program.wait_for_exit().code(), None);
        Some(Self {
            server,
            runtime,
            _glove: glove,
        })
    }

    fn command<const N: usize>(&self, arguments: [&str; N]) -> Command {
        in_session(ademan(arguments), &self.server, self.runtime.path())
    }

    fn is_released(&self) -> bool {
        let is_free = || self.server.pressed_keys().is_empty();
        wait_for(is_free)
    }
}

#[test]
fn the_watchdog_leaves_no_record_of_keys_that_it_has_released() {
    let Some(mut holding) = Holding::start() else {
        return;
    };
    let runtime = holding.runtime.path();
    assert_eq!(records(runtime).len(), 1);
    holding.program.signal(&["KILL"]);
    assert_eq!(holding.program.wait_for_exit().code(), None);
    let is_gone = || records(runtime).is_empty();
    assert!(wait_for(is_gone), "{:?}", records(runtime));
    assert!(holding.server.pressed_keys().is_empty());
}

/// The unit executes the command after each run.
#[test]
fn keys_of_a_run_that_was_killed_with_its_watchdog_are_released_by_the_command_of_the_unit() {
    let unit = include_str!("../../../packaging/ademan.service");
    assert!(unit.contains("\nExecStopPost=-/usr/bin/ademan release-keys\n"));
    let Some(killed) = Killed::new() else {
        return;
    };
    let output = killed
        .command(["release-keys"])
        .output()
        .expect("it starts");
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{err}");
    assert!(
        err.contains("released the keys of a killed run (2)"),
        "{err}"
    );
    assert!(killed.is_released(), "{:?}", killed.server.pressed_keys());
    assert_eq!(records(killed.runtime.path()), [""; 0]);
    let again = killed
        .command(["release-keys"])
        .output()
        .expect("it starts");
    assert!(again.stderr.is_empty(), "{again:?}");
}

#[test]
fn keys_of_a_run_that_was_killed_with_its_watchdog_are_released_by_the_next_run() {
    let Some(killed) = Killed::new() else {
        return;
    };
    let mut run = killed.command(["run", "--source", "script:wait 60000", "--output", "none"]);
    run.stdout(Stdio::null()).stderr(Stdio::null());
    let _run = Process::start(&mut run).expect("it starts");
    assert!(killed.is_released(), "{:?}", killed.server.pressed_keys());
}

#[test]
fn keys_of_a_killed_run_are_released_however_the_display_is_spelled() {
    let Some(killed) = Killed::new() else {
        return;
    };
    let display = format!("unix{}.0", killed.server.display());
    let mut command = killed.command(["release-keys"]);
    let output = command.env("DISPLAY", display).output();
    let output = output.expect("it starts");
    assert!(killed.is_released(), "{output:?}");
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn keys_of_a_killed_run_on_another_display_are_reported() {
    let (Some(killed), Some(other)) = (Killed::new(), XServer::start()) else {
        return;
    };
    let mut command = killed.command(["release-keys"]);
    let output = command.env("DISPLAY", other.display()).output();
    let output = output.expect("it starts");
    let err = String::from_utf8_lossy(&output.stderr);
    let part = format!("2 on the display `{}`", killed.server.display());
    assert!(err.contains(&part), "{err}");
    assert_eq!(killed.server.pressed_keys(), held_keys());
}

#[test]
fn keys_that_the_next_run_cannot_release_are_reported() {
    let runtime = tempfile::tempdir().expect("a folder");
    let folder = runtime.path().join("ademan");
    fs::create_dir(&folder).expect("a folder");
    fs::set_permissions(&folder, Permissions::from_mode(0o700)).expect("an own folder");
    // The key A on a server that is gone.
    let mut record = vec![0_u8; 0x300];
    record[30] = 1;
    record.extend(b":4242");
    let path = folder.join("pressed-1-0");
    fs::write(&path, record).expect("space on the disk");
    fs::set_permissions(&path, Permissions::from_mode(0o600)).expect("an own file");
    let flags = ["--output", "none", "--control", "off"];
    let run = ["run", "--source", "script:wait 10"];
    let output = ademan(run.iter().chain(&flags))
        .env("DISPLAY", ":4242")
        .env("XDG_RUNTIME_DIR", runtime.path())
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("it starts");
    let err = String::from_utf8_lossy(&output.stderr);
    let words = "keys of a killed run may still be pressed: ";
    assert!(err.contains(words), "{err}");
    assert!(path.exists(), "{err}");

    // A record of another display is reported beside the failure.
    let other = fs::read(&path).map(|bytes| [&bytes[..0x300], b":4343"].concat());
    let other_path = folder.join("pressed-2-0");
    fs::write(&other_path, other.expect("the record")).expect("space on the disk");
    fs::set_permissions(&other_path, Permissions::from_mode(0o600)).expect("an own file");
    let released = ademan(["release-keys"])
        .env("DISPLAY", ":4242")
        .env("XDG_RUNTIME_DIR", runtime.path())
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("it starts");
    let messages = String::from_utf8_lossy(&released.stderr);
    assert_eq!(released.status.code(), Some(1), "{messages}");
    assert!(messages.contains("cannot release keys: "), "{messages}");
    assert!(messages.contains("1 on the display `:4343`"), "{messages}");
}

#[test]
fn a_runtime_folder_that_accepts_no_record_is_reported() {
    let Some(server) = XServer::start() else {
        return;
    };
    let runtime = tempfile::tempdir().expect("a folder");
    fs::write(runtime.path().join("ademan"), "").expect("space on the disk");
    let control = runtime.path().join("control").display().to_string();
    let source = [
        "run",
        "--source",
        "script:wait 60000",
        "--output",
        "desktop",
    ];
    let run = ademan(source.into_iter().chain(["--control", &control]));
    let program = Program::from_command(in_session(run, &server, runtime.path()));
    program.wait_for_line("cannot record pressed keys in", 1);
}

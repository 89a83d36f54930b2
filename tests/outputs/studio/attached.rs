//! The window on the session of `ademan run`, which continues whatever the window does.

use std::fs;
use std::process::{Command, Output};

use ademan::command::TextMode;
use ademan::session::control_socket::WatchClient;
use tempfile::TempDir;

use super::safety::close_window;
use super::{end, is_drawn, is_typing, start_screen, studio};
use crate::support::binary::ademan;
use crate::support::program::Program;
use crate::support::x11::XServer;

/// The start of the line that Studio prints when it shows another session.
const ATTACHED: &str = "this window shows the session at";

/// A run at the default control socket of a folder.
pub(super) struct Other {
    pub(super) run: Program,
    folder: TempDir,
}

impl Other {
    /// Starts a run of a hand that types.
    fn start() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let source = format!("typist:{}", "hello ".repeat(300));
        Self::start_in(folder, &["--source", &source])
    }

    /// Starts a run with a setup of this text, in the file `setup.ron`.
    pub(super) fn start_setup(setup: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("setup.ron");
        fs::write(&path, setup).expect("space on the disk");
        Self::start_in(folder, &[&path.display().to_string()])
    }

    fn start_in(folder: TempDir, arguments: &[&str]) -> Self {
        let mut command = ademan(["run"].iter().chain(arguments));
        command.env("XDG_RUNTIME_DIR", folder.path());
        // Studio has been started before: its first start has pages before the window, and a tour.
        let config = folder.path().join("config/ademan");
        fs::create_dir_all(&config).expect("space on the disk");
        let settings = "(has_seen_tour: true)";
        fs::write(config.join("studio.ron"), settings).expect("space on the disk");
        let run = Program::from_command(command);
        run.wait_for_line("armed", 1);
        Self { run, folder }
    }

    /// Opens Studio for this user.
    fn open(&self, server: &XServer, arguments: &[&str]) -> Program {
        self.open_with(server, arguments, |_| {})
    }

    /// Opens Studio with a command that is changed before.
    pub(super) fn open_with(
        &self,
        server: &XServer,
        arguments: &[&str],
        change: impl FnOnce(&mut Command),
    ) -> Program {
        let mut command = studio(server, arguments);
        command
            .env("XDG_RUNTIME_DIR", self.folder.path())
            .env("XDG_CONFIG_HOME", self.folder.path().join("config"));
        change(&mut command);
        Program::from_command(command)
    }

    /// Sends a command to the run and returns the reply.
    pub(super) fn ctl(&self, command: &str) -> String {
        let mut ctl = ademan(["ctl", command]);
        ctl.env("XDG_RUNTIME_DIR", self.folder.path());
        let Output { status, stdout, .. } = ctl.output().expect("the program starts");
        assert!(status.success(), "{command}");
        String::from_utf8_lossy(&stdout).into_owned()
    }

    /// Returns the mode of the text decoder, as the run sends it to a client of its own.
    pub(super) fn text_mode(&self) -> Option<TextMode> {
        let socket = self.folder.path().join("ademan/control.sock");
        let mut client = WatchClient::connect(&socket).expect("the run listens");
        let view = client
            .next_view()
            .expect("a view")
            .expect("the run goes on");
        view.state.text_mode
    }
}

#[test]
fn the_window_shows_a_run_which_goes_on_when_it_is_closed() {
    let Some(server) = start_screen() else {
        return;
    };
    let mut other = Other::start();
    let mut window = other.open(&server, &[]);
    window.wait_for_line(ATTACHED, 1);
    assert!(is_typing(&server), "{:#?}", window.stderr_lines());
    close_window(&server, "Ademán Studio");
    assert!(window.wait_for_exit().success());
    assert!(other.ctl("state").contains("running"));
    assert!(other.run.is_running());
}

#[test]
fn a_window_that_hangs_or_is_killed_does_not_hold_a_run_up() {
    let Some(server) = start_screen() else {
        return;
    };
    let mut other = Other::start();
    let window = other.open(&server, &["--attach"]);
    window.wait_for_line(ATTACHED, 1);
    assert!(is_typing(&server), "{:#?}", window.stderr_lines());
    window.signal(&["STOP"]);
    other.ctl("pause");
    assert!(other.ctl("state").contains("paused by a command"));
    window.signal(&["KILL"]);
    other.ctl("resume");
    other.ctl("stop");
    assert!(other.run.wait_for_exit().success());
}

#[test]
fn a_window_of_its_own_opens_beside_a_run() {
    let Some(server) = start_screen() else {
        return;
    };
    let other = Other::start();
    for arguments in [["--attach", "off"], ["--layout", "qwerty-flat"]] {
        let window = other.open(&server, &arguments);
        // The notice of a session in the program.
        window.wait_for_line("armed", 1);
        assert!(is_drawn(&server), "{:#?}", window.stderr_lines());
        assert_eq!(window.count_lines(ATTACHED), 0, "{arguments:?}");
        end(window);
    }
}

#[test]
fn attaching_to_no_run_is_explained() {
    let folder = tempfile::tempdir().expect("a folder");
    let refuse = |change: &dyn Fn(&mut Command), arguments: &[&str]| {
        let mut command = ademan(["studio", "--attach"].iter().chain(arguments));
        change(&mut command);
        let output = command.output().expect("the program starts");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let empty = |command: &mut Command| _ = command.env("XDG_RUNTIME_DIR", folder.path());
    let says = |reason: String, part: &str| assert!(reason.contains(part), "{reason}");
    says(refuse(&empty, &[]), "no session listens there");
    says(refuse(&empty, &["/nowhere/c.sock"]), "/nowhere/c.sock");
    let none = |command: &mut Command| _ = command.env_remove("XDG_RUNTIME_DIR");
    says(refuse(&none, &[]), "--control");
    let both = refuse(&empty, &["c.sock", "--layout", "media"]);
    says(both, "cannot be used with");
}

//! The window on the session of `ademan run`, which goes on whatever the window does.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use ademan::command::TextMode;
use ademan::session::control_socket::WatchClient;
use ademan::session::view::ViewState;
use tempfile::TempDir;

use super::devices::{ESCAPE, Keyboard, TAB};
use super::safety::close_window;
use super::{is_drawn, is_typing, studio};
use crate::support::binary::ademan;
use crate::support::program::Program;
use crate::support::x11::XServer;

/// The start of the line that Studio prints when it shows another session.
const ATTACHED: &str = "this window shows the session at";

/// A run of a hand that types, at the default control socket of a folder.
struct Other {
    run: Program,
    folder: TempDir,
}

impl Other {
    fn start() -> Self {
        let source = format!("typist:{}", "hello ".repeat(300));
        let folder = tempfile::tempdir().expect("a folder");
        Self::run(folder, &["--source", &source])
    }

    fn run(folder: TempDir, arguments: &[&str]) -> Self {
        let mut command = ademan(["run"].iter().chain(arguments));
        command.env("XDG_RUNTIME_DIR", folder.path());
        let run = Program::from_command(command);
        run.wait_for_line("armed", 1);
        Self { run, folder }
    }

    /// Opens Studio for this user.
    fn open(&self, server: &XServer, arguments: &[&str]) -> Program {
        let mut command = studio(server, arguments);
        command.env("XDG_RUNTIME_DIR", self.folder.path());
        Program::from_command(command)
    }

    /// Sends a command to the run and returns the reply.
    fn ctl(&self, command: &str) -> String {
        let mut ctl = ademan(["ctl", command]);
        ctl.env("XDG_RUNTIME_DIR", self.folder.path());
        let Output { status, stdout, .. } = ctl.output().expect("the program starts");
        assert!(status.success(), "{command}");
        String::from_utf8_lossy(&stdout).into_owned()
    }
}

#[test]
fn the_window_shows_a_run_which_goes_on_when_it_is_closed() {
    let Some(server) = XServer::start() else {
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
    let Some(server) = XServer::start() else {
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

/// A setup with two profiles and a text decoder, whose hand rests.
const TWO_PROFILES: &str = "Setup(
    source: \"script:wait 600000\",
    output: \"none\",
    profiles: [(name: \"arc\", layout: \"qwerty-arc\")],
    text: (mode: Literal),
)";

/// The number of widgets before the menu of the session in the toolbar, which the Tab key visits first: three workspaces and three
/// commands.
const BEFORE_MENU: usize = 6;

/// Views of two seconds of a hand that is seen.
const MAX_VIEWS: usize = 60;

/// Chooses an entry of the menu of the session, with the keyboard.
fn choose(keyboard: &Keyboard, entry: usize) {
    let space = u32::from(' ');
    keyboard.tap(ESCAPE);
    for _ in 0..=BEFORE_MENU {
        keyboard.tap(TAB);
    }
    keyboard.tap(space);
    for _ in 0..=entry {
        keyboard.tap(TAB);
    }
    keyboard.tap(space);
}

/// Returns the first state that meets a condition, of those of the next seconds.
fn state_where(socket: &Path, condition: impl Fn(&ViewState) -> bool) -> Option<ViewState> {
    let mut client = WatchClient::connect(socket).expect("the run listens");
    for _ in 0..MAX_VIEWS {
        let view = client.next_view().expect("a view").expect("it runs");
        if condition(&view.state) {
            return Some(ViewState::clone(&view.state));
        }
    }
    None
}

#[test]
fn the_menu_of_the_session_changes_profile_and_text_mode_of_a_run() {
    let Some(server) = XServer::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let setup = folder.path().join("sofa.ron");
    let socket = folder.path().join("c.sock");
    fs::write(&setup, TWO_PROFILES).expect("space on the disk");
    let [setup, control] = [&setup, &socket].map(|path| path.to_str().expect("a plain path"));
    let other = Other::run(folder, &[setup, "--control", control]);
    let state = state_where(&socket, |_| true).expect("a view");
    assert_eq!(
        (state.name.as_str(), state.process),
        ("sofa.ron", Some(other.run.id()))
    );
    let mut command = studio(&server, &["--attach", control]);
    command.env("XDG_CONFIG_HOME", other.folder.path());
    let window = Program::from_command(command);
    window.wait_for_line(ATTACHED, 1);
    assert!(is_drawn(&server), "{:#?}", window.stderr_lines());
    server.focus_visible_window();
    let keyboard = Keyboard::new(&server);
    let changed = |condition: &dyn Fn(&ViewState) -> bool| {
        let changed = state_where(&socket, condition);
        assert!(changed.is_some(), "{:#?}", window.stderr_lines());
    };
    choose(&keyboard, 0);
    changed(&|state| state.profile == "arc");
    for (entry, mode) in [
        (3, TextMode::Auto),
        (2, TextMode::Suggest),
        (1, TextMode::Literal),
    ] {
        choose(&keyboard, entry);
        changed(&|state| state.text_mode == Some(mode));
    }
    choose(&keyboard, 0);
    changed(&|state| state.profile == "main");
}

#[test]
fn a_window_of_its_own_opens_beside_a_run() {
    let Some(server) = XServer::start() else {
        return;
    };
    let other = Other::start();
    for arguments in [["--attach", "off"], ["--layout", "qwerty-flat"]] {
        let mut window = other.open(&server, &arguments);
        // The notice of a session in the program.
        window.wait_for_line("armed", 1);
        assert!(is_drawn(&server), "{:#?}", window.stderr_lines());
        assert_eq!(window.count_lines(ATTACHED), 0, "{arguments:?}");
        window.signal(&["TERM"]);
        assert!(window.wait_for_exit().success());
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

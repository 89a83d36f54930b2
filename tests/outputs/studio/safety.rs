//! Typing with a window that hangs, is closed or loses its desktop: events go on, and nothing stays pressed.

use std::fs;
use std::process::Command;

use tempfile::TempDir;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{AtomEnum, ClientMessageEvent, ConnectionExt, EventMask, Window};

use super::{is_drawn, start_screen, studio};
use crate::support::program::{Program, WATCHDOG_LOST};
use crate::support::x11::{XServer, wait_for};
use crate::x11::start_until;

/// Studio with a hand that types without end, and a setup that names an output.
///
/// The hand is simulated in the program: a busy machine, on which the window draws slowly, would delay a glove.
pub(super) struct Session {
    pub(super) server: XServer,
    pub(super) program: Program,
    folder: TempDir,
}

impl Session {
    /// Opens the window. A transcript in the output is in a temporary folder.
    pub(super) fn start(output: &str) -> Option<Self> {
        Self::start_with(output, |_| {})
    }

    /// Opens the window with a command that is changed before.
    pub(super) fn start_with(output: &str, change: impl FnOnce(&mut Command)) -> Option<Self> {
        let server = start_screen()?;
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().display().to_string();
        let setup = format!("Setup(output: \"{output}\")");
        fs::write(folder.path().join("setup.ron"), setup).expect("space on the disk");
        let setup_path = format!("{path}/setup.ron");
        let mut command = studio(&server, &[&setup_path, "--allow-root"]);
        command.env("XDG_STATE_HOME", &path);
        change(&mut command);
        let program = Program::from_command(command);
        program.wait_for_line("armed", 1);
        assert!(is_drawn(&server), "{:#?}", program.stderr_lines());
        Some(Self {
            server,
            program,
            folder,
        })
    }

    /// Returns the number of events of this kind in the transcript.
    fn count(&self, kind: &str) -> usize {
        self.transcript("events").matches(kind).count()
    }

    /// Returns the transcript of this name, which is empty if there is none.
    pub(super) fn transcript(&self, name: &str) -> String {
        let file = self.folder.path().join("ademan/transcripts").join(name);
        fs::read_to_string(file).unwrap_or_default()
    }

    /// Waits until another key is pressed and, later, another one is released, as the transcript has it.
    pub(super) fn wait_for_typing(&self) {
        for kind in ["down ", "up   "] {
            let before = self.count(kind);
            assert!(
                wait_for(|| self.count(kind) > before),
                "no {kind:?}: {:#?}",
                self.program.stderr_lines()
            );
        }
    }

    /// Opens the window of a hand that types on the X server, and waits until a key is down there.
    ///
    /// A window that is drawn without a graphics card may starve the watchdog for the 300 ms after which it counts as lost. Then the
    /// session is paused until a person resumes it, and another one is started.
    fn start_pressing() -> Option<Self> {
        start_until(|| Self::start("desktop"), Self::is_pressing)
    }

    /// Waits until a key is down on the X server. Returns `false` if the session loses its watchdog.
    fn is_pressing(&self) -> bool {
        let mut is_pressed = false;
        let is_over = wait_for(|| {
            is_pressed = !self.server.pressed_keys().is_empty();
            is_pressed || self.program.count_lines(WATCHDOG_LOST) > 0
        });
        assert!(is_over, "{:#?}", self.program.stderr_lines());
        is_pressed
    }

    /// Checks that the program exits with one of these codes and that no key is pressed.
    pub(super) fn check_end(mut self, codes: &[i32]) {
        let status = self.program.wait_for_exit();
        let is_expected = status.code().is_some_and(|code| codes.contains(&code));
        assert!(is_expected, "{status}: {:#?}", self.program.stderr_lines());
        assert_eq!(self.server.pressed_keys(), [0; 0]);
    }
}

/// Output into a file, which does not need the X server of the window.
pub(super) const TRANSCRIPT: &str = "transcript:events";

#[test]
fn typing_goes_on_while_the_window_hangs() {
    let Some(mut session) = Session::start(TRANSCRIPT) else {
        return;
    };
    session.wait_for_typing();
    // The window waits for the server at its next picture.
    session.server.freeze();
    for _ in 0..5 {
        session.wait_for_typing();
    }
    session.program.signal(&["TERM"]);
    let code = session.program.wait_for_exit().code();
    assert_eq!(code, Some(130), "{:#?}", session.program.stderr_lines());
    assert!(session.count("down ") > 5);
    assert_eq!(session.count("down "), session.count("up   "));
    session.server.thaw();
}

#[test]
fn a_lost_desktop_ends_the_program() {
    let Some(mut session) = Session::start(TRANSCRIPT) else {
        return;
    };
    session.wait_for_typing();
    session.server.kill();
    // The X11 library ends the process itself.
    let status = session.program.wait_for_exit();
    assert_eq!(
        status.code(),
        Some(1),
        "{:#?}",
        session.program.stderr_lines()
    );
}

#[test]
fn a_lost_desktop_ends_the_watchdog_of_pressed_keys() {
    let Some(mut session) = Session::start_pressing() else {
        return;
    };
    let children = session.program.children();
    assert!(!children.is_empty(), "no watchdog");
    session.server.kill();
    let status = session.program.wait_for_exit();
    assert!(!status.success(), "{:#?}", session.program.stderr_lines());
    let has_exited = |child: &u32| {
        let stat = fs::read_to_string(format!("/proc/{child}/stat")).unwrap_or_default();
        stat.is_empty() || stat.contains(") Z")
    };
    assert!(
        wait_for(|| children.iter().all(has_exited)),
        "the watchdog exits too"
    );
}

#[test]
fn closing_the_window_releases_everything() {
    let Some(session) = Session::start_pressing() else {
        return;
    };
    close_window(&session.server, "Ademán Studio");
    session.check_end(&[0]);
}

#[test]
fn signals_release_everything() {
    for signal in ["TERM", "INT", "HUP"] {
        let Some(session) = Session::start_pressing() else {
            return;
        };
        session.program.signal(&[signal]);
        // On a busy machine the window takes longer to close than an orderly end may.
        session.check_end(&[0, 130]);
    }
}

#[test]
fn a_killed_studio_leaves_no_key_pressed() {
    let Some(mut session) = Session::start_pressing() else {
        return;
    };
    session.program.signal(&["KILL"]);
    assert!(session.server.wait_for_keys(&[]));
    assert_eq!(session.program.wait_for_exit().code(), None);
}

/// Asks a window to close, as the button of a window manager does.
pub(super) fn close_window(server: &XServer, title: &str) {
    let (client, screen) = x11rb::connect(Some(server.display())).expect("the server answers");
    let root = client.setup().roots[screen].root;
    let mut found = None;
    assert!(
        wait_for(|| {
            found = find_window(&client, root, title);
            found.is_some()
        }),
        "no window {title:?}"
    );
    let window = found.expect("a window");
    let atom = |name: &str| {
        let atom = client.intern_atom(false, name.as_bytes());
        atom.expect("a request").reply().expect("an atom").atom
    };
    let data = [atom("WM_DELETE_WINDOW"), 0, 0, 0, 0];
    let event = ClientMessageEvent::new(32, window, atom("WM_PROTOCOLS"), data);
    client
        .send_event(false, window, EventMask::NO_EVENT, event)
        .expect("a request")
        .check()
        .expect("the window exists");
}

/// Returns the window with this title, at any depth.
fn find_window(client: &impl Connection, window: Window, title: &str) -> Option<Window> {
    let name = client
        .get_property(false, window, AtomEnum::WM_NAME, AtomEnum::ANY, 0, 64)
        .ok()?
        .reply()
        .ok()?;
    let utf8 = client
        .intern_atom(false, b"_NET_WM_NAME")
        .ok()?
        .reply()
        .ok()?;
    let utf8_name = client
        .get_property(false, window, utf8.atom, AtomEnum::ANY, 0, 64)
        .ok()?
        .reply()
        .ok()?;
    if name.value == title.as_bytes() || utf8_name.value == title.as_bytes() {
        return Some(window);
    }
    let children = client.query_tree(window).ok()?.reply().ok()?.children;
    children
        .into_iter()
        .find_map(|child| find_window(client, child, title))
}

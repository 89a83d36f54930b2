//! The overlay over other programs: they receive the keys and the clicks, and keep the focus.

use std::fs;
use std::io::ErrorKind;
use std::process::{Command, Stdio};

use tempfile::TempDir;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ConnectionExt, MOTION_NOTIFY_EVENT,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

use super::{LIT, colors, end, studio};
use crate::support::process::Process;
use crate::support::program::Program;
use crate::support::x11::{InputWindow, TerminalWindow, XServer, wait_for};

/// The text that the simulated hand types.
const TEXT: &str = "Over it, 1 tap each.";

/// Starts a compositor. Returns `None` with a message if it is not installed.
fn compositor(server: &XServer) -> Option<Process> {
    let mut command = Command::new("picom");
    command
        .args(["--backend", "xrender", "--config", "/dev/null"])
        .env("DISPLAY", server.display())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let process = match Process::start(&mut command) {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("SKIPPED: picom is not installed");
            return None;
        }
        started => started.expect("picom starts"),
    };
    let client = Client::connect(server);
    assert!(wait_for(|| client.has_compositor()), "picom composes");
    Some(process)
}

/// A client that acts as a person.
struct Client(RustConnection);

impl Client {
    fn connect(server: &XServer) -> Self {
        let (client, _) = x11rb::connect(Some(server.display())).expect("the server answers");
        Self(client)
    }

    fn has_compositor(&self) -> bool {
        let atom = self.0.intern_atom(false, b"_NET_WM_CM_S0");
        let atom = atom.expect("the server runs").reply().expect("an atom");
        let owner = self.0.get_selection_owner(atom.atom);
        let owner = owner.expect("the server runs").reply().expect("an answer");
        owner.owner != x11rb::NONE
    }

    fn focus(&self) -> u32 {
        let focus = self.0.get_input_focus().expect("the server runs");
        focus.reply().expect("an answer").focus
    }

    fn click(&self, x: i16, y: i16) {
        let root = self.0.setup().roots[0].root;
        for (kind, detail) in [
            (MOTION_NOTIFY_EVENT, 0),
            (BUTTON_PRESS_EVENT, 1),
            (BUTTON_RELEASE_EVENT, 1),
        ] {
            let sent = self
                .0
                .xtest_fake_input(kind, detail, x11rb::CURRENT_TIME, root, x, y, 0);
            sent.expect("the server runs").check().expect("a click");
        }
    }

    /// Returns left, top, width and height of the overlay, which is the highest window with its name.
    fn overlay(&self) -> Option<(i16, i16, u16, u16)> {
        let root = self.0.setup().roots[0].root;
        let tree = self.0.query_tree(root).ok()?.reply().ok()?;
        let class = x11rb::protocol::xproto::AtomEnum::WM_CLASS;
        let is_overlay = |window: &u32| {
            let string = x11rb::protocol::xproto::AtomEnum::STRING;
            let property = self
                .0
                .get_property(false, *window, class, string, 0, 64)
                .ok();
            let property = property.and_then(|property| property.reply().ok());
            property.is_some_and(|property| {
                String::from_utf8_lossy(&property.value).contains("ademan-overlay")
            })
        };
        let window = tree.children.iter().rev().copied().find(is_overlay)?;
        let place = self.0.get_geometry(window).ok()?.reply().ok()?;
        (place.width > 1).then_some((place.x, place.y, place.width, place.height))
    }
}

/// Starts the overlay of a hand that types a text, or that types without end.
fn overlay(server: &XServer, text: Option<&str>, output: &str) -> (Program, TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let setup = folder.path().join("setup.ron");
    let source = text.map_or_else(String::new, |text| format!("source: \"typist:{text}\", "));
    let content = format!("Setup({source}output: \"{output}\")");
    fs::write(&setup, content).expect("space on the disk");
    // Opaque keys have the colors of the theme.
    let settings = folder.path().join("ademan");
    fs::create_dir(&settings).expect("space on the disk");
    fs::write(settings.join("studio.ron"), "(overlay: (opacity: 1.0))").expect("space on the disk");
    let setup = setup.display().to_string();
    let mut command = studio(server, &["--overlay", "--allow-root", &setup]);
    command.env("XDG_CONFIG_HOME", folder.path());
    (Program::from_command(command), folder)
}

#[test]
fn the_program_below_the_overlay_receives_every_byte_and_keeps_the_focus() {
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(_compositor) = compositor(&server) else {
        return;
    };
    let Some(terminal) = TerminalWindow::start(&server) else {
        return;
    };
    let client = Client::connect(&server);
    let focus = client.focus();
    let (mut program, _folder) = overlay(&server, Some(TEXT), "desktop");
    let is_lit = wait_for(|| colors(server.display()).contains(&LIT));
    assert_eq!(client.focus(), focus, "the terminal keeps the focus");
    assert_eq!(terminal.typed(TEXT), TEXT);
    let status = program.wait_for_exit();
    let messages = program.stderr_lines();
    assert!(status.success(), "{status}: {messages:#?}");
    assert!(is_lit, "a pressed key lights up: {messages:#?}");
    assert_eq!(server.pressed_keys(), [0; 0]);
}

#[test]
fn a_click_on_the_overlay_reaches_the_window_below() {
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(_compositor) = compositor(&server) else {
        return;
    };
    let below = InputWindow::open(&server);
    let client = Client::connect(&server);
    let focus = client.focus();
    let (program, _folder) = overlay(&server, None, "none");
    let is_lit = wait_for(|| colors(server.display()).contains(&LIT));
    assert!(is_lit, "{:#?}", program.stderr_lines());
    let (left, top, width, height) = client.overlay().expect("the overlay has a window");
    assert!(width > 300 && height > 100, "{width} × {height}");
    let (x, y) = (left + width as i16 / 2, top + height as i16 / 2);
    client.click(x, y);
    let last = format!("up 1 at {x},{y}");
    let events = below.events_until(&last);
    assert_eq!(events.last(), Some(&last), "{events:?}");
    assert_eq!(client.focus(), focus);
    end(program);
}

#[test]
fn without_a_compositor_the_overlay_is_small_and_says_so() {
    let Some(server) = XServer::start() else {
        return;
    };
    let below = InputWindow::open(&server);
    let client = Client::connect(&server);
    let focus = client.focus();
    let (mut program, _folder) = overlay(&server, None, "none");
    let is_lit = wait_for(|| colors(server.display()).contains(&LIT));
    assert!(is_lit, "{:#?}", program.stderr_lines());
    let (left, top, width, height) = client.overlay().expect("the overlay has a window");
    assert!(width < 400 && height < 250, "{width} × {height}");
    client.click(left + 10, top + 10);
    let last = format!("up 1 at {},{}", left + 10, top + 10);
    assert_eq!(below.events_until(&last).last(), Some(&last));
    assert_eq!(client.focus(), focus);
    program.signal(&["TERM"]);
    let code = program.wait_for_exit().code();
    let messages = program.stderr_lines();
    // On a busy machine the window takes longer to close than an orderly end may.
    assert!(matches!(code, Some(0 | 130)), "{code:?}: {messages:#?}");
    assert_eq!(program.count_lines("no compositor runs"), 1);
}

//! Profiles that follow the application with the focus, with a window manager and terminals of several classes.

use std::io::ErrorKind;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use x11rb::connection::Connection;
use x11rb::properties::WmClass;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ClientMessageEvent, ConnectionExt, EventMask, Window,
};
use x11rb::rust_connection::RustConnection;

use super::ends::held_keys;
use super::hold;
use crate::prepared_run::{FOCUS_SETUP, PROFILE_STAYS, PreparedRun, end_where_the_profile_stays};
use crate::support::key_log::KeyLog;
use crate::support::process::Process;
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_for};
use crate::views::{Views, request};

/// A window manager, and a client that activates windows as a taskbar does.
struct Manager {
    client: RustConnection,
    root: Window,
    _process: Process,
}

impl Manager {
    /// Starts `openbox`. Returns `None` with a message if it is not installed.
    fn start(server: &XServer) -> Option<Self> {
        let mut command = Command::new("openbox");
        command
            .env("DISPLAY", server.display())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let process = match Process::start(&mut command) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                println!("SKIPPED: openbox is not installed");
                return None;
            }
            started => started.expect("openbox starts"),
        };
        let (client, screen) = x11rb::connect(Some(server.display())).expect("the server answers");
        let manager = Self {
            root: client.setup().roots[screen].root,
            client,
            _process: process,
        };
        let is_ready = || {
            !manager
                .property("_NET_SUPPORTED", AtomEnum::ATOM)
                .is_empty()
        };
        assert!(wait_for(is_ready), "openbox manages the screen");
        Some(manager)
    }

    fn atom(&self, name: &str) -> Atom {
        let atom = self.client.intern_atom(false, name.as_bytes());
        atom.expect("the server runs")
            .reply()
            .expect("a reply")
            .atom
    }

    fn property(&self, name: &str, kind: AtomEnum) -> Vec<u32> {
        let name = self.atom(name);
        let property = self
            .client
            .get_property(false, self.root, name, kind, 0, 1024);
        let property = property.expect("the server runs").reply().expect("a reply");
        property.value32().into_iter().flatten().collect()
    }

    /// Returns the windows whose class this is.
    fn windows(&self, class: &str) -> Vec<Window> {
        let mut windows = self.property("_NET_CLIENT_LIST", AtomEnum::WINDOW);
        windows.retain(|window| {
            let found = WmClass::get(&self.client, *window).expect("the server runs");
            let found = found.reply().ok().flatten();
            found.is_some_and(|found| found.class() == class.as_bytes())
        });
        windows
    }

    /// Opens a terminal of this class, and returns it once it is active.
    fn open(&self, server: &XServer, class: &str) -> (Process, Window) {
        let before = self.windows(class);
        let mut command = Command::new("xterm");
        command
            .args(["-class", class, "-e", "sleep", "1000"])
            .env("DISPLAY", server.display())
            .stderr(Stdio::null());
        let process = Process::start(&mut command).expect("xterm starts");
        let mut window = None;
        let is_open = || {
            window = self
                .windows(class)
                .into_iter()
                .find(|it| !before.contains(it));
            window.is_some()
        };
        assert!(wait_for(is_open), "a window of {class}");
        let window = window.expect("it is open");
        self.activate(window);
        (process, window)
    }

    /// Asks for a window to be active, and waits until it is.
    fn activate(&self, window: Window) {
        let by_a_taskbar = [2, x11rb::CURRENT_TIME, 0, 0, 0];
        let message =
            ClientMessageEvent::new(32, window, self.atom("_NET_ACTIVE_WINDOW"), by_a_taskbar);
        let mask = EventMask::SUBSTRUCTURE_REDIRECT | EventMask::SUBSTRUCTURE_NOTIFY;
        let sent = self.client.send_event(false, self.root, mask, message);
        sent.expect("the server runs").check().expect("a message");
        let is_active = || self.property("_NET_ACTIVE_WINDOW", AtomEnum::WINDOW) == [window];
        assert!(wait_for(is_active), "window {window:x} is active");
    }
}

#[test]
fn held_keys_are_released_before_the_profile_of_another_application_and_a_choice_stays() {
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(manager) = Manager::start(&server) else {
        return;
    };
    let run = PreparedRun::new(FOCUS_SETUP);
    let control = &run.control;
    let (_plain, plain) = manager.open(&server, "Plain");
    let log = KeyLog::start(&server);
    let mut program = Program::start(&server, run.arguments("desktop"));
    program.wait_for_line("armed", 1);
    let views = Views::start(control);
    hold(&server, &program, &run.glove, &run.press, &held_keys());
    assert!(wait_for(|| views.has_pressed_key()), "{:?}", views.all());
    // The log is of a thread of its own, which may be late.
    let is_logged = wait_for(|| log.pressed().len() == held_keys().len());
    assert!(is_logged, "{:?}", log.events());
    let before = log.len();

    let (_first, _) = manager.open(&server, "Coder");
    views.wait_for_profile("code");
    assert!(server.wait_for_keys(&[]), "{:?}", server.pressed_keys());
    let mut held = views.all().into_iter().filter(|(_, keys)| !keys.is_empty());
    assert!(
        held.all(|(profile, _)| profile == "main"),
        "{:?}",
        views.all()
    );
    assert_eq!(
        log.presses_after(before),
        0,
        "the finger has not been lifted"
    );
    let state = request(control, r#"{"command":"state"}"#);
    assert_eq!(
        (&state["profile"], &state["application"]),
        (&"code".into(), &"coder".into())
    );

    request(control, r#"{"command":"profile","name":"sofa"}"#);
    views.wait_for_profile("sofa");
    let (_second, _) = manager.open(&server, "Coder");
    // Time for a change that must not come.
    thread::sleep(Duration::from_millis(300));
    manager.activate(plain);
    views.wait_for_profile("main");
    assert_eq!(views.profiles(), ["main", "code", "sofa", "main"]);
    let last_state = request(control, r#"{"command":"state"}"#);
    assert_eq!(last_state.get("application"), None, "no rule holds");

    program.signal(&["TERM"]);
    assert_eq!(program.wait_for_exit().code(), Some(0));
    let errors = program.stderr_lines().join("\n");
    println!("{:?}\n{errors}", views.profiles());
    assert!(
        !errors.contains("Coder") && !errors.contains("Plain"),
        "{errors}"
    );
}

#[test]
fn without_a_window_manager_the_profile_stays_and_the_reason_is_said_once() {
    let Some(server) = XServer::start() else {
        return;
    };
    let run = PreparedRun::new(FOCUS_SETUP);
    let mut program = Program::start(&server, run.arguments("desktop"));
    program.wait_for_line(&format!("{PROFILE_STAYS}no window manager tells"), 1);
    program.wait_for_line("armed", 1);
    hold(&server, &program, &run.glove, &run.press, &held_keys());
    end_where_the_profile_stays(&mut program);
}

#[test]
fn a_run_goes_on_with_its_profile_when_the_desktop_ends() {
    let Some(mut server) = XServer::start() else {
        return;
    };
    let Some(manager) = Manager::start(&server) else {
        return;
    };
    let run = PreparedRun::new(FOCUS_SETUP);
    let control = &run.control;
    let (_coder, _) = manager.open(&server, "Coder");
    let mut program = Program::start(&server, run.arguments("none"));
    program.wait_for_line("armed", 1);
    Views::start(control).wait_for_profile("code");
    server.kill();
    program.wait_for_line(PROFILE_STAYS, 1);
    run.glove.play(&run.press.approach);
    let state = request(control, r#"{"command":"state"}"#);
    assert_eq!(state["profile"], "code");
    assert_eq!(state.get("application"), None, "no rule is known to hold");
    end_where_the_profile_stays(&mut program);
}

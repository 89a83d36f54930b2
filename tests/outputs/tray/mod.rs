//! The icon in the tray and the notifications, on a bus with a desktop that is written with another D-Bus library.
//!
//! `cargo test --features tray --test outputs tray::`; on Debian, install `dbus python3-gi`.

mod desktop;

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::process::Command;

use serde_json::{Value, json};

use self::desktop::Desktop;
use crate::prepared_run::PreparedRun;
use crate::session_bus::Bus;
use crate::support::binary::ademan;
use crate::support::process::signal;
use crate::support::program::Program;
use crate::support::x11::wait_for;
use crate::views::{Views, request};

const SETUP: &str = "Setup(
    stall_timeout_ms: 5000,
    tray: true,
    notify: true,
    profiles: [(name: \"num_pad\", layout: \"numpad\")],
)";

/// A run without an effect on other programs, whose wearer keeps the hand clear of all keys.
struct Run {
    program: Program,
    prepared: PreparedRun,
}

impl Run {
    /// Starts a run on the bus at this address and waits until it is armed.
    fn start(address: &str) -> Self {
        let prepared = PreparedRun::new(SETUP);
        let mut command = ademan(prepared.arguments("none"));
        command.env("DBUS_SESSION_BUS_ADDRESS", address);
        let program = Program::from_command(command);
        program.wait_for_line("armed", 1);
        Self { program, prepared }
    }

    fn state(&self) -> Value {
        request(&self.prepared.control, r#"{"command":"state"}"#)
    }

    /// Checks that a press arrives, and lifts the hand.
    fn assert_types(&self) {
        let views = Views::start(&self.prepared.control);
        let is_pressed = self.prepared.wait_for_press(&views);
        assert!(is_pressed, "{:#?}", self.program.stderr_lines());
        self.prepared.glove.play(&self.prepared.press.lift);
        assert!(wait_for(|| !views.has_pressed_key()));
    }

    fn end(mut self) {
        self.program.signal(&["TERM"]);
        assert_eq!(self.program.wait_for_exit().code(), Some(0));
    }
}

/// Returns an assertion that the last line of a kind has these fields.
fn icon(name: &str, status: &str, tip: &str) -> impl Fn(&Value) -> bool {
    let expected = [json!(name), json!(status), json!(tip)];
    move |line| [&line["icon"], &line["status"], &line["tip"][0]] == expected.each_ref()
}

#[test]
fn the_tray_shows_the_state_and_its_menu_controls_the_run() {
    let Some(bus) = Bus::start() else {
        return;
    };
    let Some(mut desktop) = Desktop::start(&bus) else {
        return;
    };
    let mut run = Run::start(&bus.address());
    // A unique name.
    desktop.wait_for("registered", |line| {
        line["registered"]
            .as_str()
            .is_some_and(|name| name.starts_with(':'))
    });
    desktop.wait_for(
        "status",
        icon("input-keyboard", "Active", "Ademán is armed"),
    );
    let menu = |first: &str, pause: &str, profiles: [&str; 2]| {
        json!([
            first,
            "-",
            pause,
            "-",
            profiles[0],
            profiles[1],
            "-",
            "End the session"
        ])
    };
    let pause = "Pause: release everything";
    let armed = menu("Ademán is armed", pause, ["*main", "num__pad"]);
    desktop.wait_for("entries", |line| line["entries"] == armed);

    desktop.click(pause);
    run.program.wait_for_line("paused by a command", 1);
    desktop.wait_for(
        "status",
        icon("media-playback-pause", "Active", "Ademán is paused"),
    );
    let paused = menu("Ademán is paused", "Resume", ["*main", "num__pad"]);
    desktop.wait_for("entries", |line| line["entries"] == paused);

    desktop.click("Resume");
    run.program.wait_for_line("armed: ", 2);
    desktop.wait_for("entries", |line| line["entries"] == armed);

    desktop.click("num__pad");
    let other = menu("Ademán is armed", pause, ["main", "*num__pad"]);
    desktop.wait_for("entries", |line| line["entries"] == other);
    assert_eq!(run.state()["profile"], "num_pad");

    run.prepared.glove.stop_sending();
    desktop.wait_for(
        "status",
        icon("dialog-warning", "NeedsAttention", "Ademán: no readings"),
    );
    desktop.click("End the session");
    assert_eq!(run.program.wait_for_exit().code(), Some(0));
}

/// Calls the menu as a user, and returns whether the call was executed, and the error.
fn click_as(user: &str, bus: &Bus, service: &str) -> (bool, String) {
    let output = Command::new("setpriv")
        .args([
            &format!("--reuid={user}"),
            "--clear-groups",
            "gdbus",
            "call",
        ])
        .args(["--address", &bus.address(), "--dest", service])
        .args(["--object-path", "/MenuBar"])
        .args([
            "--method",
            "com.canonical.dbusmenu.Event",
            "2",
            "clicked",
            "<''>",
            "0",
        ])
        .output();
    let output = output.expect("setpriv starts");
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.success(), error)
}

#[test]
fn the_menu_refuses_another_user() {
    let root = fs::metadata("/proc/self").expect("a process").uid() == 0;
    if !root || Command::new("gdbus").arg("help").output().is_err() {
        println!("SKIPPED: needs root and gdbus, which is part of libglib2.0-bin");
        return;
    }
    let Some(bus) = Bus::start() else {
        return;
    };
    let Some(desktop) = Desktop::start(&bus) else {
        return;
    };
    bus.open_to_all();
    let run = Run::start(&bus.address());
    desktop.wait_for("registered", |_| true);
    let service = &desktop.lines("registered")[0]["registered"];
    let service = service.as_str().expect("a name");
    let (is_executed, error) = click_as("65534", &bus, service);
    assert!(!is_executed && error.contains("AccessDenied"), "{error}");
    assert_eq!(run.state()["paused"], false);
    let (is_executed_as_root, root_error) = click_as("0", &bus, service);
    assert!(is_executed_as_root, "{root_error}");
    assert!(wait_for(|| run.state()["paused"] == true));
    run.end();
}

#[test]
fn a_pause_a_loss_and_their_ends_are_shown_in_one_notification() {
    let Some(bus) = Bus::start() else {
        return;
    };
    let Some(mut desktop) = Desktop::start(&bus) else {
        return;
    };
    let run = Run::start(&bus.address());
    let is = |summary: &'static str| move |line: &Value| line["summary"] == summary;
    request(&run.prepared.control, r#"{"command":"pause"}"#);
    desktop.wait_for("summary", is("Ademán is paused"));
    request(&run.prepared.control, r#"{"command":"resume"}"#);
    desktop.wait_for("summary", is("Ademán is armed"));
    run.prepared.glove.stop_sending();
    desktop.wait_for("summary", is("Ademán: no readings"));
    let shown = desktop.lines("summary");
    println!("{shown:#?}");
    let replaced: Vec<_> = shown.iter().map(|line| line["replaces"].clone()).collect();
    assert_eq!(
        replaced,
        [json!(0), json!(7), json!(7)],
        "the first arming is not shown"
    );
    assert_eq!(
        shown[0]["body"],
        "Everything is released. Paused by a command."
    );
    // KDE Plasma shows nothing in place of a notification that was closed.
    desktop.click("close the notification");
    desktop.wait_for("closed", |_| true);
    request(&run.prepared.control, r#"{"command":"pause"}"#);
    assert!(wait_for(|| desktop.lines("summary").len() == 4));
    assert_eq!(desktop.lines("summary")[3]["replaces"], 0);
    let urgencies: Vec<_> = shown.iter().map(|line| line["urgency"].clone()).collect();
    assert_eq!(urgencies, [json!(1), json!(0), json!(1)]);
    run.end();
}

#[test]
fn notifications_are_shown_without_the_icon_that_the_bus_refuses() {
    let names = [
        "org.kde.StatusNotifierWatcher",
        "org.freedesktop.Notifications",
    ];
    let Some(bus) = Bus::start_with_names(&names) else {
        return;
    };
    let Some(desktop) = Desktop::start(&bus) else {
        return;
    };
    let run = Run::start(&bus.address());
    run.program.wait_for_line("no icon in the tray: ", 1);
    request(&run.prepared.control, r#"{"command":"pause"}"#);
    desktop.wait_for("summary", |line| line["summary"] == "Ademán is paused");
    run.end();
}

#[test]
fn a_desktop_that_hangs_and_a_bus_that_ends_do_not_disturb_the_run() {
    let Some(mut bus) = Bus::start() else {
        return;
    };
    let Some(desktop) = Desktop::start(&bus) else {
        return;
    };
    let run = Run::start(&bus.address());
    desktop.wait_for(
        "status",
        icon("input-keyboard", "Active", "Ademán is armed"),
    );
    signal("STOP", desktop.id());
    request(&run.prepared.control, r#"{"command":"pause"}"#);
    request(&run.prepared.control, r#"{"command":"resume"}"#);
    run.program.wait_for_line("armed: ", 2);
    run.assert_types();
    bus.kill();
    let ended =
        "neither tray nor notifications from now on: the session bus of the desktop has ended";
    run.program.wait_for_line(ended, 1);
    run.assert_types();
    assert_eq!(run.program.count_lines(ended), 1);
    let warnings = run.program.count_lines("WARN");
    assert_eq!(warnings, 0, "{:#?}", run.program.stderr_lines());
    run.end();
}

#[test]
fn a_desktop_that_starts_later_shows_the_icon_and_what_is_missing_is_said_once() {
    let Some(bus) = Bus::start() else {
        return;
    };
    let run = Run::start(&bus.address());
    run.program.wait_for_line(
        "no icon in the tray: no program of this desktop shows icons",
        1,
    );
    request(&run.prepared.control, r#"{"command":"pause"}"#);
    run.program.wait_for_line("no notification is shown: ", 1);
    let Some(desktop) = Desktop::start(&bus) else {
        return;
    };
    desktop.wait_for(
        "status",
        icon("media-playback-pause", "Active", "Ademán is paused"),
    );
    assert_eq!(run.program.count_lines("no icon in the tray"), 1);
    run.end();

    let lone = Run::start("unix:path=/nowhere/bus");
    lone.program
        .wait_for_line("the session bus of the desktop cannot be reached", 1);
    lone.assert_types();
    lone.end();
}

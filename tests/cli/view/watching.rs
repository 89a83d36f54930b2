//! `ademan watch`.

use std::time::{Duration, Instant};
use std::{fs, thread};

use serde_json::Value;

use super::screen::Screen;
use super::{is_lit, set_terminal, stop_and_continue};
use crate::ademan;
use crate::support::process::{Process, signal};
use crate::support::run::{Run, TIMEOUT};
use crate::support::x11::wait_for;
use ademan::layout::Fit;
use ademan::session::control_socket::{Client, WatchClient};
use ademan::setup::Setup;

/// A run that holds the key H, and the path of its control socket.
fn held_run() -> (Run, String) {
    let run = Run::with_held_key(&["--control", "c.sock"]);
    let socket = run.folder.path().join("c.sock");
    let socket = socket.to_str().expect("a plain path").to_owned();
    (run, socket)
}

fn watch(socket: &str, columns: u16, rows: u16) -> Screen {
    let mut command = ademan(["watch", "--socket", socket]);
    set_terminal(&mut command);
    Screen::start(&command, columns, rows)
}

#[test]
fn a_watcher_sees_the_run_and_comes_and_goes_without_effect_on_it() {
    let (run, socket) = held_run();
    let mut first = watch(&socket, 80, 24);
    first.wait_for("pressed key H", is_lit);
    let text = first.wait_for_text("down: H");
    println!("{text}");
    assert!(text.contains("armed: nothing is typed"), "{text}");
    assert!(text.contains("tcp:127.0.0.1"), "{text}");
    let small = watch(&socket, 40, 12);
    println!("{}", small.wait_for_text("down: H"));
    run.lift();
    first.wait_for_text("no key is down");
    first.type_keys("\x03");
    assert_eq!(first.wait().code(), Some(0));
    first.assert_restored();
    assert_eq!(run.next_event(), "up H");
    run.press();
    assert_eq!(run.next_event(), "down H");
    small.wait_for_text("down: H");
    small.wait_for_text("typed \"hh\"");

    run.save(&crate::support::run::shipped("dvorak-flat"));
    small.wait_for_text("Dvorak");
    let mut small = small;
    signal("TERM", run.program.0.id());
    assert_eq!(small.wait().code(), Some(0));
    small.assert_restored();
    let last = small.text();
    assert!(last.contains("the session has ended"), "{last}");
}

#[test]
fn ctrl_z_gives_the_terminal_back_until_the_watcher_continues() {
    let (_run, socket) = held_run();
    stop_and_continue(watch(&socket, 80, 24), ["down: H"; 2]);
}

/// Waits until a process has a handler for SIGTERM: on a busy machine, the program may have started just now.
fn wait_until_it_handles_signals(process: u32) {
    let handles = || {
        let status = fs::read_to_string(format!("/proc/{process}/status")).expect("it runs");
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        let mask = u64::from_str_radix(caught.expect("a mask").trim(), 16).expect("a number");
        mask & 1 << (15 - 1) != 0
    };
    assert!(wait_for(handles), "it handles no signal");
}

#[test]
fn watchers_that_show_nothing_do_not_slow_the_run() {
    let (run, socket) = held_run();
    let mut command = ademan(["watch", "--socket", &socket]);
    set_terminal(&mut command);
    let stopped = watch(&socket, 80, 24);
    stopped.wait_for_text("down: H");
    signal("STOP", stopped.program.0.id());
    let mut unread = Screen::start_unread(&command, 80, 24);
    for _ in 0..4 {
        run.lift();
        assert_eq!(run.next_event(), "up H");
        run.press();
        assert_eq!(run.next_event(), "down H");
    }
    wait_until_it_handles_signals(unread.program.0.id());
    signal("TERM", unread.program.0.id());
    assert_eq!(unread.wait().code(), Some(0));
    signal("CONT", stopped.program.0.id());
    run.lift();
    stopped.wait_for_text("no key is down");
}

#[test]
fn watching_no_run_or_without_a_terminal_is_explained() {
    let folder = tempfile::tempdir().unwrap();
    let socket = folder.path().join("none.sock");
    let socket = socket.to_str().unwrap();
    let mut screen = watch(socket, 200, 24);
    assert_eq!(screen.wait().code(), Some(2));
    let text = screen.text();
    assert!(
        text.contains("no session listens there; start `ademan run`"),
        "{text}"
    );
    screen.assert_restored();
    let ended = crate::run(["watch", "--socket", socket]).exited(2);
    ended.reported("standard output is not a terminal");
}

#[test]
fn a_watching_client_receives_the_layout_and_then_views() {
    let (run, socket) = held_run();
    let path = run.folder.path().join("c.sock");
    let mut client = Client::connect(&path).expect("the session listens");
    let response = client
        .request(r#"{"command":"watch"}"#)
        .expect("a response");
    assert_eq!(response, r#"{"ok":true}"#);
    let mut next = || -> Value {
        let line = client.next_notification().expect("a line").expect("a run");
        serde_json::from_str(&line).expect("JSON")
    };
    let layout = next();
    assert_eq!(
        (&layout["event"], &layout["file"]),
        (&"layout".into(), &"my.ron".into())
    );
    let view = loop {
        let view = next();
        if view["keys"][0] == "H" {
            break view;
        }
    };
    assert_eq!(view["event"], "view");
    assert_eq!(view["state"], "running");
    assert_eq!(view["pressed"].as_array().map(Vec::len), Some(1));
    assert_eq!(view["fingertips"].as_array().map(Vec::len), Some(5));
    assert_eq!(view["typed"], "h");
    let mut other = Client::connect(&path).expect("the session listens");
    let state = other.request(r#"{"command":"state"}"#).expect("a response");
    assert!(
        !state.contains("typed"),
        "only a watcher receives it: {state}"
    );
    let mut watcher = WatchClient::connect(path.as_ref()).expect("the session listens");
    let watched = watcher.next_view().expect("a view").expect("a run");
    assert_eq!(watched.layout.name, "QWERTY, 19 mm");
    drop(run);
    while watcher.next_view().expect("a view or the end").is_some() {}
    assert!(WatchClient::connect(socket.as_ref()).is_err());
}

#[test]
fn the_position_of_a_pointer_is_in_the_state_and_in_notifications() {
    let folder = tempfile::tempdir().unwrap();
    let socket = folder.path().join("c.sock");
    // The pointer still moves when a slow machine has subscribed.
    let moves = "point 200 0 -300; wait 1000; point 220 20 -280; wait 1000; ".repeat(30);
    let script = format!("{moves}wait 60000");
    let mut command = ademan(["run", "--layout", "direct", "--armed", "--output", "none"]);
    command
        .args(["--source", &format!("script:{script}"), "--control"])
        .arg(&socket)
        .stderr(std::process::Stdio::null());
    let _program = Process::start(&mut command).expect("it starts");
    let mut client = None;
    let mut state = || -> Option<Value> {
        if client.is_none() {
            client = Client::connect(&socket).ok();
        }
        let reply = client.as_mut()?.request(r#"{"command":"state"}"#).ok()?;
        serde_json::from_str(&reply).ok()
    };
    let start = Instant::now();
    let position = loop {
        assert!(start.elapsed() < TIMEOUT, "no position");
        if let Some(position) = state().and_then(|state| {
            let position = state["pointer"]["position"].as_array()?.clone();
            (position.len() == 3).then_some(position)
        }) {
            break position;
        }
        thread::sleep(Duration::from_millis(5));
    };
    let in_range = |value: &Value| (0.0..=1.0).contains(&value.as_f64().unwrap());
    assert!(position.iter().all(in_range), "{position:?}");
    let mut subscriber = Client::connect(&socket).expect("the session listens");
    subscriber
        .request(r#"{"command":"subscribe"}"#)
        .expect("a response");
    loop {
        let line = subscriber
            .next_notification()
            .expect("a line")
            .expect("a run");
        let line: Value = serde_json::from_str(&line).expect("JSON");
        if line["event"] == "pointer" {
            assert_eq!(line["position"].as_array().map(Vec::len), Some(3), "{line}");
            return;
        }
    }
}

#[test]
fn a_watcher_draws_the_layout_for_the_hand_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let [setup, socket] = ["small.ron", "c.sock"].map(|name| folder.path().join(name));
    let text = "Setup(source: \"script:wait 60000\", output: \"none\", \
                arm: Measured(hand_length_mm: 150, forearm_length_mm: 200))";
    fs::write(&setup, text).unwrap();
    let loaded = Setup::load(setup.to_str().unwrap()).unwrap();
    let expected = loaded.load_files().unwrap().layout;
    assert_ne!(expected.fit, Fit::default());
    let mut command = ademan(["run"]);
    command
        .arg("--control")
        .arg(&socket)
        .arg(&setup)
        .stderr(std::process::Stdio::null());
    let _program = Process::start(&mut command).expect("it starts");
    let start = Instant::now();
    let mut watcher = loop {
        if let Ok(watcher) = WatchClient::connect(&socket) {
            break watcher;
        }
        assert!(start.elapsed() < TIMEOUT, "no session");
        thread::sleep(Duration::from_millis(5));
    };
    let view = watcher.next_view().expect("a view").expect("a run");
    assert_eq!(view.layout.fit, expected.fit);
}

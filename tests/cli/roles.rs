//! The real binary with a glove behind a converter box: what its role lets out.
#![cfg(target_os = "linux")]

use std::thread;

use crate::support::binary::ademan;
use crate::support::run::{ARMED, MOVE_TIME, Run};
use ademan::session::control_socket::Client;
use serde_json::Value;

/// A setup that says nothing of roles.
const SILENT: &str = "stall_timeout_ms: 10000";

fn ask(run: &Run, request: &str) -> Value {
    let socket = run.folder.path().join("c.sock");
    let mut caller = Client::connect(&socket).expect("the run listens");
    let answer = caller.request(request).expect("there is an answer");
    serde_json::from_str(&answer).expect("it is JSON")
}

/// The next line of this kind.
fn told(run: &Run, is_meant: impl Fn(&str) -> bool) -> String {
    loop {
        let line = run.next_message();
        if is_meant(&line) {
            return line;
        }
    }
}

#[test]
fn key_poses_of_a_source_on_the_network_press_no_keys_and_the_user_is_told_how_to_allow_them() {
    let run = Run::with_setup(SILENT, &["--control", "c.sock"]);
    let hint = run.next_message();
    assert!(hint.starts_with("tcp:127.0.0.1:"), "{hint}");
    let (_, hint) = hint.split_once(" is ").expect("what it is");
    assert_eq!(
        hint,
        "on the network and only a pointer: it presses no keys of the layout; `role: Both` next to this source in \
         the setup or `--role both` lets it type"
    );
    run.wait_for_message(ARMED);
    for _ in 0..3 {
        run.press();
        thread::sleep(MOVE_TIME);
        run.lift();
        thread::sleep(MOVE_TIME);
    }
    let state = ask(&run, r#"{"command":"state"}"#);
    assert_eq!(state["state"], "running");
    let suppressed = &state["stats"]["suppressed"];
    assert_eq!(suppressed["keys_by_role"], 3, "{suppressed}");
    assert_eq!(suppressed["rate_limited"], 0, "{suppressed}");
    let line = told(&run, |line| line.contains("suppressed"));
    assert_eq!(
        line,
        "1 key suppressed, as the source is only a pointer; `role: Both` next to it in the setup lets it type"
    );
    let told_by_ctl = ademan(["ctl", "--socket", "c.sock", "state"])
        .current_dir(run.folder.path())
        .output()
        .expect("it starts");
    let told_by_ctl = String::from_utf8(told_by_ctl.stdout).expect("a text");
    assert!(
        told_by_ctl.contains("; 3 suppressed (keys by role)\n"),
        "{told_by_ctl}"
    );
    assert_eq!(ask(&run, r#"{"command":"stop"}"#)["ok"], true);
    let account = told(&run, |line| line.contains(" readings: "));
    assert!(account.ends_with("; suppressed: 3 by `role`"), "{account}");
    assert!(run.events.is_empty(), "no key went out");
}

#[test]
fn with_the_role_both_they_do_and_nothing_is_told_of_it() {
    for (fields, arguments) in [
        ("role: Both, stall_timeout_ms: 10000", &[][..]),
        (SILENT, &["--role", "both"]),
        (
            "role: Pointer, stall_timeout_ms: 10000",
            &["--role", "keys"],
        ),
    ] {
        let run = Run::with_setup(fields, arguments);
        let told = run.next_message();
        assert!(told.starts_with("listening to tcp:"), "{told}");
        run.wait_for_message(ARMED);
        run.press();
        assert_eq!(run.next_event(), "down H");
        run.lift();
        assert_eq!(run.next_event(), "up H");
    }
}

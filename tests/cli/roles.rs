//! The role of a source on the network: a glove behind a serial-to-TCP converter.
#![cfg(target_os = "linux")]

use std::io::Write;
use std::net::TcpListener;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;

use crate::support::binary::ademan;
use crate::support::free_address::free_address;
use crate::support::press::postures;
use crate::support::process::Process;
use crate::support::run::{ARMED, MOVE_TIME, Run, TIMEOUT, line_receiver, start_with_lines};
use crate::support::wearer::shipped_setup;
use crate::support::x11;
use crate::{run, run_in};
use ademan::capture::Hc11Format;
use ademan::capture::hc11::{Framing, encode};
use ademan::session::control_socket::Client;
use serde_json::Value;

/// A setup without a role.
const NO_ROLE: &str = "stall_timeout_ms: 10000";

fn request(run: &Run, line: &str) -> Value {
    let socket = run.folder.path().join("c.sock");
    let mut client = Client::connect(&socket).expect("the session listens");
    let reply = client.request(line).expect("a reply");
    serde_json::from_str(&reply).expect("the reply is JSON")
}

/// Waits until the state of the session is as `is_so` says.
fn wait_for_state(run: &Run, is_so: impl Fn(&Value) -> bool) {
    let mut state = Value::Null;
    let is_over = x11::wait_for(|| {
        state = request(run, r#"{"command":"state"}"#);
        is_so(&state)
    });
    assert!(is_over, "{state}");
}

/// Returns `true` if this many presses were suppressed in a state.
fn has_suppressed(state: &Value, presses: u64) -> bool {
    state["stats"]["suppressed"]["keys_by_role"] == presses
}

/// The next message that contains `text`.
fn message_with(run: &Run, text: &str) -> String {
    loop {
        let line = run.next_message();
        if line.contains(text) {
            return line;
        }
    }
}

#[test]
fn a_source_on_the_network_presses_no_keys_and_the_message_explains_how_to_allow_them() {
    let run = Run::with_setup(NO_ROLE, &["--control", "c.sock"]);
    let hint = run.next_message();
    assert!(hint.starts_with("tcp:127.0.0.1:"), "{hint}");
    let (_, hint) = hint.split_once(" is ").expect("the role of the source");
    assert_eq!(
        hint,
        "on the network and only a pointer: it presses no keys of the layout; `role: Both` next to this source in \
         the setup or `--role both` lets it type, and `ademan ctl allow-keys` does until the session ends or \
         another sender follows"
    );
    run.wait_for_message(ARMED);
    for presses in 1..=3 {
        run.press();
        wait_for_state(&run, |state| has_suppressed(state, presses));
        run.lift();
        thread::sleep(MOVE_TIME);
    }
    let state = request(&run, r#"{"command":"state"}"#);
    assert_eq!(state["state"], "running");
    let suppressed = &state["stats"]["suppressed"];
    assert_eq!(suppressed["keys_by_role"], 3, "{suppressed}");
    assert_eq!(suppressed["rate_limited"], 0, "{suppressed}");
    assert_eq!(
        message_with(&run, "suppressed"),
        "1 key suppressed, as the source is only a pointer; `ademan ctl allow-keys`, `--role both` or `role: Both` \
         next to it in the setup lets it type"
    );
    let ctl = ["ctl", "--socket", "c.sock", "state"];
    let printed = run_in(run.folder.path(), ctl).done();
    printed.printed("; 3 suppressed (keys by role)\n");
    assert_eq!(request(&run, r#"{"command":"stop"}"#)["ok"], true);
    let stats = message_with(&run, " readings: ");
    assert!(stats.ends_with("; suppressed: 3 by `role`"), "{stats}");
    // Up to the end of the stream.
    assert_eq!(run.events.iter().next(), None, "no key was pressed");
}

#[test]
fn a_source_on_the_network_types_between_allow_keys_and_forbid_keys() {
    let arguments = ["--control", "c.sock", "--record", "hand.mcap"];
    let run = Run::with_setup(NO_ROLE, &arguments);
    run.wait_for_message(ARMED);
    let reply = |command: &str| request(&run, &format!(r#"{{"command":"{command}"}}"#));
    assert_eq!(reply("allow-keys")["ok"], true);
    // The hand has to be clear of every key first.
    thread::sleep(MOVE_TIME);
    wait_for_state(&run, |state| state["state"] == "running");
    run.press();
    assert_eq!(run.next_event(), "down H");
    // The key is down: it comes up at once.
    assert_eq!(reply("forbid-keys")["ok"], true);
    assert_eq!(run.next_event(), "up H");
    run.lift();
    thread::sleep(2 * MOVE_TIME);
    wait_for_state(&run, |state| state["state"] == "running");
    run.press();
    wait_for_state(&run, |state| has_suppressed(state, 1));
    run.lift();
    thread::sleep(MOVE_TIME);
    let state = request(&run, r#"{"command":"state"}"#);
    assert_eq!(state["stats"]["suppressed"]["keys_by_role"], 1, "{state}");
    assert!(run.events.is_empty(), "no key was pressed");

    assert_eq!(reply("stop")["ok"], true);
    message_with(&run, "suppressed: 1 by `role`");
    std::fs::write(run.folder.path().join("own.ron"), "Setup(role: Pointer)").expect("a file");
    let replay = |more: &[&str]| {
        let replay = ["replay", "hand.mcap"].iter().chain(more);
        run_in(run.folder.path(), replay).out
    };
    let words = |transcript: &str, word: &str| transcript.matches(word).count();
    let repeated = replay(&[]);
    let counts = ["down H", "up   H"].map(|word| words(&repeated, word));
    assert_eq!(
        counts,
        [1, 1],
        "it has the permissions of the run: {repeated}"
    );
    let own = replay(&["--setup", "own.ron"]);
    assert_eq!(words(&own, "down H"), 0, "it has others: {own}");
}

#[test]
fn a_source_on_the_network_types_with_a_role_that_allows_it() {
    for (fields, arguments) in [
        ("role: Both, stall_timeout_ms: 10000", &[][..]),
        (NO_ROLE, &["--role", "both"]),
        (
            "role: Pointer, stall_timeout_ms: 10000",
            &["--role", "keys"],
        ),
    ] {
        let run = Run::with_setup(fields, arguments);
        let message = run.next_message();
        assert!(message.starts_with("listening to tcp:"), "{message}");
        run.wait_for_message(ARMED);
        run.press();
        assert_eq!(run.next_event(), "down H");
        run.lift();
        assert_eq!(run.next_event(), "up H");
    }
}

#[test]
fn a_source_of_another_machine_that_types_without_a_credential_is_reported() {
    // Not the loopback address, although Linux connects to this machine.
    let source = "tcp:0.0.0.0:1";
    let mut command = ademan(["run", "--source", source, "--role", "both"]);
    command.args(["--control", "off", "--output", "transcript"]);
    let (_program, _, messages) = start_with_lines(&mut command);
    let next = || messages.recv_timeout(TIMEOUT).expect("a message");
    let words = "presses keys and has neither password nor encryption: anyone who answers there, or can change what the network carries, can type here; use `tcp+tls:`, or a network of your own";
    let message = std::iter::repeat_with(next).find(|line| line.ends_with(words));
    assert!(message.is_some_and(|line| line.starts_with(source)));
}

#[test]
fn a_session_that_types_nothing_warns_of_no_machine_that_types() {
    let folder = tempfile::tempdir().expect("a folder");
    let recording = folder.path().join("hand.mcap");
    let shared = format!("json:{}", free_address());
    let record = ["record", recording.to_str().expect("a path")];
    // Not the loopback address, although Linux connects to this machine.
    let source = ["--source", "tcp:0.0.0.0:1", "--role", "both"];
    for session in [record, ["share", &shared]] {
        let ended = run([&session[..], &source].concat());
        ended.reported("cannot open tcp:0.0.0.0:1");
        assert!(!ended.err.contains("can type"), "{}", ended.err);
    }
}

/// Plays the script `tap pause` on the layout `switches` again and again, and counts how often it has ended.
fn serve_pause_key(listener: &TcpListener, played: &AtomicU32) {
    let setup = shipped_setup("switches");
    let (mut line, _) = listener.accept().expect("the program connects");
    loop {
        let hand = setup.scripted("tap pause", &Hc11Format::default(), 0.0, 0);
        for posture in postures(hand.expect("the hand reaches the key")) {
            if line
                .write_all(&encode(Framing::Double06, &posture))
                .is_err()
            {
                return;
            }
            thread::sleep(Hc11Format::default().packet_period());
        }
        played.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn a_source_on_the_network_ends_its_own_pause_but_no_pause_by_a_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let setup = "Setup(layout: \"switches\", stall_timeout_ms: 10000)";
    std::fs::write(folder.path().join("setup.ron"), setup).expect("a file");
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let source = format!("tcp:{}", listener.local_addr().expect("an address"));
    let played = Arc::new(AtomicU32::new(0));
    let served = Arc::clone(&played);
    thread::spawn(move || serve_pause_key(&listener, &served));
    let mut command = ademan([
        "run",
        "setup.ron",
        "--source",
        &source,
        "--control",
        "c.sock",
    ]);
    command
        .current_dir(folder.path())
        .env_remove("XDG_RUNTIME_DIR")
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let mut program = Process::start(&mut command).expect("it starts");
    let messages = line_receiver(program.0.stderr.take().expect("it is piped"));
    let wait_for = |part: &str| {
        let is_wanted = |line: &String| line.contains(part);
        let next = || messages.recv_timeout(TIMEOUT).expect("a message");
        std::iter::repeat_with(next).find(is_wanted)
    };
    let ctl = |word: &str| {
        let ctl = ["ctl", "--socket", "c.sock", word];
        run_in(folder.path(), ctl).out
    };
    let by_layout = "paused by a key or gesture of the layout";
    wait_for(by_layout);
    wait_for(ARMED);
    ctl("pause");
    let before = played.load(Ordering::Relaxed);
    let has_moved = || played.load(Ordering::Relaxed) >= before + 4;
    assert!(x11::wait_for(has_moved), "the hand stands still");
    let state = ctl("state");
    assert!(
        state.starts_with("state      paused by a command\n"),
        "{state}"
    );
    ctl("resume");
    wait_for(by_layout);
    wait_for(ARMED);
}

#[test]
fn a_recipe_of_the_guides_that_listens_names_one_address_and_the_role_of_a_pointer() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let guides = std::fs::read_dir(root.join("docs")).expect("the guides");
    let guides = guides.flatten().map(|entry| entry.path());
    let readmes = ["README.md", "layouts/README.md"].map(|path| root.join(path));
    let mut recipes = 0;
    for path in guides.chain(readmes) {
        if path.extension().is_none_or(|extension| extension != "md") {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("a guide");
        let listens = |line: &&str| {
            ["-listen:", "-LISTEN:", "nc -l"]
                .iter()
                .any(|it| line.contains(it))
        };
        for line in text.lines().filter(listens) {
            recipes += 1;
            assert!(line.contains("bind="), "{path:?}: {line}");
            assert!(line.contains("--role pointer"), "{path:?}: {line}");
        }
    }
    assert!(recipes > 0, "the guide to LucidGloves has one");
}

//! The real binary, asked for things on its control socket.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::support::process::Process;
use crate::support::run::{MOVE_TIME, Run, TIMEOUT, line_receiver, shipped};
use ademan::session::control_socket::Client;
use serde_json::Value;

/// A run with the key H held and a socket of its own.
fn run() -> Run {
    Run::with_held_key(&["--control", "c.sock"])
}

fn socket(run: &Run) -> PathBuf {
    run.folder.path().join("c.sock")
}

fn caller(run: &Run) -> Client {
    Client::connect(&socket(run)).expect("the run listens")
}

fn ask(caller: &mut Client, request: &str) -> Value {
    let answer = caller.request(request).expect("there is an answer");
    serde_json::from_str(&answer).expect("it is JSON")
}

/// Somebody who says what no caller would.
fn stranger(run: &Run) -> (UnixStream, BufReader<UnixStream>) {
    let stream = UnixStream::connect(socket(run)).expect("the run listens");
    stream.set_read_timeout(Some(TIMEOUT)).expect("a limit");
    let reader = BufReader::new(stream.try_clone().expect("a second end"));
    (stream, reader)
}

fn answer(reader: &mut BufReader<UnixStream>) -> Value {
    let mut line = String::new();
    reader.read_line(&mut line).expect("there is an answer");
    serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {line}"))
}

fn ademan(arguments: &[&str]) -> Command {
    let mut command = crate::support::binary::ademan(arguments);
    command
        .env_remove("XDG_RUNTIME_DIR")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// `ademan ctl` for a run: exit code, output, errors.
fn ctl(run: &Run, arguments: &[&str]) -> (i32, String, String) {
    let path = socket(run);
    let path = path.to_str().expect("a plain path");
    let output = ademan(&[&["ctl", "--socket", path], arguments].concat())
        .output()
        .expect("it starts");
    let text = |bytes| String::from_utf8(bytes).expect("it writes UTF-8");
    let code = output.status.code().expect("it ends by itself");
    (code, text(output.stdout), text(output.stderr))
}

fn wait_until(mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < TIMEOUT, "it does not come about");
        thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_pause_lets_go_and_nothing_is_typed_until_it_is_ended_and_the_hand_was_off() {
    let run = run();
    let mut caller = caller(&run);
    let asked = Instant::now();
    assert_eq!(ask(&mut caller, r#"{"command":"pause"}"#)["ok"], true);
    assert_eq!(run.next_event(), "up H");
    println!("from the request to the release: {:?}", asked.elapsed());
    let state = ask(&mut caller, r#"{"command":"state"}"#);
    assert_eq!(
        (&state["state"], &state["paused"]),
        (&"paused".into(), &true.into())
    );
    run.lift();
    thread::sleep(MOVE_TIME);
    run.press();
    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "it is paused");

    assert_eq!(ask(&mut caller, r#"{"command":"resume"}"#)["ok"], true);
    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "the finger has not left the key");
    run.lift();
    wait_until(|| ask(&mut caller, r#"{"command":"state"}"#)["state"] == "running");
    run.press();
    assert_eq!(run.next_event(), "down H");
}

#[test]
fn a_state_names_the_layout_and_accounts_for_every_reading() {
    let run = run();
    let state = ask(&mut caller(&run), r#"{"command":"state"}"#);
    assert_eq!(state["state"], "running");
    assert_eq!(state["paused"], false);
    assert_eq!(state["layout"], "my.ron");
    assert_eq!(state["profile"], "main");
    let stats = &state["stats"];
    let count = |value: &Value| value.as_u64().expect("it is a count");
    let rejected = stats["rejected"].as_object().expect("by reason");
    let rejected: u64 = rejected.values().map(count).sum();
    let taken = count(&stats["accepted"]) + rejected + count(&stats["dropped"]);
    assert_eq!(count(&stats["received"]), taken);
    assert_eq!(count(&state["steps"]), count(&stats["accepted"]) + rejected);
    assert!(taken > 10, "{taken}");

    let (code, out, _) = ctl(&run, &["state"]);
    assert_eq!(code, 0);
    assert!(
        out.starts_with("state      running\nprofile    main\nlayout     my.ron\n"),
        "{out}"
    );
}

#[test]
fn a_reload_says_what_came_of_it_also_when_the_file_was_not_saved() {
    let run = run();
    let (code, out, _) = ctl(&run, &["reload"]);
    assert_eq!((code, out.as_str()), (0, "my.ron: active from now on\n"));
    assert_eq!(run.next_event(), "up H");

    run.save("Layout(\n    nmae: \"My board\",\n)\n");
    let (code, out, err) = ctl(&run, &["reload"]);
    assert_eq!((code, out.as_str()), (1, ""));
    let expected = "error: my.ron:2:5: unknown field `nmae`, did you mean `name`?\n 2 |     nmae: \"My board\",\n   |     ^^^^\nthe active layout stays\n";
    assert_eq!(err, expected);
    run.save(&shipped("dvorak-flat"));
    let answer = ask(&mut caller(&run), r#"{"command":"reload"}"#);
    assert_eq!(answer["text"], "my.ron: active from now on");
    run.lift();
    thread::sleep(MOVE_TIME);
    run.press();
    assert_eq!(run.next_event(), "down D");
}

#[test]
fn a_reload_that_a_run_cannot_use_is_refused_with_the_reason() {
    let run = Run::with_held_key(&["--control", "c.sock", "--record", "hand.mcap"]);
    let answer = ask(&mut caller(&run), r#"{"command":"reload"}"#);
    assert_eq!(answer["ok"], false);
    assert_eq!(
        answer["error"],
        "my.ron: not used, as a recording holds one version of a layout; start again to use it"
    );
    assert!(run.events.is_empty(), "the key stays held");
}

#[test]
fn what_is_not_a_request_is_refused_and_the_conversation_goes_on() {
    let run = run();
    let (mut stream, mut reader) = stranger(&run);
    let mut refused = |line: &[u8]| {
        stream.write_all(line).expect("the run reads on");
        let answer = answer(&mut reader);
        assert_eq!(answer["ok"], false, "{answer}");
        answer["error"].as_str().expect("it says why").to_owned()
    };
    let mut long = vec![b'x'; 64 * 1024];
    long.push(b'\n');
    assert_eq!(refused(&long), "a line has at most 4096 bytes");
    assert_eq!(refused(b"\xff\xfe\n"), "the line is not UTF-8");
    refused(b"\n");
    refused(b"GET / HTTP/1.1\r\n");
    refused(format!("{}\n", "[".repeat(4_000)).as_bytes());
    refused(format!("{}\n", "{\"deg\":".repeat(500)).as_bytes());
    assert_eq!(
        refused(b"{\"command\":\"paus\"}\n"),
        "unknown command `paus`, did you mean `pause`?"
    );
    let mut number = fastrand::Rng::with_seed(1);
    for _ in 0..200 {
        let mut line: Vec<u8> = (0..number.usize(0..300)).map(|_| number.u8(..)).collect();
        line.retain(|&byte| byte != b'\n');
        line.push(b'\n');
        refused(&line);
    }
    stream
        .write_all(b"{\"command\":")
        .expect("the run reads on");
    stream.write_all(b"\"state\"}\n").expect("the run reads on");
    assert_eq!(answer(&mut reader)["state"], "running");
    assert!(run.events.is_empty(), "the key stays held");
}

#[test]
fn boards_that_are_moved_let_go_and_are_saved_where_they_are() {
    let run = run();
    let (path, linked) = (run.path(), run.folder.path().join("linked.ron"));
    fs::rename(&path, &linked).expect("it is ours");
    std::os::unix::fs::symlink(&linked, &path).expect("a link");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("it is ours");
    let (code, _, err) = ctl(&run, &["save"]);
    let expected = "error: my.ron: not saved, as no board was moved or scaled\n";
    assert_eq!((code, err.as_str()), (1, expected));
    assert!(run.events.is_empty(), "the key stays held");

    // One key to the left: the rows run 35 degrees to the right of straight to the right.
    let by = 35.0_f64.to_radians();
    let (x, z) = (-19.0 * by.cos(), -19.0 * by.sin());
    let (code, out, err) = ctl(&run, &["nudge", &x.to_string(), "0", &z.to_string()]);
    assert_eq!((code, out.as_str(), err.as_str()), (0, "done\n", ""));
    assert_eq!(run.next_event(), "up H");
    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "the finger has not left the key");
    run.lift();
    thread::sleep(MOVE_TIME);
    run.press();
    assert_eq!(run.next_event(), "down J");

    let (code, out, err) = ctl(&run, &["save"]);
    assert_eq!(
        (code, out.as_str(), err.as_str()),
        (0, "my.ron: saved\n", "")
    );
    let saved = fs::read_to_string(&path).expect("it is there");
    let before = shipped("qwerty-flat");
    assert_eq!(
        saved,
        before.replace("anchor: elbow", "anchor: elbow, right_mm: -19")
    );
    let mode = fs::metadata(&path).expect("it is there").mode();
    assert_eq!(mode & 0o777, 0o640);
    assert!(
        fs::symlink_metadata(&path)
            .expect("it is there")
            .is_symlink()
    );
    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "a save lets go of nothing");

    let (code, _, err) = ctl(&run, &["scale", "3"]);
    let expected = "error: `factor` is 0.5 to 2, not 3\n";
    assert_eq!((code, err.as_str()), (1, expected));
    assert_eq!(ctl(&run, &["nudge", "0", "-1", "0"]).0, 0);
    assert_eq!(run.next_event(), "up J");
    let (code, out, _) = ctl(&run, &["scale", "1.5"]);
    assert_eq!((code, out.as_str()), (0, "scaled by 1.5\n"));
    let (code, _, _) = ctl(&run, &["save"]);
    assert_eq!(code, 0);
    let saved = fs::read_to_string(&path).expect("it is there");
    let fields = "anchor: elbow, scale: 1.5, right_mm: -19";
    let moved = before.replace("anchor: elbow", fields);
    assert_eq!(saved, moved.replace("height_mm: -45", "height_mm: -46"));

    run.save(&format!("// mine\n{saved}"));
    run.wait_for_message("my.ron: active from now on");
    let (code, _, _) = ctl(&run, &["tilt", "-5"]);
    assert_eq!(code, 0);
    fs::write(&path, "no layout").expect("it can be written");
    let (code, _, err) = ctl(&run, &["save"]);
    let expected = "error: my.ron: not saved, as the file differs from the active layout; `reload` activates the file\n";
    assert_eq!((code, err.as_str()), (1, expected));
    assert_eq!(fs::read_to_string(&path).expect("it is there"), "no layout");
    let left = fs::read_dir(run.folder.path()).expect("a folder").flatten();
    let left: Vec<_> = left.map(|entry| entry.file_name()).collect();
    assert!(
        left.iter()
            .all(|name| !name.to_string_lossy().starts_with('.')),
        "{left:?}"
    );
}

#[test]
fn what_cannot_be_moved_says_why_and_lets_go_of_nothing() {
    let run = run();
    let (code, _, err) = ctl(&run, &["tilt", "-80"]);
    assert_eq!(code, 0, "{err}");
    assert_eq!(run.next_event(), "up H");
    let (code, _, err) = ctl(&run, &["tilt", "-80"]);
    let expected =
        "error: the tilt of board 1 would be outside -90 to 90 degrees; no board was moved\n";
    assert_eq!((code, err.as_str()), (1, expected));
    let (code, _, err) = ctl(&run, &["profile", "mian"]);
    let expected = "error: unknown profile `mian`, did you mean `main`?\n";
    assert_eq!((code, err.as_str()), (1, expected));
}

#[test]
fn the_seventeenth_client_is_refused_and_a_place_that_is_free_again_is_given() {
    let run = run();
    let mut clients: Vec<Client> = (0..16).map(|_| caller(&run)).collect();
    for client in &mut clients {
        assert_eq!(ask(client, r#"{"command":"state"}"#)["ok"], true);
    }
    for _ in 16..20 {
        let answer = ask(&mut caller(&run), r#"{"command":"pause"}"#);
        assert_eq!(
            answer["error"],
            "all 16 connections are in use; try again later"
        );
    }
    assert!(run.events.is_empty(), "the key stays held");
    drop(clients.pop());
    wait_until(|| ask(&mut caller(&run), r#"{"command":"state"}"#)["ok"] == true);
}

#[test]
fn a_client_that_never_reads_is_cut_off_and_nobody_else_notices() {
    let run = run();
    let (mut deaf, mut said) = stranger(&run);
    deaf.write_all(b"{\"command\":\"subscribe\"}\n")
        .expect("the run reads");
    assert_eq!(answer(&mut said)["ok"], true);
    let mut listener = caller(&run);
    assert_eq!(ask(&mut listener, r#"{"command":"subscribe"}"#)["ok"], true);
    let (sender, news) = crossbeam_channel::unbounded();
    thread::spawn(move || {
        while let Ok(Some(line)) = listener.next_notification() {
            let _ = sender.send(line);
        }
    });
    let is_over = AtomicBool::new(false);
    thread::scope(|scope| {
        let typing = scope.spawn(|| {
            while !is_over.load(Ordering::Relaxed) {
                run.lift();
                thread::sleep(Duration::from_millis(14));
                run.press();
                thread::sleep(Duration::from_millis(14));
            }
        });
        let start = Instant::now();
        // What is written to a connection that was cut off does not arrive.
        wait_until(|| deaf.write_all(b" ").is_err());
        println!("cut off after {:?}", start.elapsed());
        is_over.store(true, Ordering::Relaxed);
        typing.join().expect("no panic");
    });
    let state = ask(&mut caller(&run), r#"{"command":"pause"}"#);
    assert_eq!(state["ok"], true);
    thread::sleep(MOVE_TIME);

    let typed: Vec<String> = run.events.try_iter().collect();
    assert!(typed.len() > 20, "{} events", typed.len());
    for line in typed {
        let told = news.recv_timeout(TIMEOUT).expect("it is told");
        let told: Value = serde_json::from_str(&told).expect("it is JSON");
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(told["event"], format!("key-{}", words[1]), "{told}");
        assert_eq!(told["key"], words[2]);
    }
    let told = news.recv_timeout(TIMEOUT).expect("it is told");
    let paused = r#"{"event":"state","state":"paused","paused":true}"#;
    assert_eq!(told, paused);
}

#[test]
fn a_client_that_asks_for_ever_and_never_reads_is_cut_off_too() {
    let run = run();
    let (mut deaf, _) = stranger(&run);
    deaf.set_write_timeout(Some(TIMEOUT)).expect("a limit");
    let start = Instant::now();
    while deaf.write_all(b"{\"command\":\"state\"}\n").is_ok() {
        assert!(start.elapsed() < TIMEOUT, "it is still listened to");
    }
    assert_eq!(
        ask(&mut caller(&run), r#"{"command":"state"}"#)["state"],
        "running"
    );
    run.lift();
    assert_eq!(run.next_event(), "up H");
}

#[test]
fn who_has_not_subscribed_hears_nothing_of_what_is_typed() {
    let run = run();
    let (mut stream, mut reader) = stranger(&run);
    run.lift();
    assert_eq!(run.next_event(), "up H");
    run.press();
    assert_eq!(run.next_event(), "down H");
    stream
        .write_all(b"{\"command\":\"state\"}\n")
        .expect("the run reads");
    stream
        .shutdown(std::net::Shutdown::Write)
        .expect("it is open");
    let mut all = String::new();
    reader
        .read_to_string(&mut all)
        .expect("the run lets go of it");
    assert_eq!(all.lines().count(), 1, "{all}");
    assert!(all.starts_with(r#"{"ok":true,"state":"running""#), "{all}");
}

#[test]
fn a_stop_lets_go_and_ends_the_run_in_good_order() {
    let mut run = run();
    let (code, out, _) = ctl(&run, &["stop"]);
    assert_eq!((code, out.as_str()), (0, "ended\n"));
    assert_eq!(run.next_event(), "up H");
    let ended = run.program.0.wait().expect("it ends");
    assert_eq!(ended.code(), Some(0));
    assert!(!socket(&run).exists());
    let (code, _, err) = ctl(&run, &["state"]);
    assert_eq!(code, 2);
    assert!(
        err.contains("no session listens there; start `ademan run`"),
        "{err}"
    );
}

#[test]
fn a_second_run_is_refused_and_the_socket_of_a_killed_one_is_taken_over() {
    let mut run = run();
    let path = socket(&run);
    let path = path.to_str().expect("a plain path");
    let second = ["run", "--source", "typist:hi", "--control", path];
    let ended = ademan(&second).output().expect("it starts");
    assert_eq!(ended.status.code(), Some(2));
    let err = String::from_utf8_lossy(&ended.stderr);
    assert!(err.contains("another session listens at"), "{err}");
    assert!(err.contains("`ademan ctl stop`"), "{err}");
    assert_eq!(ask(&mut caller(&run), r#"{"command":"state"}"#)["ok"], true);

    run.program.0.kill().expect("it runs");
    run.program.0.wait().expect("it ends");
    assert!(Path::new(path).exists(), "a killed run cannot take it away");
    let ended = ademan(&second).output().expect("it starts");
    assert_eq!(ended.status.code(), Some(0));
    assert!(!Path::new(path).exists());
}

#[test]
fn the_socket_is_its_owners_alone_from_the_first_instant_on() {
    let runtime = tempfile::tempdir().expect("a folder");
    let folder = runtime.path().join("ademan");
    let path = folder.join("control.sock");
    let wider = |path: &Path, than: u32| {
        fs::symlink_metadata(path).is_ok_and(|found| found.mode() & 0o777 & !than != 0)
    };
    let mut looks = 0;
    for _ in 0..20 {
        let _ = fs::remove_dir_all(&folder);
        let mut shell = Command::new("sh");
        shell
            .args([
                "-c",
                "umask 0; exec \"$0\" run --allow-root --source 'typist:a b c'",
            ])
            .arg(env!("CARGO_BIN_EXE_ademan"))
            .env("XDG_RUNTIME_DIR", runtime.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let _run = Process::start(&mut shell).expect("it starts");
        let mut is_there = false;
        let start = Instant::now();
        while !is_there {
            assert!(start.elapsed() < TIMEOUT, "there is no socket");
            is_there = path.exists();
            assert!(!wider(&folder, 0o700), "others may enter");
            assert!(!wider(&path, 0o600), "others may connect");
            looks += 1;
        }
    }
    println!("{looks} looks");
}

#[test]
fn a_folder_that_others_may_enter_is_refused() {
    let runtime = tempfile::tempdir().expect("a folder");
    let folder = runtime.path().join("ademan");
    fs::create_dir(&folder).expect("a folder");
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o755)).expect("it is ours");
    let mut run = ademan(&["run", "--source", "typist:hi"]);
    let ended = run
        .env("XDG_RUNTIME_DIR", runtime.path())
        .output()
        .expect("it starts");
    assert_eq!(ended.status.code(), Some(2));
    let err = String::from_utf8_lossy(&ended.stderr);
    assert!(err.contains("restrict it to yourself: chmod 700"), "{err}");
}

#[test]
fn another_user_is_not_listened_to() {
    const NOBODY: u32 = 65_534;
    let run = run();
    let everybody = |path: &Path, mode| {
        fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("it is ours");
    };
    everybody(run.folder.path(), 0o755);
    everybody(&socket(&run), 0o777);
    // A copy where everybody gets at it.
    let program = run.folder.path().join("ademan");
    fs::copy(env!("CARGO_BIN_EXE_ademan"), &program).expect("there is room");
    let mut other = Command::new(&program);
    other
        .args(["ctl", "pause", "--socket"])
        .arg(socket(&run))
        .uid(NOBODY);
    let ended = match other.output() {
        Err(error) if error.kind() == std::io::ErrorKind::PermissionDenied => {
            println!("SKIPPED: only root can be another user");
            return;
        }
        ended => ended.expect("it starts"),
    };
    assert_eq!(ended.status.code(), Some(1));
    let err = String::from_utf8_lossy(&ended.stderr);
    assert!(err.contains("no answer from the session"), "{err}");
    assert!(run.events.is_empty(), "the key stays held");
    assert_eq!(
        ask(&mut caller(&run), r#"{"command":"state"}"#)["paused"],
        false
    );
}

#[test]
fn a_run_that_waits_for_its_glove_can_be_stopped() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("c.sock");
    let mut command = ademan(&["run", "--wait", "--source", "serial:/dev/no-such-glove"]);
    let mut run = Process::start(command.arg("--control").arg(&path)).expect("it starts");
    let told = line_receiver(run.0.stderr.take().expect("it is piped"));
    assert!(
        told.recv_timeout(TIMEOUT)
            .expect("it waits")
            .starts_with("waiting: ")
    );
    let mut caller = Client::connect(&path).expect("it listens");
    let answer = ask(&mut caller, r#"{"command":"state"}"#);
    assert_eq!(answer["ok"], false, "nothing runs yet");
    assert_eq!(ask(&mut caller, r#"{"command":"stop"}"#)["ok"], true);
    assert_eq!(run.0.wait().expect("it ends").code(), Some(0));
}

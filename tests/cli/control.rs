//! Commands to the real binary through its control socket.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::support::glove::Glove;
use crate::support::process::{Process, signal};
use crate::support::run::{
    ARMED, MOVE_TIME, Run, TIMEOUT, line_receiver, postures, shipped, without_time,
};
use crate::support::x11::wait_for;
use crate::{Ended, run_in, run_to_end, text};
use ademan::files::OpenDocument;
use ademan::session::control_socket::Client;
use serde_json::Value;

/// Starts a run with a control socket, and presses the key H.
fn run() -> Run {
    Run::with_held_key(&["--control", "c.sock"])
}

fn socket(run: &Run) -> PathBuf {
    run.folder.path().join("c.sock")
}

fn client(run: &Run) -> Client {
    Client::connect(&socket(run)).expect("the session listens")
}

fn request(client: &mut Client, line: &str) -> Value {
    let response = client.request(line).expect("there is a response");
    serde_json::from_str(&response).expect("the response is JSON")
}

/// Connects without the client of the library.
fn raw_client(run: &Run) -> (UnixStream, BufReader<UnixStream>) {
    let stream = UnixStream::connect(socket(run)).expect("the session listens");
    stream
        .set_read_timeout(Some(TIMEOUT))
        .expect("the time-out is set");
    let reader = BufReader::new(stream.try_clone().expect("the stream is cloned"));
    (stream, reader)
}

fn read_response(reader: &mut BufReader<UnixStream>) -> Value {
    let mut line = String::new();
    reader.read_line(&mut line).expect("there is a response");
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

/// Runs `ademan ctl`.
pub fn ctl(run: &Run, arguments: &[&str]) -> Ended {
    ctl_at(&socket(run), arguments)
}

fn ctl_at(socket: &Path, arguments: &[&str]) -> Ended {
    crate::run(["ctl", "--socket", text(socket)].iter().chain(arguments))
}

#[track_caller]
fn wait_until(done: impl FnMut() -> bool) {
    assert!(wait_for(done), "timed out");
}

#[test]
fn a_pause_releases_keys_and_types_nothing_until_it_ends_and_the_hand_is_clear() {
    let run = run();
    let mut client = client(&run);
    let start = Instant::now();
    assert_eq!(request(&mut client, r#"{"command":"pause"}"#)["ok"], true);
    assert_eq!(run.next_event(), "up H");
    println!("from the request to the release: {:?}", start.elapsed());
    let state = request(&mut client, r#"{"command":"state"}"#);
    assert_eq!(
        (&state["state"], &state["paused"]),
        (&"paused".into(), &true.into())
    );
    run.lift();
    thread::sleep(MOVE_TIME);
    run.press();
    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "the session is paused");

    assert_eq!(request(&mut client, r#"{"command":"resume"}"#)["ok"], true);
    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "the finger has not left the key");
    run.lift();
    wait_until(|| request(&mut client, r#"{"command":"state"}"#)["state"] == "running");
    run.press();
    assert_eq!(run.next_event(), "down H");
}

#[test]
fn a_state_names_the_layout_and_counts_every_reading() {
    let run = run();
    let state = request(&mut client(&run), r#"{"command":"state"}"#);
    assert_eq!(state["state"], "running");
    assert_eq!(state["paused"], false);
    assert_eq!(state["layout"], "my.ron");
    assert_eq!(state["profile"], "main");
    let stats = &state["stats"];
    let count = |value: &Value| value.as_u64().expect("the value is a count");
    let rejected = stats["rejected"]
        .as_object()
        .expect("the counts are by reason");
    let rejected: u64 = rejected.values().map(count).sum();
    let taken = count(&stats["accepted"]) + rejected + count(&stats["dropped"]);
    assert_eq!(count(&stats["received"]), taken);
    assert_eq!(count(&state["steps"]), count(&stats["accepted"]) + rejected);
    assert!(taken > 10, "{taken}");

    let out = ctl(&run, &["state"]).done().out;
    assert!(
        out.starts_with("state      running\nprofile    main\nlayout     my.ron\n"),
        "{out}"
    );
}

#[test]
fn a_reload_replies_with_the_outcome_even_if_the_file_was_not_saved() {
    let run = run();
    let out = ctl(&run, &["reload"]).done().out;
    assert_eq!(out, "my.ron: active from now on\n");
    assert_eq!(run.next_event(), "up H");

    run.save("Layout(\n    nmae: \"My board\",\n)\n");
    let invalid = ctl(&run, &["reload"]).exited(1);
    assert_eq!(invalid.out, "");
    let expected = "error: my.ron:2:5: unknown field `nmae`, did you mean `name`?\n 2 |     nmae: \"My board\",\n   |     ^^^^\nthe active layout stays\n";
    assert_eq!(invalid.err, expected);
    run.save(&shipped("dvorak-flat"));
    let answer = request(&mut client(&run), r#"{"command":"reload"}"#);
    assert_eq!(answer["text"], "my.ron: active from now on");
    run.lift();
    thread::sleep(MOVE_TIME);
    run.press();
    assert_eq!(run.next_event(), "down D");
}

#[test]
fn a_reload_that_the_session_cannot_use_is_refused_with_the_reason() {
    let run = Run::with_held_key(&["--control", "c.sock", "--record", "hand.mcap"]);
    let answer = request(&mut client(&run), r#"{"command":"reload"}"#);
    assert_eq!(answer["ok"], false);
    assert_eq!(
        answer["error"],
        "my.ron: not used, as a recording holds one version of a layout; start again to use it"
    );
    assert!(run.events.is_empty(), "the key stays pressed");
}

#[test]
fn an_invalid_line_gets_an_error_and_the_connection_stays_open() {
    let run = run();
    let (mut stream, mut reader) = raw_client(&run);
    let mut error_for = |line: &[u8]| {
        stream.write_all(line).expect("the session keeps reading");
        let answer = read_response(&mut reader);
        assert_eq!(answer["ok"], false, "{answer}");
        answer["error"]
            .as_str()
            .expect("there is a reason")
            .to_owned()
    };
    let mut long = vec![b'x'; 64 * 1024];
    long.push(b'\n');
    assert_eq!(error_for(&long), "a line has at most 4096 bytes");
    assert_eq!(error_for(b"\xff\xfe\n"), "the line is not UTF-8");
    error_for(b"\n");
    error_for(b"GET / HTTP/1.1\r\n");
    error_for(format!("{}\n", "[".repeat(4_000)).as_bytes());
    error_for(format!("{}\n", "{\"deg\":".repeat(500)).as_bytes());
    assert_eq!(
        error_for(b"{\"command\":\"paus\"}\n"),
        "unknown command `paus`, did you mean `pause`?"
    );
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..200 {
        let mut line: Vec<u8> = (0..random.usize(0..300)).map(|_| random.u8(..)).collect();
        line.retain(|&byte| byte != b'\n');
        line.push(b'\n');
        error_for(&line);
    }
    stream
        .write_all(b"{\"command\":")
        .expect("the session keeps reading");
    stream
        .write_all(b"\"state\"}\n")
        .expect("the session keeps reading");
    assert_eq!(read_response(&mut reader)["state"], "running");
    assert!(run.events.is_empty(), "the key stays pressed");
}

#[test]
fn a_layout_without_boards_refuses_every_move() {
    let folder = tempfile::tempdir().expect("a folder");
    let [port, socket] = ["port", "c.sock"].map(|name| folder.path().join(name));
    let _glove = Glove::plug_in(&port, postures().0);
    let source = format!("serial:{}", port.display());
    let socket = socket.to_str().expect("the path is UTF-8");
    let layout = ["--layout", "arm-6dof", "--control", socket];
    let arguments = [&["run", "--source", &source], &layout[..]].concat();
    let mut command = ademan(&arguments);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let _run = Process::start(&mut command).expect("the program starts");
    wait_until(|| Client::connect(Path::new(socket)).is_ok());
    let no_boards = "the active layout has no boards; nothing was moved";
    let at_hand = "; a pointer or targets are placed at the hand with `pose: (anchor: start)`";
    for (request, remedy) in [
        (&["nudge", "0", "0", "-5"][..], ""),
        (&["tilt", "5"][..], ""),
        (&["scale", "1.5"][..], ""),
        (&["recenter"][..], at_hand),
    ] {
        let err = ctl_at(Path::new(socket), request).exited(1).err;
        let expected = format!("error: {no_boards}{remedy}\n");
        assert_eq!(err, expected, "{request:?}");
    }
}

#[test]
fn moved_boards_release_keys_and_are_saved_with_their_new_poses() {
    let run = run();
    let (path, linked) = (run.path(), run.folder.path().join("linked.ron"));
    fs::rename(&path, &linked).expect("the file belongs to this user");
    std::os::unix::fs::symlink(&linked, &path).expect("the link is created");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640))
        .expect("the file belongs to this user");
    let err = ctl(&run, &["save"]).exited(1).err;
    let expected = "error: my.ron: not saved, as no board was moved or scaled\n";
    assert_eq!(err, expected);
    assert!(run.events.is_empty(), "the key stays pressed");

    // One key to the left along the rows, which are rotated 35 degrees about the vertical axis.
    let by = 35.0_f64.to_radians();
    let (x, z) = (-19.0 * by.cos(), -19.0 * by.sin());
    let nudged = ctl(&run, &["nudge", &x.to_string(), "0", &z.to_string()]).done();
    assert_eq!((nudged.out.as_str(), nudged.err.as_str()), ("done\n", ""));
    assert_eq!(run.next_event(), "up H");
    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "the finger has not left the key");
    run.lift();
    thread::sleep(MOVE_TIME);
    run.press();
    assert_eq!(run.next_event(), "down J");

    let saving = ctl(&run, &["save"]).done();
    assert_eq!(
        (saving.out.as_str(), saving.err.as_str()),
        ("my.ron: saved\n", "")
    );
    let saved = fs::read_to_string(&path).expect("the file exists");
    let before = shipped("qwerty-flat");
    assert_eq!(
        saved,
        before.replace("anchor: elbow", "anchor: elbow, right_mm: -19")
    );
    let mode = fs::metadata(&path).expect("the file exists").mode();
    assert_eq!(mode & 0o777, 0o640);
    assert!(
        fs::symlink_metadata(&path)
            .expect("the file exists")
            .is_symlink()
    );
    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "saving releases nothing");

    let scale_err = ctl(&run, &["scale", "3"]).exited(1).err;
    assert_eq!(scale_err, "error: `factor` is 0.5 to 2, not 3\n");
    ctl(&run, &["nudge", "0", "-1", "0"]).done();
    assert_eq!(run.next_event(), "up J");
    let scaled = ctl(&run, &["scale", "1.5"]).done();
    assert_eq!(scaled.out, "scaled by 1.5\n");
    ctl(&run, &["save"]).done();
    let scaled_text = fs::read_to_string(&path).expect("the file exists");
    let fields = "anchor: elbow, scale: 1.5, right_mm: -19";
    let moved = before.replace("anchor: elbow", fields);
    assert_eq!(
        scaled_text,
        moved.replace("height_mm: -45", "height_mm: -46")
    );

    run.save(&format!("// mine\n{scaled_text}"));
    run.wait_for_message("my.ron: active from now on");
    ctl(&run, &["tilt", "-5"]).done();
    fs::write(&path, "no layout").expect("the file is written");
    let differing_err = ctl(&run, &["save"]).exited(1).err;
    let differing_expected = "error: my.ron: not saved, as the file differs from the active layout; `reload` activates the file\n";
    assert_eq!(differing_err, differing_expected);
    assert_eq!(
        fs::read_to_string(&path).expect("the file exists"),
        "no layout"
    );
    let left = fs::read_dir(run.folder.path())
        .expect("a temporary directory")
        .flatten();
    let left: Vec<_> = left.map(|entry| entry.file_name()).collect();
    assert!(
        left.iter()
            .all(|name| !name.to_string_lossy().starts_with('.')),
        "{left:?}"
    );
}

#[test]
fn a_refused_move_has_a_reason_and_releases_nothing() {
    let run = run();
    ctl(&run, &["tilt", "-80"]).done();
    assert_eq!(run.next_event(), "up H");
    for (arguments, expected) in [
        (
            ["tilt", "-80"],
            "the tilt of board 1 would be outside -90 to 90 degrees; no board was moved",
        ),
        (
            ["profile", "mian"],
            "unknown profile `mian`, did you mean `main`?",
        ),
        (["profile", "xyz"], "unknown profile `xyz`; available: main"),
    ] {
        let err = ctl(&run, &arguments).exited(1).err;
        assert_eq!(err, format!("error: {expected}\n"));
    }
}

#[test]
fn a_command_gets_through_sixteen_silent_clients() {
    let run = run();
    let mut clients: Vec<_> = (0..16).map(|_| raw_client(&run)).collect();
    let start = Instant::now();
    let answer = request(&mut client(&run), r#"{"command":"pause"}"#);
    assert_eq!(answer["ok"], true, "{answer}");
    println!("paused after {:?}", start.elapsed());
    assert_eq!(run.next_event(), "up H");
    // The client that has been idle for the longest time made room, and no other.
    let (mut stream, mut reader) = clients.pop().expect("a client");
    stream
        .write_all(b"{\"command\":\"state\"}\n")
        .expect("the connection is open");
    assert_eq!(read_response(&mut reader)["paused"], true);
    let (_, mut closed_reader) = clients.swap_remove(0);
    assert_eq!(
        closed_reader.read_line(&mut String::new()).expect("an end"),
        0
    );
}

#[test]
fn a_command_gets_through_as_many_subscribers_as_there_can_be() {
    let run = run();
    let mut subscribers: Vec<Client> = (0..15).map(|_| client(&run)).collect();
    for subscriber in &mut subscribers {
        let answer = request(subscriber, r#"{"command":"subscribe"}"#);
        assert_eq!(answer["ok"], true, "{answer}");
    }
    let answer = request(&mut client(&run), r#"{"command":"subscribe"}"#);
    let expected = "at most 15 clients can subscribe; end one of them";
    assert_eq!(answer["error"], expected);
    let _silent = raw_client(&run);
    assert_eq!(
        request(&mut client(&run), r#"{"command":"pause"}"#)["ok"],
        true
    );
    assert_eq!(run.next_event(), "up H");
    for mut subscriber in subscribers {
        let line = subscriber.next_notification().expect("it is connected");
        assert!(line.expect("a line").contains("event"));
    }
}

#[test]
fn a_client_that_does_not_read_is_disconnected_without_effect_on_others() {
    let run = run();
    let (mut silent, mut said) = raw_client(&run);
    silent
        .write_all(b"{\"command\":\"subscribe\"}\n")
        .expect("the session reads");
    assert_eq!(read_response(&mut said)["ok"], true);
    let mut listener = client(&run);
    assert_eq!(
        request(&mut listener, r#"{"command":"subscribe"}"#)["ok"],
        true
    );
    let (sender, notifications) = crossbeam_channel::unbounded();
    thread::spawn(move || {
        while let Ok(Some(line)) = listener.next_notification() {
            // Each press has one before its key event.
            if !line.starts_with(r#"{"event":"press""#) {
                let _ = sender.send(line);
            }
        }
    });
    let is_over = AtomicBool::new(false);
    thread::scope(|scope| {
        let typing = scope.spawn(|| {
            while !is_over.load(Ordering::Relaxed) {
                run.lift();
                thread::sleep(Duration::from_millis(14));
                run.press();
                // Several packets, also of a busy machine.
                thread::sleep(Duration::from_millis(40));
            }
        });
        let start = Instant::now();
        // A write to a closed connection fails. A panic here would wait for the thread.
        let is_disconnected = crate::support::x11::wait_for(|| silent.write_all(b" ").is_err());
        println!("disconnected after {:?}", start.elapsed());
        is_over.store(true, Ordering::Relaxed);
        typing.join().expect("the thread does not panic");
        assert!(is_disconnected, "timed out");
    });
    let state = request(&mut client(&run), r#"{"command":"pause"}"#);
    assert_eq!(state["ok"], true);
    thread::sleep(MOVE_TIME);

    let typed: Vec<String> = run.events.try_iter().collect();
    assert!(typed.len() > 20, "{} events", typed.len());
    for line in typed {
        let notification = notifications.recv_timeout(TIMEOUT);
        let notification = notification.expect("there is a notification");
        let notification: Value =
            serde_json::from_str(&notification).expect("the notification is JSON");
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(
            notification["event"],
            format!("key-{}", words[1]),
            "{notification}"
        );
        assert_eq!(notification["key"], words[2]);
    }
    let line = notifications
        .recv_timeout(TIMEOUT)
        .expect("there is a notification");
    let paused = r#"{"event":"state","state":"paused","paused":true,"paused_by":"command"}"#;
    assert_eq!(line, paused);
}

#[test]
fn a_client_that_sends_requests_without_reading_is_disconnected() {
    let run = run();
    let (mut silent, _) = raw_client(&run);
    silent
        .set_write_timeout(Some(TIMEOUT))
        .expect("the time-out is set");
    let start = Instant::now();
    while silent.write_all(b"{\"command\":\"state\"}\n").is_ok() {
        assert!(start.elapsed() < TIMEOUT, "the client is still connected");
    }
    assert_eq!(
        request(&mut client(&run), r#"{"command":"state"}"#)["state"],
        "running"
    );
    run.lift();
    assert_eq!(run.next_event(), "up H");
}

#[test]
fn a_client_without_a_subscription_receives_no_events() {
    let run = run();
    let (mut stream, mut reader) = raw_client(&run);
    run.lift();
    assert_eq!(run.next_event(), "up H");
    run.press();
    assert_eq!(run.next_event(), "down H");
    stream
        .write_all(b"{\"command\":\"state\"}\n")
        .expect("the session reads");
    stream
        .shutdown(std::net::Shutdown::Write)
        .expect("the connection is open");
    let mut all = String::new();
    reader
        .read_to_string(&mut all)
        .expect("the session closes the connection");
    assert_eq!(all.lines().count(), 1, "{all}");
    assert!(all.starts_with(r#"{"ok":true,"state":"running""#), "{all}");
}

#[test]
fn stop_releases_keys_and_ends_the_run_with_success() {
    let mut run = run();
    assert_eq!(ctl(&run, &["stop"]).done().out, "ended\n");
    assert_eq!(run.next_event(), "up H");
    let ended = run.program.0.wait().expect("the program ends");
    assert_eq!(ended.code(), Some(0));
    assert!(!socket(&run).exists());
    let absent = ctl(&run, &["state"]).exited(2);
    absent.reported("no session listens there; start `ademan run`");
}

#[test]
fn a_second_run_is_refused_and_the_socket_of_a_killed_run_is_replaced() {
    let mut run = run();
    let path = socket(&run);
    let path = path.to_str().expect("the path is UTF-8");
    let second = ["run", "--source", "typist:hi", "--control", path];
    let ended = crate::run(second).exited(2);
    ended.reported("another session listens on");
    ended.reported("`ademan ctl stop`");
    assert_eq!(
        request(&mut client(&run), r#"{"command":"state"}"#)["ok"],
        true
    );

    run.program.0.kill().expect("the program runs");
    run.program.0.wait().expect("the program ends");
    assert!(
        Path::new(path).exists(),
        "a killed run leaves its socket behind"
    );
    crate::run(second).done();
    assert!(!Path::new(path).exists());
}

#[test]
fn the_socket_is_private_from_its_creation_on() {
    let runtime = tempfile::tempdir().expect("a temporary directory");
    let folder = runtime.path().join("ademan");
    let path = folder.join("control.sock");
    let wider = |file: &Path, than: u32| {
        fs::symlink_metadata(file).is_ok_and(|found| found.mode() & 0o777 & !than != 0)
    };
    let mut checks = 0;
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
        let _run = Process::start(&mut shell).expect("the program starts");
        let mut exists = false;
        let start = Instant::now();
        while !exists {
            assert!(start.elapsed() < TIMEOUT, "timed out");
            exists = path.exists();
            assert!(!wider(&folder, 0o700), "others may enter the directory");
            assert!(!wider(&path, 0o600), "others may connect");
            checks += 1;
        }
    }
    println!("{checks} checks");
}

#[test]
fn a_directory_that_others_may_enter_is_refused() {
    let runtime = tempfile::tempdir().expect("a temporary directory");
    let folder = runtime.path().join("ademan");
    fs::create_dir(&folder).expect("a temporary directory");
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o755))
        .expect("the file belongs to this user");
    let mut run = ademan(&["run", "--source", "typist:hi"]);
    let ended = run_to_end(run.env("XDG_RUNTIME_DIR", runtime.path())).exited(2);
    ended.reported("restrict it to yourself: chmod 700");
}

#[test]
fn commands_of_another_user_are_refused() {
    const NOBODY: u32 = 65_534;
    let run = run();
    let everybody = |path: &Path, mode| {
        fs::set_permissions(path, fs::Permissions::from_mode(mode))
            .expect("the file belongs to this user");
    };
    everybody(run.folder.path(), 0o755);
    everybody(&socket(&run), 0o777);
    let path = socket(&run);
    // The program itself would send nothing to a server of another user.
    let answer = thread::spawn(move || {
        let nobody = rustix::fs::Uid::from_raw(NOBODY);
        rustix::thread::set_thread_res_uid(nobody, nobody, nobody).ok()?;
        let mut stream = UnixStream::connect(path).expect("the session listens");
        let _ = stream.write_all(b"{\"command\":\"pause\"}\n");
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        Some(answer)
    });
    let Some(answer) = answer.join().expect("no panic") else {
        println!("SKIPPED: only root can be another user");
        return;
    };
    assert_eq!(answer, [0; 0], "no answer");
    assert!(run.events.is_empty(), "the key stays pressed");
    assert_eq!(
        request(&mut client(&run), r#"{"command":"state"}"#)["paused"],
        false
    );
}

#[test]
fn a_run_that_waits_for_its_source_can_be_stopped() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let path = folder.path().join("c.sock");
    let mut command = ademan(&["run", "--wait", "--source", "serial:/dev/no-such-glove"]);
    let mut run = Process::start(command.arg("--control").arg(&path)).expect("the program starts");
    let messages = line_receiver(run.0.stderr.take().expect("the stream is piped"));
    assert!(
        messages
            .recv_timeout(TIMEOUT)
            .expect("the run waits")
            .starts_with("waiting: ")
    );
    let mut client = Client::connect(&path).expect("the session listens");
    let answer = request(&mut client, r#"{"command":"state"}"#);
    assert_eq!(answer["ok"], false, "no session runs yet");
    assert_eq!(request(&mut client, r#"{"command":"stop"}"#)["ok"], true);
    assert_eq!(run.0.wait().expect("the program ends").code(), Some(0));
}

/// A glove whose rest pose has the index finger a few degrees straighter than the hand of [`Run`] holds it.
fn glove_with_straighter_rest_pose() -> tempfile::NamedTempFile {
    let file = tempfile::Builder::new().suffix(".ron").tempfile();
    let mut file = file.expect("a file");
    let shipped = ademan::document::Document::open("unam-hc11").expect("a shipped glove");
    let rest = "full_scale_counts: 255, rest_deg: {\"index-mcp-flexion\": 32},";
    let text = shipped.text.replace("full_scale_counts: 255,", rest);
    file.write_all(text.as_bytes()).expect("it is written");
    file
}

/// Returns lines of a transcript, of a run or its replay, without the comments.
pub fn events_of(transcript: &str) -> Vec<&str> {
    let lines = transcript.lines();
    lines.filter(|line| !line.starts_with('#')).collect()
}

#[test]
fn a_zeroed_hand_is_undone_recorded_and_replayed() {
    let glove = glove_with_straighter_rest_pose();
    let fields = format!(
        "role: Both, stall_timeout_ms: 10000, glove: {:?}",
        glove.path()
    );
    let run = Run::with_setup(&fields, &["--control", "c.sock", "--record", "hand.mcap"]);
    run.wait_for_message(ARMED);
    run.press();
    let mut seen = vec![run.next_event()];
    let refused = ctl(&run, &["zero"]).exited(1);
    refused.reported("a key is down");
    run.lift();
    seen.push(run.next_event());
    let zero = |arguments: &[&str]| {
        let mut last = String::new();
        wait_until(|| {
            let moved = ctl(&run, arguments);
            last = moved.out + &moved.err;
            // The finger leaves the key some readings after the key is up.
            let is_moving = last.contains("still") || last.contains("a key is down");
            assert!(moved.code == Some(0) || is_moving, "{last}");
            moved.code == Some(0)
        });
        last
    };
    let text = zero(&["zero"]);
    assert!(
        text.contains("1 joint zeroed") && text.contains("index-mcp-flexion"),
        "{text}"
    );
    run.wait_for_message(ARMED);
    run.press();
    thread::sleep(MOVE_TIME);
    assert!(
        run.events.is_empty(),
        "the straighter finger does not reach the key"
    );
    run.lift();
    thread::sleep(MOVE_TIME);
    zero(&["undo-zero"]);
    run.wait_for_message(ARMED);
    run.press();
    seen.push(run.next_event());
    run.lift();
    seen.push(run.next_event());
    assert_eq!(seen, ["down H", "up H", "down H", "up H"]);
    ctl(&run, &["stop"]).done();

    let replay = run_in(run.folder.path(), ["replay", "hand.mcap"]);
    let events = events_of(&replay.out).into_iter().map(without_time);
    let replayed: Vec<String> = events.collect();
    assert_eq!(
        replayed, seen,
        "a replay without the command presses a third time"
    );
}

#[test]
fn a_session_that_is_stopped_by_a_signal_is_said_to_give_no_answer() {
    let run = run();
    signal("STOP", run.program.0.id());
    let ended = ctl(&run, &["state"]);
    signal("CONT", run.program.0.id());
    let ended = ended.exited(1);
    ended.reported("no answer within 5 s; the program is stopped or hangs");
    assert!(!ended.err.contains("os error"), "{}", ended.err);
}

//! Signals, and sessions that wait for a device.
#![cfg(unix)]

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpListener;
use std::process::{Command, Stdio};

use super::ademan;
use crate::support::binary::NO_FOLDER;
use crate::support::free_address::free_address;
use crate::support::process::{Process, signal};
use crate::support::run::accept;

fn start(arguments: &[&str]) -> Process {
    let mut command = ademan(arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    Process::start(&mut command).unwrap()
}

/// Returns the next line. Fails at the end, which a test would otherwise read again and again.
fn line(reader: &mut impl BufRead) -> String {
    let mut line = String::new();
    let length = reader.read_line(&mut line).unwrap();
    assert!(length > 0, "the program has ended");
    line
}

#[test]
fn a_run_releases_all_keys_on_a_signal_and_succeeds() {
    for name in ["INT", "TERM", "HUP"] {
        let text = "typist:a text that takes longer than this test";
        let mut run = start(&["run", "--source", text, "--armed"]);
        let mut out = BufReader::new(run.0.stdout.take().unwrap());
        assert!(line(&mut out).contains("down A"));
        signal(name, run.0.id());
        let mut rest = String::new();
        out.read_to_string(&mut rest).unwrap();
        assert_eq!(
            rest.matches("up ").count(),
            rest.matches("down ").count() + 1,
            "{rest}"
        );
        assert_eq!(run.0.wait().unwrap().code(), Some(0), "{name}");
    }
}

/// Returns a server that accepts no connection, as its queue is full, and what fills the queue.
#[cfg(target_os = "linux")]
fn server_without_answers() -> (std::os::fd::OwnedFd, Vec<std::os::fd::OwnedFd>, String) {
    use rustix::net::{self, AddressFamily, SocketType};
    let socket = || {
        net::socket_with(
            AddressFamily::INET,
            SocketType::STREAM,
            net::SocketFlags::NONBLOCK | net::SocketFlags::CLOEXEC,
            None,
        )
    };
    let listener = socket().unwrap();
    let address = free_address();
    net::bind(&listener, &address).unwrap();
    net::listen(&listener, 0).unwrap();
    let clients: Vec<_> = (0..3).map(|_| socket().unwrap()).collect();
    for client in &clients {
        // It is in progress.
        let _ = net::connect(client, &address);
    }
    (listener, clients, address.to_string())
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_whose_server_does_not_answer_ends_on_a_signal() {
    let (_server, _clients, address) = server_without_answers();
    let source = format!("tcp:{address}?protocol=text-line");
    let mut run = start(&["run", "--source", &source]);
    let mut err = BufReader::new(run.0.stderr.take().unwrap());
    while !line(&mut err).contains("only a pointer") {}
    signal("INT", run.0.id());
    let mut rest = String::new();
    err.read_to_string(&mut rest).unwrap();
    assert!(!rest.contains("timed out"), "{rest}");
    assert_eq!(run.0.wait().unwrap().code(), Some(0), "{rest}");
}

#[test]
fn sigusr1_to_all_programs_of_the_name_ends_no_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.mcap");
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let address = listener.local_addr().unwrap();
    let source = format!("tcp:{address}?protocol=text-line");
    let mut record = start(&["record", super::text(&path), "--source", &source]);
    let _sender = accept(&listener);
    let mut err = BufReader::new(record.0.stderr.take().unwrap());
    while !line(&mut err).starts_with("recording to ") {}
    signal("USR1", record.0.id());
    signal("INT", record.0.id());
    assert_eq!(record.0.wait().unwrap().code(), Some(0));
}

#[test]
fn sigusr1_to_all_programs_of_the_name_ends_none_that_types_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    let page = format!("web:{}", free_address());
    // Without a pose, there is no file to export.
    for (arguments, code) in [
        (["trace", "readings"], 0),
        (["share", &page], 0),
        (["export", super::text(&path)], 1),
    ] {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let address = listener.local_addr().unwrap();
        let source = format!("tcp:{address}?protocol=text-line");
        let mut program = start(&[&arguments[..], &["--source", &source]].concat());
        let _sender = accept(&listener);
        signal("USR1", program.0.id());
        signal("INT", program.0.id());
        let ended = program.0.wait().unwrap();
        assert_eq!(ended.code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn sigusr1_ends_no_program_that_waits_for_lines() {
    let mut command = ademan(["text", "decode", "en", "--layout", "qwerty-flat"]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut decode = Process::start(&mut command).unwrap();
    let mut input = decode.0.stdin.take().unwrap();
    input.write_all(b"0 0\n\n").unwrap();
    let mut out = BufReader::new(decode.0.stdout.take().unwrap());
    assert!(line(&mut out).contains('\t'));
    signal("USR1", decode.0.id());
    drop(input);
    let mut rest = String::new();
    out.read_to_string(&mut rest).unwrap();
    assert_eq!(decode.0.wait().unwrap().code(), Some(0));
}

#[test]
fn sigusr1_ends_no_calibration_without_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.ron");
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let source = format!("tcp:{}", listener.local_addr().unwrap());
    let arguments = ["calibrate", "--source", &source, "--out"];
    let mut calibrate = start(&[&arguments[..], &[super::text(&path)]].concat());
    let _sender = accept(&listener);
    let mut out = BufReader::new(calibrate.0.stdout.take().unwrap());
    assert!(line(&mut out).contains("pose 1"));
    signal("USR1", calibrate.0.id());
    signal("INT", calibrate.0.id());
    assert_eq!(calibrate.0.wait().unwrap().code(), Some(1));
}

#[test]
fn sigusr1_ends_no_replay_without_an_effect() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.mcap");
    let path = super::text(&path);
    super::run(["record", path, "--source", "typist:a text"]).done();
    let mut replay = start(&["replay", path, "--speed", "1"]);
    let mut out = BufReader::new(replay.0.stdout.take().unwrap());
    assert!(line(&mut out).contains("down A"));
    signal("USR1", replay.0.id());
    let mut rest = String::new();
    out.read_to_string(&mut rest).unwrap();
    assert!(rest.contains("up   T"), "{rest}");
    assert_eq!(replay.0.wait().unwrap().code(), Some(0));
}

#[test]
fn a_demo_that_is_interrupted_fails() {
    let mut demo = start(&["demo"]);
    let mut out = BufReader::new(demo.0.stdout.take().unwrap());
    line(&mut out);
    signal("INT", demo.0.id());
    assert_eq!(demo.0.wait().unwrap().code(), Some(1));
    let mut err = String::new();
    demo.0
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut err)
        .unwrap();
    assert!(err.contains("interrupted before the end"), "{err}");
    let mut rest = String::new();
    out.read_to_string(&mut rest).unwrap();
    assert!(rest.starts_with("typed "), "{rest}");
    assert!(!rest.contains("error rate"), "{rest}");
}

#[test]
fn a_run_waits_for_a_device_and_reports_it_once() {
    let address = free_address();
    let source = format!("tcp:{address}");
    let mut run = start(&["run", "--wait", "--role", "both", "--source", &source]);
    let mut err = BufReader::new(run.0.stderr.take().unwrap());
    let waiting = line(&mut err);
    assert!(
        waiting.starts_with("waiting: cannot open tcp:"),
        "{waiting}"
    );
    assert!(waiting.ends_with("Ctrl-C ends\n"), "{waiting}");
    std::thread::sleep(std::time::Duration::from_millis(700));

    let listener = TcpListener::bind(address).unwrap();
    let mut glove = accept(&listener);
    glove.write_all(&[0; 10]).unwrap();
    assert!(line(&mut err).starts_with("found tcp:"));
    signal("INT", run.0.id());
    assert_eq!(run.0.wait().unwrap().code(), Some(0));
}

#[test]
fn a_run_that_cannot_record_does_not_wait_for_a_device() {
    let recording = tempfile::NamedTempFile::new().unwrap();
    let path = recording.path().to_str().unwrap();
    let source = ["--source", "serial:/dev/no-such-glove"];
    let arguments = [&["run", "--wait", "--record", path][..], &source].concat();
    let mut run = start(&arguments);
    let mut err = BufReader::new(run.0.stderr.take().unwrap());
    let refused = line(&mut err);
    assert!(
        refused.starts_with("error: cannot create the recording"),
        "{refused}"
    );
    assert_eq!(run.0.wait().unwrap().code(), Some(2));
}

#[test]
fn ctrl_c_ends_the_wait_for_a_device() {
    let mut run = start(&["run", "--wait", "--source", "serial:/dev/no-such-glove"]);
    let mut err = BufReader::new(run.0.stderr.take().unwrap());
    assert!(line(&mut err).contains("there is no such port"));
    signal("INT", run.0.id());
    assert_eq!(run.0.wait().unwrap().code(), Some(0));
}

#[test]
fn a_run_waits_for_the_device_of_its_other_hand() {
    let folder = tempfile::tempdir().unwrap();
    let setup = folder.path().join("two.ron");
    let text = "Setup(source: \"typist:a\", other_hand: (source: \"serial:/dev/no-such-glove\"), \
                layout: \"qwerty-two-flat\", output: \"none\")";
    std::fs::write(&setup, text).unwrap();
    let mut run = start(&["run", "--wait", setup.to_str().unwrap()]);
    let mut err = BufReader::new(run.0.stderr.take().unwrap());
    let waiting = line(&mut err);
    assert!(
        waiting.starts_with("waiting: cannot open serial:/dev/no-such-glove"),
        "{waiting}"
    );
    signal("INT", run.0.id());
    assert_eq!(run.0.wait().unwrap().code(), Some(0));
}

#[test]
fn a_run_continues_when_its_standard_error_is_closed() {
    let mut child = ademan(["run", "--source", "typist:hi"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(0));
    assert_eq!(String::from_utf8(ended.stdout).unwrap().lines().count(), 4);
}

/// Returns the state letter of a process in procfs: `T` if it is stopped.
#[cfg(target_os = "linux")]
fn process_state(process: u32) -> char {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    let after_name = stat.rsplit(") ").next().unwrap();
    after_name.chars().next().unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_that_is_continued_before_it_has_stopped_goes_on() {
    let text = format!("typist:{}", "a text that takes longer ".repeat(20));
    let mut run = start(&["run", "--source", &text, "--armed"]);
    let mut out = BufReader::new(run.0.stdout.take().unwrap());
    assert!(line(&mut out).contains("down A"));
    for _ in 0..3 {
        signal("TSTP", run.0.id());
        signal("CONT", run.0.id());
        // The work before a stop takes 50 ms and more.
        for _ in 0..60 {
            std::thread::sleep(std::time::Duration::from_millis(10));
            assert_ne!(process_state(run.0.id()), 'T', "it is stopped");
        }
    }
    signal("TSTP", run.0.id());
    let is_stopped = || process_state(run.0.id()) == 'T';
    assert!(
        crate::support::x11::wait_for(is_stopped),
        "it does not stop"
    );
    signal("CONT", run.0.id());
    signal("INT", run.0.id());
    assert_eq!(run.0.wait().unwrap().code(), Some(0));
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_that_is_started_by_nohup_ignores_a_hangup_and_no_other_signal() {
    let text = "typist:a text that takes longer than this test";
    let program = ademan(["run", "--source", text, "--armed"]);
    let mut command = Command::new("sh");
    command
        .args(["-c", "trap '' HUP; exec \"$0\" \"$@\""])
        .arg(program.get_program())
        .args(program.get_args())
        .env("XDG_CONFIG_HOME", NO_FOLDER)
        .env_remove("DISPLAY")
        .env_remove("XDG_RUNTIME_DIR")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    let mut run = Process::start(&mut command).unwrap();
    let mut out = BufReader::new(run.0.stdout.take().unwrap());
    assert!(line(&mut out).contains("down A"));
    signal("HUP", run.0.id());
    while !line(&mut out).contains("down T") {}
    signal("TERM", run.0.id());
    let mut rest = String::new();
    out.read_to_string(&mut rest).unwrap();
    assert_eq!(run.0.wait().unwrap().code(), Some(0));
}

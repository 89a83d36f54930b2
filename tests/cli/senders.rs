//! Datagrams that are not understood or come from several senders, and what a person sees of them.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::net::{SocketAddr, UdpSocket};
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::protocol::{opentrack, vmc};
use ademan::hand::{ArmBone, BoneRotations};
use ademan::session::control_socket::Client;
use crossbeam_channel::{RecvTimeoutError, bounded};
use glam::Quat;
use serde_json::Value;

use crate::support::binary::ademan;
use crate::support::free_address::free_address;
use crate::support::process::{Process, signal};
use crate::support::run::line_receiver;
use crate::support::source::text_lines;

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Starts a run that receives datagrams at an address.
fn start(address: SocketAddr, control: &Path) -> Process {
    let source = format!("udp:{address}?protocol=opentrack");
    let mut command = ademan(["run", "--output", "none"]);
    command
        .args(["--source", &source, "--control"])
        .arg(control)
        .env_remove("XDG_RUNTIME_DIR")
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    Process::start(&mut command).expect("the program starts")
}

/// Calls `send` until the statistics are as `is_as_expected` says.
fn wait_for(control: &Path, mut send: impl FnMut(), is_as_expected: impl Fn(&Value) -> bool) {
    let start = Instant::now();
    loop {
        send();
        thread::sleep(Duration::from_millis(5));
        let state = Client::connect(control).ok().and_then(|mut client| {
            let line = client.request(r#"{"command":"state"}"#).ok()?;
            serde_json::from_str::<Value>(&line).ok()
        });
        let stats = state.map(|state| state["stats"].clone());
        if stats.as_ref().is_some_and(&is_as_expected) {
            return;
        }
        assert!(start.elapsed() < TIMEOUT, "{stats:?}");
    }
}

/// Waits until the program has read every datagram at an address.
fn wait_until_read(address: SocketAddr) {
    let port = format!(":{:04X}", address.port());
    let start = Instant::now();
    loop {
        let table = fs::read_to_string("/proc/net/udp").expect("Linux");
        let mut rows = table
            .lines()
            .map(|row| row.split_whitespace().collect::<Vec<_>>());
        let row = rows.find(|row| row.get(1).is_some_and(|local| local.ends_with(&port)));
        if row.expect("the program listens")[4].ends_with(":00000000") {
            return;
        }
        assert!(start.elapsed() < TIMEOUT, "it is not read");
        thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_datagram_of_a_second_sender_is_in_the_state_while_the_first_is_silent_and_in_the_last_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let (address, control) = (free_address(), folder.path().join("c.sock"));
    let [glove, other] = [0, 1].map(|_| UdpSocket::bind("127.0.0.1:0").expect("a free port"));
    let pose = opentrack::encode(&[0.0; 6]);
    let mut run = start(address, &control);
    let send = |socket: &UdpSocket| _ = socket.send_to(&pose, address);
    wait_for(
        &control,
        || send(&glove),
        |stats| stats["received"].as_u64() > Some(0),
    );
    send(&glove);
    send(&other);
    // Nothing follows it.
    let count = |stats: &Value| stats["invalid"]["unknown-sender"].as_u64();
    wait_for(&control, || (), |stats| count(stats) == Some(1));
    // The program is stopped before the next report is due.
    send(&glove);
    send(&other);
    wait_until_read(address);
    signal("TERM", run.0.id());
    let mut messages = String::new();
    let mut stderr = run.0.stderr.take().expect("it is piped");
    stderr.read_to_string(&mut messages).expect("UTF-8");
    assert!(messages.contains("2 unknown-sender"), "{messages}");
}

#[test]
fn keys_that_a_person_has_allowed_for_one_sender_are_forbidden_for_the_next_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let (address, control) = (free_address(), folder.path().join("c.sock"));
    let [glove, other] = [0, 1].map(|_| UdpSocket::bind("127.0.0.1:0").expect("a free port"));
    let pose = opentrack::encode(&[0.0; 6]);
    let mut run = start(address, &control);
    let messages = line_receiver(run.0.stderr.take().expect("it is piped"));
    let send = |socket: &UdpSocket| _ = socket.send_to(&pose, address);
    wait_for(
        &control,
        || send(&glove),
        |stats| stats["received"].as_u64() > Some(0),
    );
    let mut client = Client::connect(&control).expect("the program listens");
    let reply = client.request(r#"{"command":"allow-keys"}"#);
    assert_eq!(reply.expect("a reply"), r#"{"ok":true}"#);
    // The other sender follows once the first one has been silent.
    let start = Instant::now();
    loop {
        send(&other);
        match messages.recv_timeout(Duration::from_millis(5)) {
            Ok(line) if line.contains("another sender has replaced") => break,
            Ok(_) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => panic!("the program ended"),
        }
        assert!(start.elapsed() < TIMEOUT, "keys are still allowed");
    }
}

#[test]
fn empty_datagrams_and_junk_lock_no_glove_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let (address, control) = (free_address(), folder.path().join("c.sock"));
    let [glove, other] = [0, 1].map(|_| UdpSocket::bind("127.0.0.1:0").expect("a free port"));
    let pose = opentrack::encode(&[0.0; 6]);
    let _run = start(address, &control);
    // The other program is there first.
    let junk = || {
        let _ = other.send_to(b"", address);
        let _ = other.send_to(b"junk", address);
    };
    wait_for(&control, junk, |stats| {
        stats["invalid"]["truncated"].as_u64() > Some(0)
    });
    let both = || {
        junk();
        let _ = glove.send_to(&pose, address);
    };
    wait_for(&control, both, |stats| {
        stats["received"].as_u64() > Some(20)
    });
}

/// Sends datagrams of a protocol until the program prints a message with `part`, and returns it.
fn message_about(
    part: &str,
    protocol: &str,
    mut datagram: impl FnMut() -> Vec<u8> + Send + 'static,
) -> String {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    message_to(part, protocol, move |address| {
        let _ = socket.send_to(&datagram(), address);
    })
}

/// Calls `send` with the address of the program until it prints a message with `part`, and returns the message.
fn message_to(
    part: &str,
    protocol: &str,
    mut send: impl FnMut(SocketAddr) + Send + 'static,
) -> String {
    let address = free_address();
    let source = format!("udp:{address}?protocol={protocol}");
    let mut command = ademan([
        "run",
        "--output",
        "none",
        "--control",
        "off",
        "--source",
        &source,
    ]);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut program = Process::start(&mut command).expect("the program starts");
    let stderr = BufReader::new(program.0.stderr.take().expect("it is piped"));
    let (end, is_over) = bounded::<()>(0);
    let (process, start) = (program.0.id(), Instant::now());
    let sender = thread::spawn(move || {
        let interval = Duration::from_millis(10);
        while is_over.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
            send(address);
            if start.elapsed() > TIMEOUT {
                // Its messages end, so that the test fails.
                signal("KILL", process);
                return;
            }
        }
    });
    let mut lines = stderr.lines().map_while(Result::ok);
    let found = lines.find(|message| message.contains(part));
    drop(end);
    sender.join().expect("no panic");
    found.expect("a message")
}

#[test]
fn a_program_that_opens_a_socket_for_each_datagram_is_told_to_keep_one() {
    let pose = opentrack::encode(&[0.0; 6]);
    let message = message_to("several senders", "opentrack", move |address| {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        let _ = socket.send_to(&pose, address);
    });
    assert!(message.ends_with("for each packet keep one"), "{message}");
}

#[test]
fn a_datagram_that_is_understood_but_wrong_is_not_blamed_on_the_bit_rate() {
    let message = message_about("no valid packet", "text-line", || b"1 2 3".to_vec());
    assert!(
        message.ends_with("for 2 s: 3 values instead of 64"),
        "{message}"
    );
}

#[test]
fn a_camera_that_sees_no_hand_is_not_blamed_on_its_protocol() {
    let start = Instant::now();
    let message = message_about("valid packet", "hand-landmarks", move || {
        let time_us = start.elapsed().as_micros();
        format!("{{\"time_us\":{time_us},\"hands\":[]}}").into_bytes()
    });
    assert!(
        message.ends_with("none has shown an arm or hand for 2 s; check that it sees the hand"),
        "{message}"
    );
}

#[test]
fn a_sender_whose_clock_counts_seconds_is_told_the_unit() {
    let line = text_lines("h")[0].trim_end().to_owned();
    let start = Instant::now();
    let message = message_about("packets from", "text-line", move || {
        format!("{line} time_us={}", start.elapsed().as_secs()).into_bytes()
    });
    assert!(
        message.contains("nearly all packets from udp:"),
        "{message}"
    );
    let reason = "`time_us` is not later than in an earlier line; it counts microseconds";
    assert!(message.ends_with(reason), "{message}");
}

#[test]
fn an_avatar_that_shows_only_the_other_hand_is_reported_without_an_option() {
    let mut bones = BoneRotations::default();
    for bone in [ArmBone::LowerArm, ArmBone::Hand, ArmBone::IndexFirst] {
        bones.left.set(bone, Quat::IDENTITY);
    }
    let message = message_about("hand", "vmc", move || vmc::encode(&bones));
    let expected =
        "shows only the left hand, which the setup does not use: add `other_hand` to the setup";
    assert!(message.contains(expected), "{message}");
}

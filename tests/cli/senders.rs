//! Datagrams of several senders, and what a person sees of them.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::Read;
use std::net::{SocketAddr, UdpSocket};
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::protocol::opentrack;
use ademan::session::control_socket::Client;
use serde_json::Value;

use crate::support::binary::ademan;
use crate::support::free_address::free_address;
use crate::support::process::{Process, signal};

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

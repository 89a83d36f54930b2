//! More clients of the control socket than it accepts.

use std::fs;
use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::os::unix::net::UnixStream;

use ademan::session::control_socket::Client;

use super::limit_descriptors;
use crate::support::run::{Run, TIMEOUT};

#[test]
fn a_thousand_connections_end_and_the_first_client_is_served() {
    let mut run = Run::with_held_key(&["--control", "c.sock"]);
    let path = run.folder.path().join("c.sock");
    let mut first = Client::connect(&path).expect("the program listens");
    let mut check_reply = || {
        let reply = first.request(r#"{"command":"state"}"#).expect("a reply");
        assert!(reply.contains("\"running\""), "{reply}");
    };
    check_reply();
    // They send the start of a line and stay connected, as far as the program lets them.
    let mut connected = Vec::new();
    for number in 0..1_000 {
        let mut stream = UnixStream::connect(&path).expect("the program listens");
        stream
            .write_all(b"{\"command\"")
            .expect("the socket accepts bytes");
        connected.push(stream);
        if number % 100 == 0 {
            check_reply();
        }
    }
    // All but the last ones were disconnected.
    for stream in &connected[..1_000 - 16] {
        stream.set_read_timeout(Some(TIMEOUT)).expect("a timeout");
        let mut reader = BufReader::new(stream);
        let mut line = String::new();
        match reader.read_line(&mut line) {
            Ok(_) => assert_eq!(line, ""),
            Err(error) => assert_ne!(error.kind(), ErrorKind::WouldBlock),
        }
    }
    check_reply();
    assert!(run.events.is_empty(), "the key stays pressed");
    run.lift();
    assert_eq!(run.next_event(), "up H");
    drop(connected);
    let _ = run.program.0.kill();
}

/// The thread of a client that has its response closes the connection a moment later, and the next client has come by then.
#[test]
fn commands_in_a_row_are_executed_although_no_file_descriptor_is_free() {
    let mut run = Run::with_held_key(&["--control", "c.sock"]);
    let path = run.folder.path().join("c.sock");
    let process = run.program.0.id();
    let descriptors = fs::read_dir(format!("/proc/{process}/fd")).expect("it runs");
    limit_descriptors(process, descriptors.count() as u64);
    for number in 0..500 {
        let mut client = Client::connect(&path).expect("the program listens");
        let reply = client.request(r#"{"command":"state"}"#);
        let reply = reply.unwrap_or_else(|error| panic!("command {number}: {error}"));
        assert!(reply.contains("\"running\""), "{reply}");
    }
    let _ = run.program.0.kill();
}

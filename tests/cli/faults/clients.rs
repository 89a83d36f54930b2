//! More clients of the control socket than it accepts.

use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::os::unix::net::UnixStream;

use ademan::session::control_socket::Client;

use crate::support::run::{Run, TIMEOUT};

#[test]
fn a_thousand_connections_are_refused_and_the_first_client_is_served() {
    let mut run = Run::with_held_key(&["--control", "c.sock"]);
    let path = run.folder.path().join("c.sock");
    let mut first = Client::connect(&path).expect("the program listens");
    let mut check_reply = || {
        let reply = first.request(r#"{"command":"state"}"#).expect("a reply");
        assert!(reply.contains("\"running\""), "{reply}");
    };
    check_reply();
    // They send the start of a line and stay connected.
    let mut connected = Vec::new();
    for _ in 1..16 {
        let mut stream = UnixStream::connect(&path).expect("the program listens");
        stream
            .write_all(b"{\"command\"")
            .expect("the socket accepts bytes");
        connected.push(stream);
    }
    for number in 0..1_000 {
        let stream = UnixStream::connect(&path).expect("the program listens");
        stream.set_read_timeout(Some(TIMEOUT)).expect("a timeout");
        let mut reader = BufReader::new(stream);
        let mut line = String::new();
        // A refused client gets a message or is disconnected.
        match reader.read_line(&mut line) {
            Ok(_) => {
                let is_refused = line.is_empty() || line.contains("all 16 connections are in use");
                assert!(is_refused, "{number}: {line}");
            }
            Err(error) => assert_ne!(
                error.kind(),
                ErrorKind::WouldBlock,
                "client {number} is served"
            ),
        }
        if number % 100 == 0 {
            check_reply();
        }
    }
    check_reply();
    assert!(run.events.is_empty(), "the key stays pressed");
    run.lift();
    assert_eq!(run.next_event(), "up H");
    drop(connected);
    let _ = run.program.0.kill();
}

//! More clients than anybody needs.

use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::os::unix::net::UnixStream;

use ademan::session::control_socket::Client;

use crate::support::run::{Run, TIMEOUT};

#[test]
fn a_thousand_connections_are_refused_and_the_one_that_was_there_is_answered() {
    let mut run = Run::with_held_key(&["--control", "c.sock"]);
    let path = run.folder.path().join("c.sock");
    let mut first = Client::connect(&path).expect("the run listens");
    let mut is_answered = || {
        let answer = first.request(r#"{"command":"state"}"#).expect("an answer");
        assert!(answer.contains("\"running\""), "{answer}");
    };
    is_answered();
    // They say the beginning of something, and stay.
    let mut seated = Vec::new();
    for _ in 1..16 {
        let mut stream = UnixStream::connect(&path).expect("the run listens");
        stream.write_all(b"{\"ask\"").expect("it is heard");
        seated.push(stream);
    }
    for number in 0..1_000 {
        let stream = UnixStream::connect(&path).expect("the run listens");
        stream.set_read_timeout(Some(TIMEOUT)).expect("a limit");
        let mut reader = BufReader::new(stream);
        let mut line = String::new();
        // Whoever is refused is told so, or cut off.
        match reader.read_line(&mut line) {
            Ok(_) => {
                let is_told = line.is_empty() || line.contains("all 16 connections are in use");
                assert!(is_told, "{number}: {line}");
            }
            Err(error) => assert_ne!(error.kind(), ErrorKind::WouldBlock, "{number} has a seat"),
        }
        if number % 100 == 0 {
            is_answered();
        }
    }
    is_answered();
    assert!(run.events.is_empty(), "the key stays held");
    run.lift();
    assert_eq!(run.next_event(), "up H");
    drop(seated);
    let _ = run.program.0.kill();
}

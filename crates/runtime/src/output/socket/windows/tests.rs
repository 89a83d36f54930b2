//! Tests of pipes between two ends in one process.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::Shutdown;

use super::*;

/// Returns the path of a pipe of one test.
fn path(name: &str) -> PathBuf {
    format!("{PREFIX}ademan-test-{}-{name}", std::process::id()).into()
}

/// Returns both ends of a connection, and what keeps the pipe.
fn connected(name: &str) -> (Listener, Stream, Stream) {
    let listener = Listener::open(&path(name)).unwrap();
    let client = connect(listener.path()).unwrap();
    let server = listener.accept().unwrap();
    (listener, client, server)
}

#[test]
fn lines_pass_in_both_directions_while_each_end_waits_for_one() {
    let (_listener, client, server) = connected("lines");
    let echo = thread::spawn(move || {
        let mut lines = BufReader::new(&server).lines();
        while let Some(Ok(line)) = lines.next() {
            (&server)
                .write_all(format!("{line}!\n").as_bytes())
                .unwrap();
        }
    });
    let mut lines = BufReader::new(&client).lines();
    for number in 0..100 {
        (&client)
            .write_all(format!("{number}\n").as_bytes())
            .unwrap();
        assert_eq!(lines.next().unwrap().unwrap(), format!("{number}!"));
    }
    drop(lines);
    client.shutdown(Shutdown::Both).unwrap();
    // The reading thread of the client ends with the next line of the server, or with the process.
    drop((client, echo));
}

#[test]
fn a_read_and_a_write_time_out() {
    let (_listener, client, server) = connected("timeouts");
    let limit = Some(Duration::from_millis(50));
    client.set_read_timeout(limit).unwrap();
    let error = (&client).read(&mut [0; 8]).unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::TimedOut);
    // Nobody reads on, so the buffers fill.
    server.set_write_timeout(limit).unwrap();
    let line = [b'x'; 4096];
    let written = (0..1000).map(|_| (&server).write_all(&line));
    let error = written.into_iter().find_map(Result::err).unwrap();
    assert_eq!(error.kind(), io::ErrorKind::TimedOut);
    assert_eq!((&server).read(&mut [0; 8]).unwrap(), 0, "it is closed");
}

#[test]
fn a_pipe_in_use_and_a_path_that_is_none_are_errors() {
    let first = Listener::open(&path("use")).unwrap();
    assert!(matches!(
        Listener::open(&path("use")),
        Err(SocketError::InUse)
    ));
    drop(first);
    assert!(Listener::open(&path("use")).is_ok());
    assert_eq!(
        connect(&path("none")).err().unwrap().kind(),
        io::ErrorKind::NotFound
    );
    for wrong in [r"C:\Temp\control.sock", PREFIX, r"\\.\pipe\a\b"] {
        assert!(check_path(Path::new(wrong)).is_err(), "{wrong}");
    }
    let long = format!("{PREFIX}{}", "x".repeat(MAX_PATH));
    assert!(matches!(
        check_path(Path::new(&long)),
        Err(SocketError::PathTooLong { .. })
    ));
}

//! Clients that keep their connections to the page open.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};

use super::serve;
use crate::support::run::TIMEOUT;

/// The connections that the server keeps at once.
const MAX_CLIENTS: usize = 32;

/// Asks for the page. Returns the connection if it was sent.
fn request(host: &str) -> Option<TcpStream> {
    let mut stream = TcpStream::connect(host).ok()?;
    stream.set_read_timeout(Some(TIMEOUT)).ok()?;
    write!(stream, "GET / HTTP/1.1\r\nHost: {host}\r\n\r\n").ok()?;
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).ok()?;
    answer.starts_with(b"HTTP/1.1 200").then_some(stream)
}

/// Asserts that a server all of whose places such clients take has room again while each of them sends a byte now and then.
fn assert_room_comes_back(client: impl Fn(&str) -> TcpStream) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("index.html"), "<p>page").expect("room on the disk");
    let (_server, address) = serve(folder.path());
    let host = address.trim_start_matches("http://").trim_end_matches('/');
    let mut slow: Vec<_> = (0..MAX_CLIENTS).map(|_| client(host)).collect();
    assert!(request(host).is_none(), "all places are taken");
    let start = Instant::now();
    loop {
        for stream in &mut slow {
            // It is disconnected some time.
            let _ = stream.write_all(b"x");
        }
        if request(host).is_some() {
            break;
        }
        assert!(start.elapsed() < TIMEOUT, "no place becomes free");
        thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn clients_that_send_on_without_an_end_make_room_for_others() {
    assert_room_comes_back(|host| request(host).expect("the page"));
}

#[test]
fn clients_whose_request_has_no_end_make_room_for_others() {
    assert_room_comes_back(|host| {
        let mut stream = TcpStream::connect(host).expect("the server");
        write!(stream, "GET /").expect("a place");
        stream
    });
}

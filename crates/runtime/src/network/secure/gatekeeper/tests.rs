use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};

use super::*;
use crate::network::{SecureError, Stream, TokenRole, connect, tokens};

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// A server that sends `data` and its role to each client, and reports the name of its token.
struct Server {
    folder: tempfile::TempDir,
    port: TcpListener,
    keeper: Gatekeeper,
    admitted: Receiver<(String, Box<dyn Stream>)>,
    on_admitted: std::sync::mpsc::Sender<(String, Box<dyn Stream>)>,
}

impl Server {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        tokens::create(&folder.path().join("network"), "desk", TokenRole::Type).unwrap();
        let (on_admitted, admitted) = channel();
        Self {
            keeper: Gatekeeper::open(&folder.path().join("network")).unwrap(),
            folder,
            port: TcpListener::bind("127.0.0.1:0").unwrap(),
            admitted,
            on_admitted,
        }
    }

    fn folder(&self) -> PathBuf {
        self.folder.path().join("network")
    }

    fn token_file(&self) -> PathBuf {
        self.folder().join("desk.token")
    }

    /// Returns both ends of a new connection.
    fn connection(&self) -> (TcpStream, TcpStream) {
        let client = TcpStream::connect(self.port.local_addr().unwrap()).unwrap();
        client.set_read_timeout(Some(TIMEOUT)).unwrap();
        (client, self.port.accept().unwrap().0)
    }

    /// Admits one end of a connection as if it came from this address.
    fn admit(&self, stream: TcpStream, address: [u8; 4]) {
        let on_admitted = self.on_admitted.clone();
        self.keeper
            .admit(stream, address.into(), move |mut client| {
                let data = format!("data for {}\n", client.token.role);
                client.stream.write_all(data.as_bytes()).unwrap();
                client.stream.flush().unwrap();
                let _ = on_admitted.send((client.token.name, client.stream));
            });
    }

    fn connect(&self, token_file: &Path, address: [u8; 4]) -> Result<Box<dyn Stream>, SecureError> {
        let (client, server) = self.connection();
        self.admit(server, address);
        connect(client, token_file)
    }

    /// Waits until no handshake is in progress.
    fn settle(&self) {
        let start = Instant::now();
        while !self.keeper.0.state().handshakes.is_empty() {
            assert!(start.elapsed() < TIMEOUT, "a handshake does not end");
            thread::sleep(Duration::from_millis(1));
        }
    }
}

/// Reads a line, waiting for it.
fn line(stream: &mut dyn Stream) -> io::Result<String> {
    let (start, mut line, mut byte) = (Instant::now(), Vec::new(), [0]);
    while start.elapsed() < TIMEOUT {
        match stream.read(&mut byte) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(_) if byte == *b"\n" => return Ok(String::from_utf8(line).unwrap()),
            Ok(_) => line.extend(byte),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(error) => return Err(error),
        }
    }
    panic!("no line and no end")
}

#[test]
fn a_client_with_a_token_receives_data_with_its_role_until_the_token_is_revoked() {
    let server = Server::new();
    let mut client = server
        .connect(&server.token_file(), [192, 0, 2, 1])
        .unwrap();
    assert_eq!(line(&mut *client).unwrap(), "data for type");
    let (name, _server_end) = server.admitted.recv_timeout(TIMEOUT).unwrap();
    assert_eq!(name, "desk");
    let copy = server.folder().join("copy");
    std::fs::copy(server.token_file(), &copy).unwrap();
    tokens::revoke(&server.folder(), "desk").unwrap();
    assert!(line(&mut *client).is_err(), "it is disconnected");
    let again = server.connect(&copy, [192, 0, 2, 1]);
    assert!(matches!(again, Err(SecureError::Refused { .. })));
}

#[test]
fn a_thousand_wrong_tokens_are_five_checks_and_another_address_is_served() {
    let server = Server::new();
    let other = tempfile::tempdir().unwrap();
    let wrong = other.path().join("network");
    tokens::create(&wrong, "desk", TokenRole::Type).unwrap();
    // The right certificate, the wrong token.
    let text = std::fs::read_to_string(server.token_file()).unwrap();
    let wrong_text = std::fs::read_to_string(wrong.join("desk.token")).unwrap();
    let of_line = |file_text: &str, key: &str| {
        let line = file_text.lines().find(|line| line.starts_with(key));
        line.unwrap().to_owned()
    };
    let mixed = text.replace(&of_line(&text, "secret "), &of_line(&wrong_text, "secret "));
    let wrong_file = wrong.join("desk.token");
    std::fs::write(&wrong_file, mixed).unwrap();
    let mut refused = 0;
    for _ in 0..1000 {
        let tried = server.connect(&wrong_file, [192, 0, 2, 1]);
        refused += usize::from(matches!(tried, Err(SecureError::Refused { .. })));
        assert!(tried.is_err());
        server.settle();
    }
    assert_eq!(
        refused, 5,
        "the other connections are closed before the handshake"
    );
    let valid = server.connect(&server.token_file(), [192, 0, 2, 1]);
    assert!(valid.is_err(), "the address has to wait");
    let mut elsewhere = server
        .connect(&server.token_file(), [192, 0, 2, 2])
        .unwrap();
    assert_eq!(line(&mut *elsewhere).unwrap(), "data for type");
    // It is reported by the thread that has just answered.
    let admitted = server.admitted.recv_timeout(TIMEOUT);
    assert!(admitted.is_ok());
    assert_eq!(server.admitted.try_iter().count(), 0);
}

#[test]
fn silent_clients_are_closed_and_take_no_place_of_another_address() {
    let server = Server::new();
    let mut silent = Vec::new();
    for _ in 0..50 {
        let (client, end) = server.connection();
        server.admit(end, [192, 0, 2, 1]);
        silent.push(client);
    }
    let in_progress = server.keeper.0.state().handshakes.len();
    assert!(in_progress <= 4, "{in_progress}");
    let mut client = server
        .connect(&server.token_file(), [192, 0, 2, 2])
        .unwrap();
    assert_eq!(line(&mut *client).unwrap(), "data for type");
    // One byte from time to time prolongs nothing.
    let mut slow = silent.pop().expect("a client");
    let start = Instant::now();
    while slow.write_all(b"\x16").is_ok() {
        assert!(start.elapsed() < TIMEOUT, "it is not closed");
        thread::sleep(Duration::from_millis(100));
    }
    for mut closed in silent {
        match closed.read(&mut [0]) {
            Ok(count) => assert_eq!(count, 0, "an answer"),
            Err(error) => assert_ne!(error.kind(), ErrorKind::WouldBlock, "still connected"),
        }
    }
    server.settle();
}

#[test]
fn silent_clients_of_many_addresses_keep_no_client_out() {
    let server = Server::new();
    let mut silent = Vec::new();
    let mut connect_silent = |used: &Server, address| {
        let (client, end) = used.connection();
        used.admit(end, address);
        silent.push(client);
    };
    for index in 0..16 {
        connect_silent(&server, [192, 0, 2, index / 4]);
    }
    // From a network of its own, and from one that has as many silent clients as it may.
    for address in [[192, 0, 2, 9], [192, 0, 2, 1]] {
        let mut client = server.connect(&server.token_file(), address).unwrap();
        assert_eq!(line(&mut *client).unwrap(), "data for type");
    }
    // Each of these has one, as the client that connects.
    for index in 20..60 {
        connect_silent(&server, [192, 0, 2, index]);
    }
    let mut client = server
        .connect(&server.token_file(), [192, 0, 2, 99])
        .unwrap();
    assert_eq!(line(&mut *client).unwrap(), "data for type");
    let in_progress = server.keeper.0.state().handshakes.len();
    assert!(in_progress <= 16, "{in_progress}");
}

#[test]
fn a_valid_token_resets_no_count_of_wrong_ones() {
    let server = Server::new();
    let see = tokens::create(&server.folder(), "screen", TokenRole::See).unwrap();
    let revoked = tokens::create(&server.folder(), "old", TokenRole::See).unwrap();
    let guess = server.folder().join("guess");
    std::fs::copy(revoked, &guess).unwrap();
    tokens::revoke(&server.folder(), "old").unwrap();
    let address = [192, 0, 2, 1];
    let mut refused = 0;
    for _ in 0..5 {
        refused += usize::from(server.connect(&guess, address).is_err());
        server.settle();
        // The fifth guess has closed the address for the valid token too.
        let valid = server.connect(&see, address);
        assert_eq!(valid.is_ok(), refused < 5, "after {refused} guesses");
        server.settle();
    }
    assert_eq!(refused, 5);
}

#[test]
fn what_a_client_has_sent_admits_no_one_who_sends_it_again() {
    let server = Server::new();
    let (client, near) = server.connection();
    let (far, end) = server.connection();
    server.admit(end, [192, 0, 2, 1]);
    let sent = thread::spawn(move || copy_both_ways(near, far));
    let mut stream = connect(client, &server.token_file()).unwrap();
    assert_eq!(line(&mut *stream).unwrap(), "data for type");
    drop(stream);
    drop(server.admitted.recv_timeout(TIMEOUT).unwrap());
    let sent = sent.join().unwrap();
    assert!(sent.len() > 200, "{} bytes", sent.len());
    let token = std::fs::read_to_string(server.token_file()).unwrap();
    let token = token.split_once("secret ").unwrap().1.trim().as_bytes();
    assert!(
        !sent.windows(8).any(|bytes| bytes == &token[..8]),
        "it is encrypted"
    );
    let (mut replay, replay_end) = server.connection();
    server.admit(replay_end, [192, 0, 2, 1]);
    replay.write_all(&sent).unwrap();
    let mut answer = Vec::new();
    let _ = replay.read_to_end(&mut answer);
    server.settle();
    assert!(server.admitted.try_recv().is_err(), "no one is admitted");
}

/// Copies between two connections until one of them ends. Returns the bytes from the first to the second.
fn copy_both_ways(near: TcpStream, far: TcpStream) -> Vec<u8> {
    let (mut near_reader, mut far_writer) = (near.try_clone().unwrap(), far.try_clone().unwrap());
    let back = thread::spawn(move || {
        let (mut far, mut near) = (far, near);
        let _ = io::copy(&mut far, &mut near);
    });
    let (mut sent, mut buffer) = (Vec::new(), [0; 4096]);
    while let Ok(length @ 1..) = near_reader.read(&mut buffer) {
        sent.extend(&buffer[..length]);
        if far_writer.write_all(&buffer[..length]).is_err() {
            break;
        }
    }
    let _ = far_writer.shutdown(Shutdown::Both);
    back.join().unwrap();
    sent
}

#[test]
fn a_server_with_another_certificate_receives_no_token() {
    let (server, imposter) = (Server::new(), Server::new());
    let (client, end) = imposter.connection();
    imposter.admit(end, [192, 0, 2, 1]);
    let error = connect(client, &server.token_file()).err().unwrap();
    assert!(
        matches!(error, SecureError::OtherCertificate { .. }),
        "{error}"
    );
    imposter.settle();
    let state = imposter.keeper.0.state();
    assert!(!state.tries.is_paused([192, 0, 2, 1].into(), Instant::now()));
    assert!(state.clients.is_empty());
}

#[test]
fn a_server_without_tokens_or_with_files_of_another_kind_does_not_start() {
    let folder = tempfile::tempdir().unwrap();
    let network = folder.path().join("network");
    let error = Gatekeeper::open(&network).unwrap_err().to_string();
    assert!(error.contains("ademan token new"), "{error}");
    tokens::create(&network, "desk", TokenRole::See).unwrap();
    std::fs::write(network.join("certificate.pem"), "none").unwrap();
    let certificate_error = Gatekeeper::open(&network).unwrap_err().to_string();
    assert!(
        certificate_error.contains("not a PEM file"),
        "{certificate_error}"
    );
    std::fs::write(network.join("tokens"), "desk see 1234").unwrap();
    let token_error = Gatekeeper::open(&network).unwrap_err().to_string();
    assert!(token_error.contains("line 1"), "{token_error}");
}

#[test]
fn a_server_of_pages_needs_a_token_that_points() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("network");
    tokens::create(&folder, "screen", TokenRole::See).unwrap();
    assert!(Gatekeeper::open(&folder).is_ok());
    let error = Gatekeeper::open_for_pages(&folder).unwrap_err().to_string();
    assert!(error.ends_with("token new NAME --role point"), "{error}");
    tokens::create(&folder, "headset", TokenRole::Point).unwrap();
    assert!(Gatekeeper::open_for_pages(&folder).is_ok());
}

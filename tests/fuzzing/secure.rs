//! Tokens, and the first bytes of clients of TLS.

use std::io::Read;
use std::net::TcpListener;
use std::path::PathBuf;
use std::sync::LazyLock;
use std::thread;

use ademan::network::{Gatekeeper, TokenRole, connect, tokens};
use tempfile::TempDir;

/// The settings of a server with one token.
struct Server {
    folder: TempDir,
    keeper: Gatekeeper,
}

impl Server {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join("network").join(name)
    }
}

static SERVER: LazyLock<Server> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder");
    let network = folder.path().join("network");
    tokens::create(&network, "desk", TokenRole::See).expect("a token");
    let keeper = Gatekeeper::open(&network).expect("there is a token");
    Server { folder, keeper }
});

/// Reads a token file, the list of a server, and the line of a client. Returns `true` if one of them is valid.
pub fn token(data: &[u8]) -> bool {
    let text = String::from_utf8_lossy(data);
    tokens::role_in(&text).is_some() | tokens::is_list(&text) | tokens::is_hello(data)
}

/// Returns the file and the list of a token, and the line of its client.
pub fn token_seeds() -> Vec<Vec<u8>> {
    let read = |name: &str| std::fs::read(SERVER.path(name)).expect("a file");
    let file = String::from_utf8(read("desk.token")).expect("a text");
    let secret = file.lines().find_map(|line| line.strip_prefix("secret "));
    let hello = format!("token {}\n", secret.expect("a secret"));
    vec![
        file.clone().into_bytes(),
        read("tokens"),
        hello.into_bytes(),
    ]
}

/// Begins a handshake with these bytes. Returns `true` if the server answers them with a handshake of its own.
pub fn handshake(data: &[u8]) -> bool {
    let answer = SERVER.keeper.answer(data);
    assert!(answer.len() < 1 << 14, "{} bytes", answer.len());
    answer.first() == Some(&22)
}

/// Returns the first bytes of a client.
pub fn handshake_seeds() -> Vec<Vec<u8>> {
    let port = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = port.local_addr().expect("its address");
    let file = SERVER.path("desk.token");
    let client = thread::spawn(move || {
        let stream = std::net::TcpStream::connect(address).expect("it listens");
        drop(connect(stream, &file));
    });
    let mut bytes = vec![0; 4096];
    let count = port
        .accept()
        .expect("a client")
        .0
        .read(&mut bytes)
        .expect("bytes");
    client.join().expect("no panic");
    bytes.truncate(count);
    vec![bytes]
}

//! A client of the spacenav protocol.

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

/// Longest time for anything on a busy machine.
pub const TIMEOUT: Duration = Duration::from_secs(60);

pub type Packet = [i32; 8];

pub struct Client(pub UnixStream);

impl Client {
    /// Connects with protocol version 0.
    pub fn connect(path: &Path) -> Self {
        let start = Instant::now();
        let stream = loop {
            match UnixStream::connect(path) {
                // The socket has its name a moment before the server listens.
                Err(error)
                    if error.kind() == ErrorKind::ConnectionRefused
                        && start.elapsed() < TIMEOUT =>
                {
                    thread::sleep(Duration::from_millis(10));
                }
                stream => break stream.expect("the server listens"),
            }
        };
        stream.set_read_timeout(Some(TIMEOUT)).expect("a socket");
        Self(stream)
    }

    /// Connects with protocol version 1.
    pub fn connect_version_1(path: &Path) -> Self {
        let mut client = Self::connect(path);
        client.send(&[0x7faa_5501]);
        assert_eq!(client.receive::<1>(), [0x7faa_5501]);
        client
    }

    pub fn send(&mut self, numbers: &[i32]) {
        let bytes: Vec<u8> = numbers
            .iter()
            .flat_map(|number| number.to_ne_bytes())
            .collect();
        self.0.write_all(&bytes).expect("the server reads");
    }

    pub fn receive<const COUNT: usize>(&mut self) -> [i32; COUNT] {
        [(); COUNT].map(|()| {
            let mut bytes = [0; 4];
            self.0.read_exact(&mut bytes).expect("the server sends");
            i32::from_ne_bytes(bytes)
        })
    }

    /// Sends a request of version 1 and returns the reply without its type: the value is first, the status last.
    pub fn request(&mut self, kind: i32, value: i32) -> [i32; 7] {
        let kind = 0x7faa_0000 | kind;
        self.send(&[kind, value, 0, 0, 0, 0, 0, 0]);
        let [reply_kind, data @ ..] = self.receive::<8>();
        assert_eq!(reply_kind, kind);
        data
    }

    /// Waits until the server has handled all requests of a client of version 0, by requesting version 0 again.
    pub fn sync(&mut self) {
        self.send(&[0x7faa_5500]);
        assert_eq!(self.receive::<1>(), [0x7faa_5500]);
    }

    /// Returns `true` if the server replies instead of disconnecting.
    pub fn is_accepted(&mut self) -> bool {
        let sent = self.0.write_all(&0x7faa_5500_i32.to_ne_bytes());
        sent.is_ok() && self.0.read_exact(&mut [0; 4]).is_ok()
    }

    /// Returns all packets until the server disconnects.
    pub fn read_to_end(mut self) -> Vec<Packet> {
        let mut bytes = Vec::new();
        match self.0.read_to_end(&mut bytes) {
            Err(error) if error.kind() != ErrorKind::ConnectionReset => panic!("{error}"),
            _ => {}
        }
        let numbers = bytes
            .as_chunks::<4>()
            .0
            .iter()
            .map(|word| i32::from_ne_bytes(*word));
        let numbers: Vec<i32> = numbers.collect();
        numbers.as_chunks::<8>().0.to_vec()
    }
}

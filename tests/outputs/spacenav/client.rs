//! A client in plain words: numbers over the socket.

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

/// How long anything on a busy machine may take before the test gives up.
pub const PATIENCE: Duration = Duration::from_secs(20);

pub type Packet = [i32; 8];

pub struct Client(pub UnixStream);

impl Client {
    /// One that says nothing at first: version 0.
    pub fn connect(path: &Path) -> Self {
        let stream = UnixStream::connect(path).expect("the server listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a socket");
        Self(stream)
    }

    /// One that has changed to version 1.
    pub fn of_version_1(path: &Path) -> Self {
        let mut client = Self::connect(path);
        client.say(&[0x7faa_5501]);
        assert_eq!(client.hear::<1>(), [0x7faa_5501]);
        client
    }

    pub fn say(&mut self, numbers: &[i32]) {
        let bytes: Vec<u8> = numbers
            .iter()
            .flat_map(|number| number.to_ne_bytes())
            .collect();
        self.0.write_all(&bytes).expect("the server hears");
    }

    pub fn hear<const COUNT: usize>(&mut self) -> [i32; COUNT] {
        [(); COUNT].map(|()| {
            let mut bytes = [0; 4];
            self.0
                .read_exact(&mut bytes)
                .expect("the server says something");
            i32::from_ne_bytes(bytes)
        })
    }

    /// The answer to a request of version 1, less its type: a value first, the status last.
    pub fn ask(&mut self, kind: i32, value: i32) -> [i32; 7] {
        let kind = 0x7faa_0000 | kind;
        self.say(&[kind, value, 0, 0, 0, 0, 0, 0]);
        let [answered, data @ ..] = self.hear::<8>();
        assert_eq!(answered, kind);
        data
    }

    /// Waits until the server has heard all that was said: a client of version 0 by changing to it again.
    pub fn settle(&mut self) {
        self.say(&[0x7faa_5500]);
        assert_eq!(self.hear::<1>(), [0x7faa_5500]);
    }

    /// Whether it is answered, and not sent away.
    pub fn is_welcome(&mut self) -> bool {
        let asked = self.0.write_all(&0x7faa_5500_i32.to_ne_bytes());
        asked.is_ok() && self.0.read_exact(&mut [0; 4]).is_ok()
    }

    /// Everything until the server goes away.
    pub fn rest(mut self) -> Vec<Packet> {
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

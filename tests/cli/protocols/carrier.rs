//! The transports that carry a stream to a program.

use std::io::Write;
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::path::Path;
use std::process::ChildStdin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use super::packets::Stream;
use crate::support::free_address::free_address;

/// Time between two packets.
const PERIOD: Duration = Duration::from_millis(5);

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carrier {
    File,
    Stdin,
    Tcp,
    Udp,
    WebSocket,
}

impl Carrier {
    const ALL: [Self; 5] = [
        Self::File,
        Self::Stdin,
        Self::Tcp,
        Self::Udp,
        Self::WebSocket,
    ];

    /// Returns the carriers of a stream.
    pub fn of(stream: &Stream) -> Vec<Self> {
        let carries = |carrier: &Self| match (carrier, stream.protocol()) {
            (Self::Udp, "bvh") => false,
            // Its messages are lines of text.
            (Self::WebSocket, protocol) => {
                !["hc11", "bvh"].contains(&protocol) && !stream.is_datagram
            }
            (Self::Udp, _) => true,
            _ => !stream.is_datagram,
        };
        Self::ALL.into_iter().filter(carries).collect()
    }
}

/// A stream that is sent until this is dropped.
pub struct Sender {
    /// The URI of the stream.
    pub source: String,
    is_over: Arc<AtomicBool>,
    /// Packets for the standard input of the program.
    packets: Option<Vec<Vec<u8>>>,
}

impl Drop for Sender {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
    }
}

impl Sender {
    /// Starts to send. A file is created in `folder`.
    pub fn start(stream: &Stream, carrier: Carrier, folder: &Path) -> Self {
        let format = &stream.format;
        let is_over = Arc::new(AtomicBool::new(false));
        let (over, packets) = (is_over.clone(), stream.packets.clone());
        let mut for_stdin = None;
        let source = match carrier {
            Carrier::File => {
                let path = folder.join("stream");
                std::fs::write(&path, packets.concat()).expect("a file");
                format!("file:{}?protocol={format}", path.display())
            }
            Carrier::Stdin => {
                for_stdin = Some(packets);
                format!("stdin:?protocol={format}")
            }
            Carrier::Tcp => {
                let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
                let address = listener.local_addr().expect("its address");
                thread::spawn(move || {
                    // A source that is only probed connects once more.
                    for mut client in listener.incoming().map_while(Result::ok) {
                        repeat(&packets, &over, |packet| client.write_all(packet).is_ok());
                    }
                });
                format!("tcp:{address}?protocol={format}")
            }
            Carrier::Udp => {
                let address = free_address();
                let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
                // The program may not listen yet.
                let send = move |packet: &[u8]| {
                    socket.send_to(packet, address).is_ok() || !packet.is_empty()
                };
                thread::spawn(move || repeat(&packets, &over, send));
                format!("udp:{address}?protocol={format}")
            }
            Carrier::WebSocket => {
                let address = free_address();
                thread::spawn(move || send_messages(&packets, &over, address));
                format!("ws:{address}?protocol={format}")
            }
        };
        Self {
            source,
            is_over,
            packets: for_stdin,
        }
    }

    /// Sends to the standard input of a program, if that carries the stream.
    pub fn feed(&mut self, mut stdin: ChildStdin) {
        if let Some(packets) = self.packets.take() {
            let over = self.is_over.clone();
            thread::spawn(move || {
                repeat(&packets, &over, |packet| stdin.write_all(packet).is_ok())
            });
        }
    }
}

/// Sends all packets, and the latest one over and over, until the end.
fn repeat(packets: &[Vec<u8>], over: &AtomicBool, mut send: impl FnMut(&[u8]) -> bool) {
    let is_file = packets.len() == 1;
    for packet in packets
        .iter()
        .chain(std::iter::repeat(&packets[packets.len() - 1]))
    {
        if over.load(Ordering::Relaxed) || !send(packet) {
            return;
        }
        thread::sleep(PERIOD);
        if is_file {
            // The program reads what was sent; a second file would follow the first one without an end.
            while !over.load(Ordering::Relaxed) {
                thread::sleep(PERIOD);
            }
        }
    }
}

fn send_messages(packets: &[Vec<u8>], over: &AtomicBool, address: SocketAddr) {
    while !over.load(Ordering::Relaxed) {
        let Ok(stream) = TcpStream::connect(address) else {
            thread::sleep(PERIOD);
            continue;
        };
        let Ok((mut socket, _)) = tungstenite::client(format!("ws://{address}/"), stream) else {
            continue;
        };
        repeat(packets, over, |packet| {
            let text = String::from_utf8_lossy(packet).into_owned();
            socket.send(tungstenite::Message::text(text)).is_ok()
        });
    }
}

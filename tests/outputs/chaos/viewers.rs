//! Clients of the shared hand that send frames without a request.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// The number that starves the other clients if the program answers each frame before it serves the next client.
const CLIENTS: usize = 2;

/// A pong with no content, and the first part of a message with no content; both are masked with zeros.
const FRAMES: [[u8; 6]; 2] = [[0x8a, 0x80, 0, 0, 0, 0], [0x01, 0x80, 0, 0, 0, 0]];

/// Clients that connect again when they are disconnected, until this is dropped.
pub struct Viewers {
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Viewers {
    /// Connects the clients.
    pub fn flood(server: SocketAddr) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let client = |index: usize| {
            let stop = Arc::clone(&stop);
            thread::spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    // The program may have exited, and may disconnect the client at any time.
                    let _ = send_frames(server, FRAMES[index % FRAMES.len()], &stop);
                    thread::sleep(Duration::from_millis(10));
                }
            })
        };
        let threads = (0..CLIENTS).map(client).collect();
        Self { stop, threads }
    }
}

impl Drop for Viewers {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Sends a frame until the server disconnects.
fn send_frames(server: SocketAddr, frame: [u8; 6], stop: &AtomicBool) -> std::io::Result<()> {
    let timeout = Some(Duration::from_millis(200));
    let mut stream = TcpStream::connect(server)?;
    stream.set_write_timeout(timeout)?;
    stream.set_read_timeout(timeout)?;
    write!(
        stream,
        "GET /ws HTTP/1.1\r\nHost: {server}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
        Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    )?;
    let _ = stream.read(&mut [0; 1024])?;
    let frames = frame.repeat(10_000);
    while !stop.load(Ordering::Relaxed) {
        stream.write_all(&frames)?;
    }
    Ok(())
}

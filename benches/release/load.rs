//! Load on the control socket.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

/// Number of clients.
const CLIENTS: usize = 12;

/// Clients that request the state continuously until this is dropped.
pub struct Load {
    is_stopped: Arc<AtomicBool>,
    clients: Vec<JoinHandle<()>>,
}

impl Load {
    /// Starts the clients on the control socket at this path.
    pub fn start(control: &Path) -> Self {
        let is_stopped = Arc::new(AtomicBool::new(false));
        let client = |_| {
            let stream = UnixStream::connect(control).expect("the program listens");
            let is_stopped = is_stopped.clone();
            thread::spawn(move || request_state(stream, &is_stopped))
        };
        Self {
            clients: (0..CLIENTS).map(client).collect(),
            is_stopped,
        }
    }
}

fn request_state(stream: UnixStream, is_stopped: &AtomicBool) {
    let mut replies = BufReader::new(stream);
    let mut line = String::new();
    while !is_stopped.load(Ordering::Relaxed) {
        let sent = replies.get_mut().write_all(b"{\"command\":\"state\"}\n");
        line.clear();
        if sent.is_err() || !matches!(replies.read_line(&mut line), Ok(1..)) {
            return;
        }
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        self.is_stopped.store(true, Ordering::Relaxed);
        for client in self.clients.drain(..) {
            let _ = client.join();
        }
    }
}

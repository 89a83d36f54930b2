//! Clients of the control socket that ask without a pause.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

/// How many ask at once.
const CLIENTS: usize = 12;

/// Clients that ask how the run is, again and again, until this is dropped.
pub struct Load {
    is_over: Arc<AtomicBool>,
    clients: Vec<JoinHandle<()>>,
}

impl Load {
    /// On the control socket at this path.
    pub fn start(control: &Path) -> Self {
        let is_over = Arc::new(AtomicBool::new(false));
        let client = |_| {
            let stream = UnixStream::connect(control).expect("the run listens");
            let is_over = is_over.clone();
            thread::spawn(move || ask(stream, &is_over))
        };
        Self {
            clients: (0..CLIENTS).map(client).collect(),
            is_over,
        }
    }
}

fn ask(stream: UnixStream, is_over: &AtomicBool) {
    let mut answers = BufReader::new(stream);
    let mut line = String::new();
    while !is_over.load(Ordering::Relaxed) {
        let asked = answers.get_mut().write_all(b"{\"ask\":\"state\"}\n");
        line.clear();
        if asked.is_err() || !matches!(answers.read_line(&mut line), Ok(1..)) {
            return;
        }
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        for client in self.clients.drain(..) {
            let _ = client.join();
        }
    }
}

//! Threads that accept connections.

use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crossbeam_channel::Sender;

use super::ShareError;
use crate::advice;
use crate::network::Stream;

/// Pause after a connection that could not be accepted, and the longest wait for the end of the thread.
const RETRY_INTERVAL: Duration = Duration::from_millis(50);

/// A connection to one of the servers.
pub(super) struct Connection {
    /// The index of the server.
    pub server: usize,
    /// Its bytes. No call blocks: without data or room, it fails with [`WouldBlock`](io::ErrorKind::WouldBlock).
    pub stream: Box<dyn Stream>,
}

/// A port at which a thread accepts connections, until this is dropped.
pub(super) struct Listener {
    address: SocketAddr,
    /// Tells the thread to end.
    is_closed: Arc<AtomicBool>,
}

impl Listener {
    /// Listens at an address, and sends the connections to it with the index of the server.
    pub fn start(
        server: usize,
        address: SocketAddr,
        connections: Sender<Connection>,
    ) -> Result<Self, ShareError> {
        let listen_error = |error| ShareError::Listen { address, error };
        let listener = TcpListener::bind(address).map_err(listen_error)?;
        let address = listener.local_addr().map_err(listen_error)?;
        let is_closed = Arc::new(AtomicBool::new(false));
        let closed = Arc::clone(&is_closed);
        let accept = move || {
            while let Some(stream) = accept(&listener, &closed) {
                if let Ok(stream) = open(stream)
                    && connections.send(Connection { server, stream }).is_err()
                {
                    return;
                }
            }
        };
        let thread = thread::Builder::new().name("share-accept".into());
        let spawned = thread.spawn(accept);
        spawned.map_err(|error| ShareError::NoThread(advice::no_thread(&error).to_string()))?;
        Ok(Self { address, is_closed })
    }

    /// Returns the address with the port.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::Release);
        // Wakes the thread.
        let _ = TcpStream::connect_timeout(&self.address, RETRY_INTERVAL);
    }
}

/// Waits for a connection. Returns `None` at the end.
fn accept(listener: &TcpListener, is_closed: &AtomicBool) -> Option<TcpStream> {
    loop {
        let accepted = listener.accept();
        if is_closed.load(Ordering::Acquire) {
            return None;
        }
        match accepted {
            Ok((stream, _)) => return Some(stream),
            // Out of descriptors, for instance.
            Err(_) => thread::sleep(RETRY_INTERVAL),
        }
    }
}

/// Prepares the stream of a connection.
fn open(stream: TcpStream) -> io::Result<Box<dyn Stream>> {
    stream.set_nonblocking(true)?;
    // Each line is the state of now.
    stream.set_nodelay(true)?;
    Ok(Box::new(stream))
}

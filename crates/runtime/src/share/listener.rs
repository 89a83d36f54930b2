//! Threads that accept connections.

use std::io;
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crossbeam_channel::Sender;

use super::ShareError;
use crate::advice;
use crate::network::{Gatekeeper, Stream};

/// Pause after a connection that could not be accepted, and the longest wait for the end of the thread.
const RETRY_INTERVAL: Duration = Duration::from_millis(50);

/// A connection to one of the servers.
pub(super) struct Connection {
    /// The index of the server.
    pub server: usize,
    /// The bytes. No call blocks: without data or room, it fails with [`WouldBlock`](io::ErrorKind::WouldBlock).
    pub stream: Box<dyn Stream>,
}

/// A thread that accepts connections at a port, until this is dropped.
pub(super) struct AcceptThread {
    address: SocketAddr,
    /// Tells the thread to end.
    is_closed: Arc<AtomicBool>,
}

impl AcceptThread {
    /// Passes each connection and the address of its client to `on_connection`, until it returns `Break`; `address` is the
    /// address of the listener.
    pub fn start(
        name: &str,
        listener: TcpListener,
        address: SocketAddr,
        mut on_connection: impl FnMut(TcpStream, SocketAddr) -> ControlFlow<()> + Send + 'static,
    ) -> Result<Self, ShareError> {
        let is_closed = Arc::new(AtomicBool::new(false));
        let closed = Arc::clone(&is_closed);
        let accept = move || {
            while let Some((stream, client)) = accept(&listener, &closed) {
                if on_connection(stream, client).is_break() {
                    return;
                }
            }
        };
        let spawned = thread::Builder::new().name(name.into()).spawn(accept);
        spawned.map_err(|error| ShareError::NoThread(advice::no_thread(&error).to_string()))?;
        Ok(Self { address, is_closed })
    }

    /// Returns the address with the port.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for AcceptThread {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::Release);
        // Wakes the thread.
        let _ = TcpStream::connect_timeout(&self.address, RETRY_INTERVAL);
    }
}

/// Listens at an address, and sends the connections with the index of the server. With a gatekeeper, only the connections that it
/// admits.
pub(super) fn listen(
    server: usize,
    address: SocketAddr,
    keeper: Option<Gatekeeper>,
    connections: Sender<Connection>,
) -> Result<AcceptThread, ShareError> {
    let listen_error = |error| ShareError::Listen { address, error };
    let listener = TcpListener::bind(address).map_err(listen_error)?;
    let bound = listener.local_addr().map_err(listen_error)?;
    AcceptThread::start("share-accept", listener, bound, move |stream, client| {
        if let Some(keeper) = &keeper {
            admit(keeper, stream, client.ip(), server, &connections);
        } else if let Ok(stream) = open(stream)
            && connections.send(Connection { server, stream }).is_err()
        {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    })
}

/// Waits for a connection. Returns `None` at the end.
fn accept(listener: &TcpListener, is_closed: &AtomicBool) -> Option<(TcpStream, SocketAddr)> {
    loop {
        let accepted = listener.accept();
        if is_closed.load(Ordering::Acquire) {
            return None;
        }
        match accepted {
            Ok(connection) => return Some(connection),
            // Out of descriptors, for instance.
            Err(_) => thread::sleep(RETRY_INTERVAL),
        }
    }
}

/// Sends a connection once its client has shown a token, on another thread.
fn admit(
    keeper: &Gatekeeper,
    stream: TcpStream,
    client: IpAddr,
    server: usize,
    connections: &Sender<Connection>,
) {
    let connections = connections.clone();
    keeper.admit(stream, client, move |admitted| {
        let name = &admitted.token.name;
        tracing::info!("a client at {client} has connected with the token {name}");
        if admitted.stream.set_nonblocking(true).is_ok() {
            let admitted_stream = admitted.stream;
            let _ = connections.send(Connection {
                server,
                stream: admitted_stream,
            });
        }
    });
}

/// Prepares the stream of a connection.
fn open(stream: TcpStream) -> io::Result<Box<dyn Stream>> {
    stream.set_nonblocking(true)?;
    // Each line is the state of now.
    stream.set_nodelay(true)?;
    Ok(Box::new(stream))
}

//! The server: a thread that accepts connections, and one for each of them. One client is read at a time.

use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, bounded};
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::StatusCode;
use tungstenite::{WebSocket, accept_hdr_with_config};

use super::MessageServer;
use super::admission::Admission;
use super::clients::{ClientId, Clients};
use super::message_stream::MessageStream;
use super::receive::{
    ClientEvent, MessageReceiver, QUEUE_CAPACITY, send_when_there_is_room, socket_config,
};
use crate::network::{DeadlineStream, canonical};

/// Longest time that a client may take for its request.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(2);

/// Longest time after which a client, and the end of the source, are noticed.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Pause before something is tried again that other threads make possible.
const RETRY_INTERVAL: Duration = Duration::from_millis(1);

/// A server on threads of its own, which end when it is dropped.
pub(super) struct Server {
    events: Receiver<ClientEvent>,
    shared: Arc<Shared>,
}

struct Shared {
    admission: Admission,
    sender: Sender<ClientEvent>,
    clients: Clients,
    is_stopped: AtomicBool,
}

impl Server {
    /// Binds an address and starts to accept connections.
    pub fn start(address: SocketAddr, origin: Option<String>) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let bound = canonical(listener.local_addr()?);
        let (sender, events) = bounded(QUEUE_CAPACITY);
        let shared = Arc::new(Shared {
            admission: Admission {
                address: bound,
                origins: origin.into_iter().collect(),
                remedy: "write `origin=` with this address in the source to admit it",
            },
            sender,
            clients: Clients::default(),
            is_stopped: AtomicBool::new(false),
        });
        let accepting = Arc::clone(&shared);
        thread::Builder::new()
            .name("websocket".to_owned())
            .spawn(move || accept(&accepting, &listener))?;
        Ok(Self { events, shared })
    }

    fn address(&self) -> SocketAddr {
        self.shared.admission.address
    }
}

impl MessageServer for Server {
    fn events(&self) -> &Receiver<ClientEvent> {
        &self.events
    }

    fn clients(&self) -> &Clients {
        &self.shared.clients
    }

    fn name(&self) -> String {
        format!("ws:{}", self.address())
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.shared.is_stopped.store(true, Ordering::Release);
        self.shared.clients.disconnect_all();
        // Ends the wait for a connection. If it fails, the thread waits for the next one.
        let _ = TcpStream::connect_timeout(&self.address(), POLL_INTERVAL);
    }
}

/// Accepts connections until the end of the server. Each is served by a thread of its own, so that none waits for another.
fn accept(shared: &Arc<Shared>, listener: &TcpListener) {
    while !shared.is_stopped() {
        if shared.clients.are_too_many() {
            thread::sleep(RETRY_INTERVAL);
            continue;
        }
        let Ok((stream, _)) = listener.accept() else {
            // Out of file descriptors, for example: they may become free.
            thread::sleep(POLL_INTERVAL);
            continue;
        };
        let stream = Arc::new(stream);
        let Some(id) = shared.clients.add(&stream) else {
            continue;
        };
        let client = Client {
            shared: Arc::clone(shared),
            id,
        };
        // Without a thread the connection is closed.
        let _ = thread::Builder::new()
            .name("websocket".to_owned())
            .spawn(move || client.serve(stream));
    }
}

impl Shared {
    fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Acquire)
    }
}

/// A connection, which counts until it is dropped.
struct Client {
    shared: Arc<Shared>,
    id: ClientId,
}

impl Drop for Client {
    fn drop(&mut self) {
        self.shared.clients.remove(self.id);
    }
}

impl Client {
    fn serve(self, stream: Arc<TcpStream>) {
        let Some(socket) = self.admit(stream) else {
            return;
        };
        tracing::info!(
            "a client has connected to ws:{}",
            self.shared.admission.address
        );
        let mut receiver = MessageReceiver::new(socket);
        let is_stopped = || self.shared.is_stopped();
        let reason = receiver.receive(is_stopped, |line| {
            self.send(ClientEvent::Message(self.id, line))
        });
        // Not sent for one that made room for another, with which nothing is lost.
        self.send(ClientEvent::Left(self.id, reason));
    }

    /// Performs the handshake.
    fn admit(&self, stream: Arc<TcpStream>) -> Option<WebSocket<MessageStream<DeadlineStream>>> {
        let stream = DeadlineStream::new(stream, HANDSHAKE_TIMEOUT).ok()?;
        let stream = MessageStream::new(stream);
        let admission = &self.shared.admission;
        #[allow(clippy::result_large_err, reason = "the library requires the type")]
        let check = |request: &Request, response: Response| match admission.check(request) {
            Ok(()) => Ok(response),
            Err(reason) => {
                tracing::warn!("refused a client of ws:{}: {reason}", admission.address);
                let mut refusal = ErrorResponse::new(Some(reason));
                *refusal.status_mut() = StatusCode::FORBIDDEN;
                Err(refusal)
            }
        };
        let mut socket = accept_hdr_with_config(stream, check, Some(socket_config())).ok()?;
        let message_stream = socket.get_mut().stream_mut();
        message_stream.end_deadline(POLL_INTERVAL).ok()?;
        Some(socket)
    }

    fn send(&self, event: ClientEvent) -> bool {
        let is_open = || !self.shared.is_stopped() && self.shared.clients.is_connected(self.id);
        send_when_there_is_room(&self.shared.sender, event, is_open)
    }
}

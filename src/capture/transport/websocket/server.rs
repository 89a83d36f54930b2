//! The server: a thread that accepts connections, and one for each of them. One client is read at a time.

use std::io::{self, ErrorKind};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::StatusCode;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket, accept_hdr_with_config};

use super::admission::Admission;
use super::clients::{ClientId, Clients};
use super::message_stream::MessageStream;
use crate::network::{DeadlineStream, canonical};

/// Longest message: no protocol has longer lines.
const MAX_MESSAGE_BYTES: usize = 1 << 16;

/// Most frames in a second, of whatever kind: twice the messages of the fastest glove. A client that sends more is
/// disconnected.
const MAX_FRAMES_PER_SECOND: u32 = 2000;

/// Longest time that a client may take for its request.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(2);

/// Longest time after which a client, and the end of the source, are noticed.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Pause before something is tried again that other threads make possible.
const RETRY_INTERVAL: Duration = Duration::from_millis(1);

/// Messages that wait for the source. A client that is faster waits.
const QUEUE_CAPACITY: usize = 64;

/// Event of a client.
#[derive(Debug)]
pub(super) enum ClientEvent {
    /// A message, with a line end.
    Message(ClientId, Vec<u8>),
    /// A client that was admitted has left, for this reason.
    Left(ClientId, String),
}

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
        let address = canonical(listener.local_addr()?);
        let (sender, events) = bounded(QUEUE_CAPACITY);
        let shared = Arc::new(Shared {
            admission: Admission {
                address,
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

    /// Returns the channel of events.
    pub fn events(&self) -> &Receiver<ClientEvent> {
        &self.events
    }

    /// Returns the clients.
    pub fn clients(&self) -> &Clients {
        &self.shared.clients
    }

    /// Returns the address with the port.
    pub fn address(&self) -> SocketAddr {
        self.shared.admission.address
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.shared.is_stopped.store(true, Ordering::Release);
        self.shared.clients.disconnect_all();
        // Ends the wait for a connection. If it fails, the thread waits for the next one.
        let _ = TcpStream::connect(self.address());
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
        let reason = self.receive(socket);
        // Not sent for one that made room for another, with which nothing is lost.
        self.send(ClientEvent::Left(self.id, reason));
    }

    /// Performs the handshake.
    fn admit(&self, stream: Arc<TcpStream>) -> Option<WebSocket<MessageStream>> {
        let stream = DeadlineStream::new(stream, HANDSHAKE_TIMEOUT).ok()?;
        let stream = MessageStream::new(stream);
        let config = WebSocketConfig::default()
            // A client that reads no answers to its pings is disconnected.
            .write_buffer_size(0)
            .max_write_buffer_size(MAX_MESSAGE_BYTES)
            .max_message_size(Some(MAX_MESSAGE_BYTES))
            .max_frame_size(Some(MAX_MESSAGE_BYTES));
        let admission = &self.shared.admission;
        #[allow(clippy::result_large_err, reason = "the type is that of the library")]
        let check = |request: &Request, response: Response| match admission.check(request) {
            Ok(()) => Ok(response),
            Err(reason) => {
                tracing::warn!("refused a client of ws:{}: {reason}", admission.address);
                let mut refusal = ErrorResponse::new(Some(reason));
                *refusal.status_mut() = StatusCode::FORBIDDEN;
                Err(refusal)
            }
        };
        let mut socket = accept_hdr_with_config(stream, check, Some(config)).ok()?;
        socket.get_mut().end_deadline(POLL_INTERVAL).ok()?;
        Some(socket)
    }

    /// Passes on the messages. Returns the reason why the client has left.
    fn receive(&self, mut socket: WebSocket<MessageStream>) -> String {
        let (mut second, mut frames) = (Instant::now(), 0);
        while !self.shared.is_stopped() {
            let message = match socket.read() {
                Ok(message) => message,
                Err(tungstenite::Error::Io(error)) if is_timeout(&error) => continue,
                Err(tungstenite::Error::ConnectionClosed) => {
                    return "the client has closed the connection".to_owned();
                }
                Err(error) => return error.to_string(),
            };
            socket.get_mut().end_message();
            if second.elapsed() >= Duration::from_secs(1) {
                (second, frames) = (Instant::now(), 0);
            }
            frames += 1;
            if frames > MAX_FRAMES_PER_SECOND {
                return format!(
                    "the client sent more than {MAX_FRAMES_PER_SECOND} frames in a second"
                );
            }
            match message {
                Message::Text(text) => {
                    let mut line = Vec::from(text.as_bytes());
                    if !line.ends_with(b"\n") {
                        line.push(b'\n');
                    }
                    if !self.send(ClientEvent::Message(self.id, line)) {
                        break;
                    }
                }
                Message::Binary(_) => {
                    return "the client sent a binary message; lines are text messages".to_owned();
                }
                _ => {}
            }
        }
        "the server stops".to_owned()
    }

    /// Sends an event, and waits for room. Returns `false` if the server or the client has ended.
    fn send(&self, mut event: ClientEvent) -> bool {
        while !self.shared.is_stopped() && self.shared.clients.is_connected(self.id) {
            match self.shared.sender.try_send(event) {
                Ok(()) => return true,
                Err(TrySendError::Full(back)) => event = back,
                Err(TrySendError::Disconnected(_)) => return false,
            }
            thread::sleep(RETRY_INTERVAL);
        }
        false
    }
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

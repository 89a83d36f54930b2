//! The thread of the server: one client at a time.

use std::io::{self, ErrorKind};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::StatusCode;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket, accept_hdr_with_config};

use super::admission::Admission;
use crate::network::DeadlineStream;

/// Longest message: no protocol has longer lines.
const MAX_MESSAGE_BYTES: usize = 1 << 16;

/// Most messages in a second: twice those of the fastest glove. A client that sends more is disconnected.
const MAX_MESSAGES_PER_SECOND: u32 = 2000;

/// Longest time that a client may take for its request.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(2);

/// Longest time after which a client, and the end of the source, are noticed.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Messages that wait for the source. A client that is faster waits.
const QUEUE_CAPACITY: usize = 64;

/// Event of a client.
#[derive(Debug)]
pub(super) enum ClientEvent {
    /// A message, with a line end.
    Message(Vec<u8>),
    /// The client has left, for this reason.
    Lost(String),
}

/// A server on its own thread, which ends when it is dropped.
pub(super) struct Server {
    events: Receiver<ClientEvent>,
    address: SocketAddr,
    is_stopped: Arc<AtomicBool>,
}

impl Server {
    /// Binds an address and starts the thread.
    pub fn start(address: &str, origin: Option<String>) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let address = listener.local_addr()?;
        let (sender, events) = bounded(QUEUE_CAPACITY);
        let is_stopped = Arc::new(AtomicBool::new(false));
        let clients = Clients {
            admission: Admission {
                address,
                origins: origin.into_iter().collect(),
                remedy: "write `origin=` with this address in the source to admit it",
            },
            sender,
            is_stopped: Arc::clone(&is_stopped),
        };
        std::thread::Builder::new()
            .name("websocket".to_owned())
            .spawn(move || clients.serve(&listener))?;
        Ok(Self {
            events,
            address,
            is_stopped,
        })
    }

    /// Returns the channel of events.
    pub fn events(&self) -> &Receiver<ClientEvent> {
        &self.events
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.is_stopped.store(true, Ordering::Relaxed);
        // Ends the wait for a client. If it fails, the thread waits for the next one.
        let _ = TcpStream::connect(self.address);
    }
}

/// The clients of a server.
struct Clients {
    admission: Admission,
    sender: Sender<ClientEvent>,
    is_stopped: Arc<AtomicBool>,
}

impl Clients {
    fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    fn serve(&self, listener: &TcpListener) {
        while !self.is_stopped() {
            let Ok((stream, _)) = listener.accept() else {
                // Out of file descriptors, for example: they may become free.
                std::thread::sleep(POLL_INTERVAL);
                continue;
            };
            let Some(socket) = self.admit(stream) else {
                continue;
            };
            tracing::info!("a client has connected to ws:{}", self.admission.address);
            let reason = self.receive(socket, listener);
            if !self.send(ClientEvent::Lost(reason)) {
                return;
            }
        }
    }

    /// Performs the handshake.
    fn admit(&self, stream: TcpStream) -> Option<WebSocket<DeadlineStream>> {
        let stream = DeadlineStream::new(Arc::new(stream), HANDSHAKE_TIMEOUT).ok()?;
        let config = WebSocketConfig::default()
            .max_message_size(Some(MAX_MESSAGE_BYTES))
            .max_frame_size(Some(MAX_MESSAGE_BYTES));
        #[allow(clippy::result_large_err, reason = "the type is that of the library")]
        let check = |request: &Request, response: Response| match self.admission.check(request) {
            Ok(()) => Ok(response),
            Err(reason) => {
                tracing::warn!(
                    "refused a client of ws:{}: {reason}",
                    self.admission.address
                );
                let mut refusal = ErrorResponse::new(Some(reason));
                *refusal.status_mut() = StatusCode::FORBIDDEN;
                Err(refusal)
            }
        };
        let mut socket = accept_hdr_with_config(stream, check, Some(config)).ok()?;
        socket.get_mut().end_deadline(POLL_INTERVAL).ok()?;
        Some(socket)
    }

    /// Passes on the messages of a client. Returns the reason why it has left.
    fn receive(&self, mut socket: WebSocket<DeadlineStream>, listener: &TcpListener) -> String {
        let (mut second, mut messages) = (Instant::now(), 0);
        while !self.is_stopped() {
            refuse_others(listener);
            match socket.read() {
                Ok(Message::Text(text)) => {
                    if second.elapsed() >= Duration::from_secs(1) {
                        (second, messages) = (Instant::now(), 0);
                    }
                    messages += 1;
                    if messages > MAX_MESSAGES_PER_SECOND {
                        return format!(
                            "the client sent more than {MAX_MESSAGES_PER_SECOND} messages in a second"
                        );
                    }
                    let mut line = Vec::from(text.as_bytes());
                    if !line.ends_with(b"\n") {
                        line.push(b'\n');
                    }
                    if !self.send(ClientEvent::Message(line)) {
                        break;
                    }
                }
                Ok(Message::Binary(_)) => {
                    return "the client sent a binary message; lines are text messages".to_owned();
                }
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if is_timeout(&error) => {}
                Err(tungstenite::Error::ConnectionClosed) => {
                    return "the client has closed the connection".to_owned();
                }
                Err(error) => return error.to_string(),
            }
        }
        "the server stops".to_owned()
    }

    /// Sends an event, and waits for room. Returns `false` at the end of the server.
    fn send(&self, mut event: ClientEvent) -> bool {
        while !self.is_stopped() {
            match self.sender.try_send(event) {
                Ok(()) => return true,
                Err(TrySendError::Full(back)) => event = back,
                Err(TrySendError::Disconnected(_)) => return false,
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        false
    }
}

/// Closes connections that others try to open meanwhile.
fn refuse_others(listener: &TcpListener) {
    if listener.set_nonblocking(true).is_ok() {
        while listener.accept().is_ok() {}
    }
    // Fails only where the first call has failed.
    let _ = listener.set_nonblocking(false);
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

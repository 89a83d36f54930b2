//! WebSocket server, for trackers that run in a browser: each text message is one or more lines.
//!
//! A page of any site can open a WebSocket to this machine. A client is therefore admitted only if its request names this
//! address (`Host`), and if it comes from no page or from the page that the option `origin` names (`Origin`).
//!
//! One client is read at a time. The first one that sends a valid packet is, until it leaves or has sent none for 2 s. Until
//! then others may connect, so that a client that says nothing keeps no other one out.

mod admission;
mod clients;
mod message_stream;
mod receive;
mod server;

pub(crate) use admission::Admission;

use std::io::{Error, ErrorKind, Read, Result};
use std::net::TcpListener;
use std::sync::Arc;
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError};

pub(super) use self::clients::{ClientId, Clients};
#[cfg(feature = "tls")]
pub(super) use self::message_stream::MessageStream;
pub(super) use self::receive::ClientEvent;
#[cfg(feature = "tls")]
pub(super) use self::receive::{
    MessageReceiver, QUEUE_CAPACITY, send_when_there_is_room, socket_config,
};
use self::server::Server;
use super::{LISTEN_REMEDY, Scheme, Transport, check_socket_address, listen_remedy, open_stream};
use crate::capture::connection::{
    ByteStream, ConnectError, Connection, Connector, READ_TIMEOUT, UNKNOWN_SENDER,
};
use crate::network::parse_loopback;

/// The `ws` transport.
pub const TRANSPORT: Transport = Transport {
    scheme: SCHEME,
    is_remote: true,
    is_datagram: false,
    needs_token: false,
    is_device: false,
    has_address: true,
    default_baud: None,
    probe: Some(|address| {
        let bound = TcpListener::bind(address);
        bound
            .map(drop)
            .map_err(|error| format!("{error}; {}", listen_remedy(&error)))
    }),
    check_address,
    open: |uri| {
        let connector = WebSocketConnector {
            address: uri.address.clone(),
            origin: uri.origin.clone(),
            server: None,
        };
        open_stream(uri, connector)
    },
};

const SCHEME: Scheme = Scheme {
    name: "ws",
    syntax: "ws:ADDRESS:PORT",
    summary: "WebSocket server for a program or a page on this machine",
    example: "ws:127.0.0.1:9001?protocol=hand-landmarks",
};

/// Checks that the address is one of this machine that no other machine can connect to: the connection is not encrypted.
fn check_address(address: &str) -> std::result::Result<(), String> {
    check_socket_address(SCHEME, address)?;
    match parse_loopback(address) {
        Some(_) => Ok(()),
        None => Err(
            "a WebSocket is not encrypted, so `ws` serves this machine only: write `ws:127.0.0.1:PORT` and forward the \
             data through a tunnel such as `ssh -L`, or let the other machine share its hand with `+tls`"
                .to_owned(),
        ),
    }
}

/// Starter of the server, which outlives the clients that come and go.
#[derive(Clone)]
struct WebSocketConnector {
    address: String,
    origin: Option<String>,
    server: Option<Arc<Server>>,
}

impl Connector for WebSocketConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;
    const HAS_SENDERS: bool = true;
    const FIRST_BYTE_TIMEOUT: Option<Duration> = Some(Duration::from_secs(5));

    fn connect(&mut self) -> std::result::Result<Connection, ConnectError> {
        let server = match &self.server {
            Some(server) => Arc::clone(server),
            None => {
                let address = parse_loopback(&self.address);
                let address =
                    address.ok_or_else(|| ConnectError::Absent(LISTEN_REMEDY.to_owned()))?;
                let started = Server::start(address, self.origin.clone());
                let server = Arc::new(started.map_err(|error| {
                    ConnectError::Absent(format!("{error}; {}", listen_remedy(&error)))
                })?);
                Arc::clone(self.server.insert(server))
            }
        };
        Ok(Connection {
            bytes: Box::new(Messages::new(server)),
            readiness: None,
            endpoint: self.address.clone(),
        })
    }
}

/// A server whose clients send lines as messages.
pub(super) trait MessageServer: Send + Sync {
    /// Returns the channel of events.
    fn events(&self) -> &Receiver<ClientEvent>;

    /// Returns the clients.
    fn clients(&self) -> &Clients;

    /// Returns the name in messages.
    fn name(&self) -> String;
}

/// Reader of the messages of one client after the other.
pub(super) struct Messages {
    server: Arc<dyn MessageServer>,
    /// The sender of the message.
    client: ClientId,
    message: Vec<u8>,
    /// Bytes of the message that were read.
    read: usize,
}

impl ByteStream for Messages {
    fn take_sender_change(&mut self) -> bool {
        self.server.clients().take_change()
    }

    fn accept_sender(&mut self) -> bool {
        self.server.clients().accept()
    }
}

impl Messages {
    /// Creates the reader of the clients of a server.
    pub fn new(server: Arc<dyn MessageServer>) -> Self {
        Self {
            server,
            client: 0,
            message: Vec::new(),
            read: 0,
        }
    }

    /// Waits for a message. The end of the active client is the error of a lost connection.
    fn next_message(&mut self) -> Result<()> {
        (self.read, self.message) = (0, Vec::new());
        let clients = self.server.clients();
        match self.server.events().recv_timeout(READ_TIMEOUT) {
            Ok(ClientEvent::Message(client, message)) => {
                (self.client, self.message) = (client, message);
                Ok(())
            }
            Ok(ClientEvent::Left(client, reason)) if clients.leave(client) => {
                Err(Error::new(ErrorKind::ConnectionAborted, reason))
            }
            Ok(ClientEvent::Left(_, reason)) => {
                let name = self.server.name();
                tracing::warn!("a client of {name} has left without a valid packet: {reason}");
                Err(Error::from(ErrorKind::WouldBlock))
            }
            Err(RecvTimeoutError::Timeout) => Err(Error::from(ErrorKind::WouldBlock)),
            Err(RecvTimeoutError::Disconnected) => {
                Err(Error::other("the thread of the server has ended"))
            }
        }
    }
}

impl Read for Messages {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        if self.read == self.message.len() {
            self.next_message()?;
        }
        if !self.server.clients().read_from(self.client) {
            self.read = self.message.len();
            return Err(Error::from(UNKNOWN_SENDER));
        }
        let rest = &self.message[self.read..];
        let length = rest.len().min(buffer.len());
        buffer[..length].copy_from_slice(&rest[..length]);
        self.read += length;
        Ok(length)
    }
}

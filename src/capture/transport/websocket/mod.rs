//! WebSocket server, for trackers that run in a browser: each text message is one or more lines.
//!
//! A page of any site can open a WebSocket to this machine. A client is therefore admitted only if its request names this
//! address (`Host`), and if it comes from no page or from the page that the option `origin` names (`Origin`).

mod admission;
mod server;

pub(crate) use admission::Admission;

use std::io::{Error, ErrorKind, Read, Result};
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;

use crossbeam_channel::RecvTimeoutError;

use self::server::{ClientEvent, Server};
use super::{Scheme, Transport, check_socket_address, open_stream};
use crate::capture::connection::{ByteStream, ConnectError, Connection, Connector, READ_TIMEOUT};

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
            .map_err(|error| format!("{error}; {REMEDY}"))
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

const REMEDY: &str = "use 127.0.0.1 and a free port";

/// Checks that the address is one of this machine that no other machine can connect to: the connection is not encrypted.
fn check_address(address: &str) -> std::result::Result<(), String> {
    check_socket_address(SCHEME, address)?;
    let is_loopback = address
        .parse::<SocketAddr>()
        .is_ok_and(|address| address.ip().is_loopback());
    match is_loopback {
        true => Ok(()),
        false => Err(
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

    fn connect(&mut self) -> std::result::Result<Connection, ConnectError> {
        let server = match &self.server {
            Some(server) => Arc::clone(server),
            None => {
                let started = Server::start(&self.address, self.origin.clone());
                let server = Arc::new(
                    started.map_err(|error| ConnectError::Absent(format!("{error}; {REMEDY}")))?,
                );
                Arc::clone(self.server.insert(server))
            }
        };
        Ok(Connection {
            bytes: Box::new(Messages {
                server,
                message: Vec::new(),
                read: 0,
            }),
            readiness: None,
            endpoint: self.address.clone(),
        })
    }
}

/// Reader of the messages of one client after the other.
struct Messages {
    server: Arc<Server>,
    message: Vec<u8>,
    /// Bytes of the message that were read.
    read: usize,
}

impl ByteStream for Messages {}

impl Read for Messages {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        if self.read == self.message.len() {
            self.read = 0;
            self.message = match self.server.events().recv_timeout(READ_TIMEOUT) {
                Ok(ClientEvent::Message(message)) => message,
                Ok(ClientEvent::Lost(reason)) => {
                    self.message.clear();
                    return Err(Error::new(ErrorKind::ConnectionAborted, reason));
                }
                Err(RecvTimeoutError::Timeout) => {
                    self.message.clear();
                    return Err(Error::from(ErrorKind::WouldBlock));
                }
                Err(RecvTimeoutError::Disconnected) => {
                    let text = "the thread of the server has ended";
                    return Err(Error::other(text));
                }
            };
        }
        let rest = &self.message[self.read..];
        let length = rest.len().min(buffer.len());
        buffer[..length].copy_from_slice(&rest[..length]);
        self.read += length;
        Ok(length)
    }
}

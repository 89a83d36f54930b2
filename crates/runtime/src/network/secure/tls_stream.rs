//! A TLS connection over TCP.

use std::io;

use rustls::{ClientConnection, ServerConnection, StreamOwned};

use crate::network::{DeadlineStream, Stream};

/// The end of a server.
pub type ServerStream = StreamOwned<ServerConnection, DeadlineStream>;

/// The end of a client.
pub type ClientStream = StreamOwned<ClientConnection, DeadlineStream>;

impl Stream for ServerStream {
    fn set_nonblocking(&self, is_nonblocking: bool) -> io::Result<()> {
        self.sock.set_nonblocking(is_nonblocking)
    }
}

impl Stream for ClientStream {
    fn set_nonblocking(&self, is_nonblocking: bool) -> io::Result<()> {
        self.sock.set_nonblocking(is_nonblocking)
    }
}

//! Clients that show their token after the handshake of TLS, as a page in a browser does.

use std::io;
use std::net::{IpAddr, TcpStream};
use std::sync::Arc;
use std::thread;

use rustls::{ServerConnection, StreamOwned};

use super::{Gatekeeper, HANDSHAKE_TIMEOUT, Handshake};
use crate::network::secure::tls_stream::ServerStream;
use crate::network::secure::token::Token;
use crate::network::{DeadlineStream, TokenEntry};

/// A connection after the handshake of TLS whose client has shown no token. It counts as a handshake until it is dropped.
pub struct Unproven(Handshake);

impl Gatekeeper {
    /// Performs the handshake of TLS with a client on a thread of its own, which `serve` then has, or closes the connection. Does
    /// not wait. All reads until the end of the deadline of the stream take 5 s at most.
    pub(crate) fn secure(
        &self,
        stream: TcpStream,
        address: IpAddr,
        serve: impl FnOnce(Unproven, ServerStream) + Send + 'static,
    ) {
        let Some(handshake) = Handshake::begin(self.0.clone(), stream, address) else {
            return;
        };
        // Without a thread the connection is closed.
        let _ = thread::Builder::new()
            .name("handshake".into())
            .spawn(move || match secured(&handshake) {
                Ok(secured_stream) => serve(Unproven(handshake), secured_stream),
                Err(error) => tracing::debug!("a handshake has failed: {error}"),
            });
    }
}

fn secured(handshake: &Handshake) -> io::Result<ServerStream> {
    handshake.socket.set_nonblocking(false)?;
    let socket = DeadlineStream::new(handshake.socket.clone(), HANDSHAKE_TIMEOUT)?;
    let connection = ServerConnection::new(handshake.shared.config.clone());
    let connection = connection.map_err(io::Error::other)?;
    let mut stream = StreamOwned::new(connection, socket);
    while stream.conn.is_handshaking() {
        stream.conn.complete_io(&mut stream.sock)?;
    }
    Ok(stream)
}

impl Unproven {
    /// Returns the address of the client.
    pub fn address(&self) -> IpAddr {
        self.0.address
    }

    /// Returns the socket, by which the connection is ended from outside.
    pub fn socket(&self) -> Arc<TcpStream> {
        Arc::clone(&self.0.socket)
    }

    /// Checks the digits of a token. A wrong one returns `None` and counts; the client of a valid one is disconnected once it is
    /// revoked.
    pub fn prove(&self, digits: &str) -> io::Result<Option<TokenEntry>> {
        let Some((hash, entry)) = self.0.find(Token::from_hex(digits).as_ref())? else {
            return Ok(None);
        };
        self.0.register(hash);
        Ok(Some(entry))
    }
}

//! TCP client with TLS and a token, for the shared hand of another machine.

use std::time::Duration;

use super::{Scheme, Transport, check_socket_address, open_stream, tcp};
use crate::capture::connection::{ByteStream, ConnectError, Connection, Connector};
use crate::network::{self, SecureError};

/// The `tcp+tls` transport.
pub const TRANSPORT: Transport = Transport {
    scheme: SCHEME,
    is_remote: true,
    is_datagram: false,
    needs_token: true,
    is_device: true,
    has_address: true,
    default_baud: None,
    // The handshake would count as a try with a token.
    probe: Some(|address| {
        if !network::HAS_TLS {
            return Err(network::NetworkError::NoTls.to_string());
        }
        let connected = tcp::connect(address);
        connected
            .map(drop)
            .map_err(|error| format!("no connection: {error}; {}", tcp::REMEDY))
    }),
    check_address: |address| check_socket_address(SCHEME, address),
    open: |uri| {
        let connector = SecureConnector {
            address: uri.address.clone(),
            token_file: uri.token_file.clone().unwrap_or_default(),
        };
        open_stream(uri, connector)
    },
};

const SCHEME: Scheme = Scheme {
    name: "tcp+tls",
    syntax: "tcp+tls:HOST:PORT",
    summary: "server of another machine, with TLS and a token (`--share FORMAT+tls:…`)",
    example: "tcp+tls:192.168.1.7:10002?protocol=text-line&token_file=desk.token",
};

/// Connector to a TCP server that knows a token.
#[derive(Clone)]
struct SecureConnector {
    address: String,
    token_file: String,
}

/// A shared hand takes no feedback.
impl ByteStream for Box<dyn network::Stream> {}

impl Connector for SecureConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;

    /// As of a TCP server without TLS.
    const IDLE_TIMEOUT: Option<Duration> = Some(Duration::from_secs(5));

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let stream = tcp::connect(&self.address)
            .map_err(|error| ConnectError::Absent(format!("{error}; {}", tcp::REMEDY)))?;
        let token_file = network::token_path(&self.token_file)
            .map_err(|error| ConnectError::Unusable(error.to_string()))?;
        let secured = network::connect(stream, &token_file);
        let secured_stream = secured.map_err(|error| match error {
            SecureError::Connection(_) => ConnectError::Absent(error.to_string()),
            error => ConnectError::Unusable(error.to_string()),
        })?;
        Ok(Connection {
            bytes: Box::new(secured_stream),
            // Bytes may have been decrypted that were not read yet, which the socket does not report.
            readiness: None,
            endpoint: self.address.clone(),
        })
    }
}

//! TCP client, for RS232-to-TCP converters and programs that serve readings.

use std::io::{Error, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

use super::descriptor::read_available;
use super::{Scheme, Transport, check_socket_address, open_stream};
use crate::capture::connection::{
    ByteStream, ConnectError, Connection, Connector, READ_TIMEOUT, WRITE_TIMEOUT,
};
use crate::capture::poll::Readiness;

/// The `tcp` transport.
pub const TRANSPORT: Transport = Transport {
    scheme: SCHEME,
    is_remote: true,
    is_datagram: false,
    needs_token: false,
    is_device: true,
    has_address: true,
    default_baud: None,
    probe: Some(|address| {
        connect(address)
            .map(drop)
            .map_err(|error| format!("no connection: {error}; {REMEDY}"))
    }),
    check_address: |address| check_socket_address(SCHEME, address),
    open: |uri| {
        let address = uri.address.clone();
        open_stream(uri, TcpConnector { address })
    },
};

const SCHEME: Scheme = Scheme {
    name: "tcp",
    syntax: "tcp:HOST:PORT",
    summary: "TCP server, such as an RS232-to-TCP converter",
    example: "tcp:192.168.1.7:4001",
};

pub(super) const REMEDY: &str = "check that the server is on and that address and port are right";

const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);

/// Connector to a TCP server.
#[derive(Clone)]
struct TcpConnector {
    address: String,
}

impl Connector for TcpConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;

    /// A converter passes on what its device sends at the moment.
    const STARTS_ANYWHERE: bool = true;

    /// A peer whose power was cut never closes its end; a running glove is never silent for 5 s.
    const IDLE_TIMEOUT: Option<Duration> = Some(Duration::from_secs(5));

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let stream = connect(&self.address)
            .map_err(|error| ConnectError::Absent(format!("{error}; {REMEDY}")))?;
        let readiness = Readiness::new(&stream);
        let bytes: Box<dyn ByteStream> = if readiness.is_some() {
            Box::new(AvailableBytes(stream))
        } else {
            Box::new(stream)
        };
        Ok(Connection {
            bytes,
            readiness,
            endpoint: self.address.clone(),
        })
    }
}

impl ByteStream for TcpStream {
    fn writer(&self) -> Option<Box<dyn Write + Send>> {
        let stream = self.try_clone().ok()?;
        stream.set_write_timeout(Some(WRITE_TIMEOUT)).ok()?;
        Some(Box::new(stream))
    }
}

/// Reader of a socket that does not block. Writes to the same socket do, up to their timeout.
struct AvailableBytes(TcpStream);

impl Read for AvailableBytes {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        read_available(&self.0, buffer)
    }
}

impl ByteStream for AvailableBytes {
    fn writer(&self) -> Option<Box<dyn Write + Send>> {
        self.0.writer()
    }
}

/// Connects to the first address of a host that answers.
pub(super) fn connect(address: &str) -> Result<TcpStream, Error> {
    let mut last_error = Error::other("the name has no address");
    for resolved in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&resolved, CONNECT_TIMEOUT) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(READ_TIMEOUT))?;
                return Ok(stream);
            }
            Err(error) => last_error = error,
        }
    }
    Err(last_error)
}

//! RS232-to-TCP converters: the bytes of a serial line from a TCP server.

use std::io::Error;
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

use super::{ConnectError, Connection, Connector, READ_TIMEOUT};
use crate::capture::poll::Readiness;

const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);

/// Connects to a converter.
#[derive(Clone)]
pub(in crate::capture) struct TcpConnector {
    address: String,
}

impl TcpConnector {
    pub fn new(address: &str) -> Self {
        Self {
            address: address.to_owned(),
        }
    }
}

impl Connector for TcpConnector {
    const IS_LIVE: bool = true;

    /// A peer whose power was cut never closes its end; a glove that runs is never silent for so long.
    const IDLE_TIMEOUT: Option<Duration> = Some(Duration::from_secs(5));

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let stream = connect(&self.address).map_err(|error| {
            ConnectError::Absent(format!(
                "{error}; check that the converter is on and that address and port are right"
            ))
        })?;
        Ok(Connection {
            readiness: Readiness::of(&stream),
            bytes: Box::new(stream),
            endpoint: self.address.clone(),
        })
    }
}

fn connect(address: &str) -> Result<TcpStream, Error> {
    let mut failure = Error::other("the name has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_TIMEOUT) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(READ_TIMEOUT))?;
                return Ok(stream);
            }
            Err(error) => failure = error,
        }
    }
    Err(failure)
}

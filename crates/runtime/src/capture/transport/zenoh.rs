//! Messages of one key through the zenoh router of this machine.

use std::net::SocketAddr;

use super::{Scheme, Transport, open_stream};
use crate::capture::connection::{ByteStream, ConnectError, Connection, Connector};
use crate::network::zenoh::{DEFAULT_ROUTER, HAS_ZENOH, Subscriber, ZenohError, check_key};

/// The `zenoh` transport.
pub const TRANSPORT: Transport = Transport {
    scheme: SCHEME,
    is_remote: true,
    is_datagram: true,
    needs_token: false,
    is_device: true,
    has_address: true,
    default_baud: None,
    probe: if HAS_ZENOH { None } else { Some(refuse) },
    check_address: check_key,
    open: |uri| {
        let connector = ZenohConnector {
            key: uri.address.clone(),
            router: uri.router.unwrap_or(DEFAULT_ROUTER),
        };
        open_stream(uri, connector)
    },
};

const SCHEME: Scheme = Scheme {
    name: "zenoh",
    syntax: "zenoh:KEY",
    summary: "messages of one key of a zenoh router on this machine (feature `zenoh`)",
    example: "zenoh:lab/desk-3/right?protocol=text-line",
};

/// Fails: this program was built without zenoh.
fn refuse(_: &str) -> Result<(), String> {
    Err(ZenohError::NotBuilt.to_string())
}

/// Subscriber to a key.
#[derive(Clone)]
struct ZenohConnector {
    key: String,
    router: SocketAddr,
}

/// A shared hand takes no feedback.
impl ByteStream for Subscriber {}

impl Connector for ZenohConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;
    const IS_DATAGRAM: bool = true;
    /// The longest message.
    const READ_BYTES: usize = 1 << 16;

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let subscriber = Subscriber::open(self.router, &self.key).map_err(|error| match error {
            ZenohError::NotBuilt => ConnectError::Unusable(error.to_string()),
            ZenohError::Router { .. } => ConnectError::Absent(error.to_string()),
        })?;
        Ok(Connection {
            bytes: Box::new(subscriber),
            readiness: None,
            endpoint: format!("{} at {}", self.key, self.router),
        })
    }
}

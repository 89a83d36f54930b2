//! A server with the page of `web/` and a WebSocket, over TLS, for a headset on the same network: its browser shows the page, which
//! sends the joints of both hands.
//!
//! A page needs a secure connection for WebXR. Everybody on the network may load it: it is public. Its connection has to show a
//! token in its first message, come from the page of this server and name this server as its host; nothing of it is parsed before.
//! One headset is read at a time, as by `ws`.

#[cfg(feature = "tls")]
mod hello;
#[cfg(feature = "tls")]
mod server;
#[cfg(not(feature = "tls"))]
mod unsupported;

#[cfg(feature = "tls")]
use self::server::Server;
#[cfg(not(feature = "tls"))]
use self::unsupported::Server;

use std::net::SocketAddr;
use std::sync::Arc;

use super::websocket::Messages;
use super::{Scheme, Transport, check_socket_address, open_stream};
use crate::capture::HeadsetList;
use crate::capture::connection::{ConnectError, Connection, Connector};
use crate::network::{HAS_TLS, NetworkError, canonical, check_listen_address};

/// The `headset` transport.
pub const TRANSPORT: Transport = Transport {
    scheme: SCHEME,
    is_remote: true,
    is_datagram: false,
    needs_token: false,
    is_device: false,
    has_address: true,
    default_baud: None,
    // Another program may serve the page at this moment.
    probe: if HAS_TLS { None } else { Some(refuse) },
    check_address: |address| {
        check_socket_address(SCHEME, address)?;
        parse(address).map(drop)
    },
    open: |uri| {
        let connector = HeadsetConnector {
            address: uri.address.clone(),
            pages: uri.pages.clone(),
            headsets: HeadsetList::default(),
            server: None,
        };
        open_stream(uri, connector)
    },
};

const SCHEME: Scheme = Scheme {
    name: "headset",
    syntax: "headset:ADDRESS:PORT",
    summary: "page for the browser of a headset on the network, over TLS (`ademan serve --lan`)",
    example: "headset:192.168.1.7:8443?page=target/web",
};

/// Fails: this program was built without TLS.
fn refuse(_: &str) -> Result<(), String> {
    Err(NetworkError::NoTls.to_string())
}

/// The files that the server of a headset reads.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HeadsetPages {
    /// The folder of the page.
    pub folder: String,
    /// The layout that the page shows: a name or a file. Without one the page keeps its own.
    pub layout: Option<String>,
}

fn parse(address: &str) -> Result<SocketAddr, String> {
    let parsed: SocketAddr = address.parse().map_err(|_| {
        format!(
            "write `{}` with the address of this machine on the network, as `ip address` shows it",
            SCHEME.syntax
        )
    })?;
    let parsed = canonical(parsed);
    check_listen_address(parsed, true)?;
    Ok(parsed)
}

/// Starter of the server, which outlives the headsets that come and go.
#[derive(Clone)]
struct HeadsetConnector {
    address: String,
    pages: Option<HeadsetPages>,
    headsets: HeadsetList,
    server: Option<Arc<Server>>,
}

impl Connector for HeadsetConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;
    const HAS_SENDERS: bool = true;

    fn headsets(&self) -> Option<HeadsetList> {
        Some(self.headsets.clone())
    }

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let server = match &self.server {
            Some(server) => Arc::clone(server),
            None => {
                let address = parse(&self.address).map_err(ConnectError::Unusable)?;
                let pages = self.pages.clone().ok_or_else(|| {
                    let remedy = "name the folder of the page, which `web/build` makes: `page=target/web`; `ademan serve --lan` does";
                    ConnectError::Unusable(remedy.to_owned())
                })?;
                let started = Server::start(address, &pages, self.headsets.clone());
                let started = started.map_err(ConnectError::Unusable)?;
                Arc::clone(self.server.insert(Arc::new(started)))
            }
        };
        Ok(Connection {
            bytes: Box::new(Messages::new(server)),
            readiness: None,
            endpoint: self.address.clone(),
        })
    }
}

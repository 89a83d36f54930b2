//! Standard input, for a program that writes a stream to a pipe.

use super::descriptor::open_stdin;
use super::{Scheme, Transport, open_stream};
use crate::capture::connection::{ConnectError, Connection, Connector};

/// The `stdin` transport.
pub const TRANSPORT: Transport = Transport {
    scheme: SCHEME,
    is_remote: false,
    is_datagram: false,
    needs_token: false,
    is_device: false,
    has_address: false,
    default_baud: None,
    probe: Some(|_| Ok(())),
    check_address: |address| match address {
        "" => Ok(()),
        _ => Err("`stdin:` has no address, write `stdin:` or `stdin:?protocol=…`".to_owned()),
    },
    open: |uri| open_stream(uri, StdinConnector),
};

const SCHEME: Scheme = Scheme {
    name: "stdin",
    syntax: "stdin:",
    summary: "bytes of a stream on the standard input",
    example: "stdin:?protocol=text-line",
};

/// Opener of the standard input. Where a read cannot be cancelled, a stopped source waits for the next bytes.
#[derive(Clone)]
struct StdinConnector;

impl Connector for StdinConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = false;

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let (bytes, readiness) =
            open_stdin().map_err(|error| ConnectError::Unusable(error.to_string()))?;
        Ok(Connection {
            bytes,
            readiness,
            endpoint: "the standard input".to_owned(),
        })
    }
}

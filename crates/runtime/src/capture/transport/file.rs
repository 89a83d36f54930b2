//! File with the raw bytes of a stream.

use std::path::{Path, PathBuf};

use super::{Scheme, Transport, open_stream};
use crate::capture::connection::{ConnectError, Connection, Connector};
use crate::files::{self, FileError};

/// The `file` transport.
pub const TRANSPORT: Transport = Transport {
    scheme: SCHEME,
    is_remote: false,
    is_datagram: false,
    needs_token: false,
    is_device: false,
    has_address: true,
    default_baud: None,
    probe: Some(|address| {
        let opened = files::open_regular(Path::new(address));
        opened.map(drop).map_err(|error| error.to_string())
    }),
    check_address: |_| Ok(()),
    open: |uri| {
        let path = PathBuf::from(&uri.address);
        open_stream(uri, FileConnector { path })
    },
};

const SCHEME: Scheme = Scheme {
    name: "file",
    syntax: "file:PATH",
    summary: "bytes of a stream in a file, at the nominal rate",
    example: "file:glove.raw?baud=9600",
};

/// Opener of a regular file.
#[derive(Clone)]
struct FileConnector {
    path: PathBuf,
}

impl Connector for FileConnector {
    const IS_LIVE: bool = false;
    const RECONNECTS: bool = false;

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let file = files::open_regular(&self.path).map_err(|error| match error {
            FileError::Io(error) => ConnectError::Absent(error.to_string()),
            error => ConnectError::Unusable(error.to_string()),
        })?;
        Ok(Connection {
            bytes: Box::new(file),
            readiness: None,
            endpoint: self.path.to_string_lossy().into_owned(),
        })
    }
}

//! Connections to other machines: TLS, tokens, and the role that a token grants.
//!
//! Beyond the loopback address a server of this program speaks TLS 1.3 and admits only clients with a token, and a client
//! of it connects only to the certificate whose fingerprint it knows:
//!
//! - The **server** has a certificate, self-signed unless a person provides one, and a list of tokens. The list holds the
//!   SHA-256 hash of each token with its name and its [`TokenRole`], so that a copy of the list is of no use to a client.
//! - The **client** has a file with one token, and the fingerprint of the certificate of the server that issued it. That one
//!   file, copied to the other machine, is all that a connection needs.
//! - After the handshake the client sends `token`, a blank, 64 hexadecimal digits and a line end. The server answers `ok` or
//!   `refused`; what follows `ok` is the shared data. Nothing of a client is parsed before that.
//!
//! A token has 256 random bits, so that a fast hash protects it as well as a slow one. Handshakes run on threads of their
//! own with a deadline and a limit per address. After several wrong tokens an address is refused for a time that grows. All of
//! this needs the feature `tls`; a program without it refuses the addresses.

mod address;
mod deadline;
mod descriptors;
mod memory_stream;
pub mod zenoh;

#[cfg(feature = "tls")]
mod secure;
#[cfg(feature = "tls")]
pub use self::secure::{Gatekeeper, connect, tokens};
#[cfg(feature = "tls")]
pub(crate) use self::secure::{ServerStream, Unproven};

#[cfg(not(feature = "tls"))]
mod unsupported;
#[cfg(not(feature = "tls"))]
pub use self::unsupported::{Gatekeeper, connect, tokens};

pub use self::address::{canonical, check_listen_address, parse_loopback};
pub(crate) use self::deadline::DeadlineStream;
pub(crate) use self::descriptors::max_connections;
pub use self::memory_stream::MemoryStream;

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;

use crate::files::{FileError, config_folder};
use ademan_core::message::{escape_line, escape_path};
use ademan_core::names::named_enum;

/// `true` if this program was built with TLS.
pub(crate) const HAS_TLS: bool = cfg!(feature = "tls");

named_enum! {
    /// The permission that a token grants. Each variant includes the permissions of the variants before it.
    pub enum TokenRole ("role") {
        /// Receives shared data; as the token of a source, only moves the hand on the screen.
        See = "see",
        /// Moves the pointer and presses mouse and gamepad buttons.
        Point = "point",
        /// Presses keys.
        Type = "type",
    }
}

impl TokenRole {
    /// Returns one line about the role, in lower case and without a full stop.
    pub const fn summary(self) -> &'static str {
        match self {
            Self::See => "receives shared data",
            Self::Point => "as a source, also moves the pointer and presses its buttons",
            Self::Type => "as a source, also presses keys",
        }
    }
}

/// A token of the list, without its secret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TokenEntry {
    /// The name.
    pub name: String,
    /// The permission.
    pub role: TokenRole,
}

/// A connection in both directions, with or without TLS.
pub trait Stream: Read + Write + Send {
    /// Sets whether reads and writes return at once with [`io::ErrorKind::WouldBlock`] instead of waiting.
    fn set_nonblocking(&self, is_nonblocking: bool) -> io::Result<()>;
}

impl Stream for TcpStream {
    fn set_nonblocking(&self, is_nonblocking: bool) -> io::Result<()> {
        Self::set_nonblocking(self, is_nonblocking)
    }
}

/// A client with a valid token.
pub struct Admitted {
    /// The connection after the answer `ok`.
    pub stream: Box<dyn Stream>,
    /// The token.
    pub token: TokenEntry,
}

/// The reason why tokens or certificates cannot be used. No message contains a token.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    /// The program was built without TLS.
    #[error(
        "this program was built without TLS, which connections to other machines need; build it with `--features tls`, or \
         use an SSH tunnel: `ssh -L`"
    )]
    NoTls,
    /// The system has no folder for files of a person.
    #[error("there is no configuration folder for tokens; set HOME or XDG_CONFIG_HOME")]
    NoFolder,
    /// A file or folder cannot be used.
    #[error("cannot {action} {}: {error}", escape_path(.path))]
    File {
        /// The verb: "read" or "write".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The cause.
        error: FileError,
    },
    /// The content of a file is invalid. The message does not quote it, as it may be secret.
    #[error("{} is not valid: {}", escape_path(.path), escape_line(.reason))]
    Content {
        /// The file.
        path: PathBuf,
        /// The error and what to do.
        reason: String,
    },
    /// A token cannot be made or removed.
    #[error("{}", escape_line(.0))]
    Token(String),
    /// The library for TLS refuses, or the system has no random numbers.
    #[error("cannot set up TLS: {0}")]
    Tls(String),
}

/// The reason why a connection cannot be secured.
#[derive(Debug, thiserror::Error)]
pub enum SecureError {
    /// The token file of the client cannot be used.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The certificate of the server is not the one that the token file names.
    #[error(
        "the certificate of the server is not the one in {}, so it may be another machine; if the server has a new \
         certificate, copy a new token file from it",
        escape_path(.token_file)
    )]
    OtherCertificate {
        /// The token file.
        token_file: PathBuf,
    },
    /// The server does not accept the token.
    #[error(
        "the server refuses the token in {}; it may be revoked: `ademan token list` there shows the valid ones",
        escape_path(.token_file)
    )]
    Refused {
        /// The token file.
        token_file: PathBuf,
    },
    /// The connection has failed.
    #[error(
        "the secure connection failed: {0}; check that the port is one of `+tls`; a server also closes connections for a \
         while after wrong tokens"
    )]
    Connection(io::Error),
}

/// Returns the folder with the certificate, the list of tokens and the token files: `network` in the configuration folder.
pub fn network_folder() -> Result<PathBuf, NetworkError> {
    let folder = config_folder().ok_or(NetworkError::NoFolder)?;
    Ok(folder.join("network"))
}

/// Returns the path of a token file: a path with a folder, or the name of a file in the network folder. A name never means a file in
/// the working folder, whose files may be a stranger's: without a network folder it is an error.
pub fn token_path(name: &str) -> Result<PathBuf, NetworkError> {
    let path = PathBuf::from(name);
    if path.components().count() > 1 {
        Ok(path)
    } else {
        Ok(network_folder()?.join(path))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn a_name_never_means_a_token_file_in_the_working_folder() {
        // Cargo runs tests in a folder with this file.
        let name = "Cargo.toml";
        assert!(Path::new(name).is_file());
        let folder = network_folder().expect("HOME is set");
        assert_eq!(token_path(name).unwrap(), folder.join(name));
        for path in ["./Cargo.toml", "tokens/desk.token", "/desk.token"] {
            assert_eq!(token_path(path).unwrap(), Path::new(path));
        }
    }
}

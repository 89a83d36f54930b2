//! The stand-in of a program without TLS: no connection to another machine.

use std::convert::Infallible;
use std::net::{IpAddr, TcpStream};
use std::path::Path;

use super::{Admitted, NetworkError, SecureError, Stream};

/// Secures nothing.
pub fn connect(_: TcpStream, _: &Path) -> Result<Box<dyn Stream>, SecureError> {
    Err(NetworkError::NoTls.into())
}

/// Never created.
#[derive(Clone, Debug)]
pub struct Gatekeeper(Infallible);

impl Gatekeeper {
    /// Returns the reason.
    pub fn open(_: &Path) -> Result<Self, NetworkError> {
        Err(NetworkError::NoTls)
    }

    /// Never called.
    pub fn admit(&self, _: TcpStream, _: IpAddr, _: impl FnOnce(Admitted) + Send + 'static) {
        match self.0 {}
    }
}

/// The tokens of this machine, of which there are none.
pub mod tokens {
    use std::path::{Path, PathBuf};

    use crate::network::{NetworkError, TokenEntry, TokenRole};

    /// Returns the reason.
    pub fn create(_: &Path, _: &str, _: TokenRole) -> Result<PathBuf, NetworkError> {
        Err(NetworkError::NoTls)
    }

    /// Returns the reason.
    pub fn list(_: &Path) -> Result<Vec<TokenEntry>, NetworkError> {
        Err(NetworkError::NoTls)
    }

    /// Returns the reason.
    pub fn revoke(_: &Path, _: &str) -> Result<(), NetworkError> {
        Err(NetworkError::NoTls)
    }

    /// Returns nothing.
    pub fn secret_of(_: &Path, _: &str) -> Option<String> {
        None
    }

    /// Returns the reason.
    pub fn role_of_file(_: &Path) -> Result<TokenRole, NetworkError> {
        Err(NetworkError::NoTls)
    }
}

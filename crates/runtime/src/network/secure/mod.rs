//! Tokens, certificates and TLS by the libraries `rustls` and `ring`.

mod client;
mod failed_tries;
mod folder_lock;
mod gatekeeper;
mod hello;
mod hex;
mod identity;
mod pinned;
mod secret_file;
mod token;
mod token_file;
mod token_list;
mod tls_stream;
pub mod tokens;

pub use self::client::connect;
pub use self::gatekeeper::{Gatekeeper, Unproven};
pub use self::tls_stream::ServerStream;

use std::path::Path;
use std::sync::Arc;

use rustls::SupportedProtocolVersion;
use rustls::crypto::CryptoProvider;

use super::NetworkError;
use crate::files::FileError;

/// TLS 1.3 and nothing older.
const VERSIONS: &[&SupportedProtocolVersion] = &[&rustls::version::TLS13];

/// Returns the implementation of the ciphers.
fn provider() -> Arc<CryptoProvider> {
    Arc::new(rustls::crypto::ring::default_provider())
}

/// Returns the error of a file that cannot be used; `action` is a verb.
fn file_error(action: &'static str, path: &Path, error: impl Into<FileError>) -> NetworkError {
    NetworkError::File {
        action,
        path: path.into(),
        error: error.into(),
    }
}

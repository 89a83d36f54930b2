//! The certificate and the key of this machine.

use std::io;
use std::path::Path;
use std::sync::Arc;

use rcgen::{CertificateParams, DistinguishedName, DnType, KeyPair};
use rustls::ServerConfig;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::server::NoServerSessionStorage;

use super::folder_lock::FolderLock;
use super::token::Hash;
use super::{VERSIONS, file_error, provider, secret_file};
use crate::network::NetworkError;

/// The file of the certificate. A person may put a certificate of their own there, followed by the certificates that signed it.
const CERTIFICATE: &str = "certificate.pem";

/// The file of the private key.
const KEY: &str = "key.pem";

/// The name in a self-signed certificate. Clients compare the fingerprint and not the name.
const NAME: &str = "ademan";

/// A certificate, the certificates that signed it, and its private key.
pub struct Identity {
    chain: Vec<CertificateDer<'static>>,
    key: PrivateKeyDer<'static>,
}

impl Identity {
    /// Reads the certificate and the key in a folder, and makes them if they are missing.
    pub fn open(folder: &Path) -> Result<Self, NetworkError> {
        match Self::read(folder)? {
            Some(identity) => Ok(identity),
            None => Self::open_locked(&FolderLock::acquire(folder)?),
        }
    }

    /// Reads the certificate and the key in a folder that is locked already, and makes them if they are missing.
    pub fn open_locked(lock: &FolderLock) -> Result<Self, NetworkError> {
        let folder = lock.folder();
        if let Some(identity) = Self::read(folder)? {
            return Ok(identity);
        }
        create(folder)?;
        let missing = io::Error::from(io::ErrorKind::NotFound);
        Self::read(folder)?.ok_or_else(|| file_error("read", &folder.join(CERTIFICATE), missing))
    }

    /// Reads the certificate and the key in a folder; `None` if there is no certificate.
    fn read(folder: &Path) -> Result<Option<Self>, NetworkError> {
        let (certificate, key) = (folder.join(CERTIFICATE), folder.join(KEY));
        let Some(certificate_text) = secret_file::read(&certificate)? else {
            return Ok(None);
        };
        let key_text = secret_file::read(&key)?.ok_or_else(|| {
            let missing = io::Error::from(io::ErrorKind::NotFound);
            file_error("read", &key, missing)
        })?;
        let chain = CertificateDer::pem_slice_iter(certificate_text.as_bytes());
        let chain: Vec<_> = chain
            .collect::<Result<_, _>>()
            .map_err(|_| invalid(&certificate))?;
        if chain.is_empty() {
            return Err(invalid(&certificate));
        }
        let key = PrivateKeyDer::from_pem_slice(key_text.as_bytes()).map_err(|_| invalid(&key))?;
        Ok(Some(Self { chain, key }))
    }

    /// Returns the SHA-256 hash of the certificate, which clients know.
    pub fn fingerprint(&self) -> Hash {
        Hash::of(&self.chain[0])
    }

    /// Returns the settings of a server: TLS 1.3, no client certificates, and no session that could be resumed.
    pub fn server_config(self) -> Result<Arc<ServerConfig>, NetworkError> {
        let tls_error = |error: rustls::Error| NetworkError::Tls(error.to_string());
        let mut config = ServerConfig::builder_with_provider(provider())
            .with_protocol_versions(VERSIONS)
            .map_err(tls_error)?
            .with_no_client_auth()
            .with_single_cert(self.chain, self.key)
            .map_err(tls_error)?;
        config.session_storage = Arc::new(NoServerSessionStorage {});
        config.send_tls13_tickets = 0;
        Ok(Arc::new(config))
    }
}

/// Makes a certificate and its key in a folder. A key without a certificate, as a command that was killed leaves it, is kept.
fn create(folder: &Path) -> Result<(), NetworkError> {
    let rcgen_error = |error: rcgen::Error| NetworkError::Tls(error.to_string());
    let key = folder.join(KEY);
    let pair = match secret_file::read(&key)? {
        Some(text) => KeyPair::from_pem(&text).map_err(|_| invalid(&key))?,
        None => {
            let pair = KeyPair::generate().map_err(rcgen_error)?;
            secret_file::create(&key, &pair.serialize_pem())?;
            pair
        }
    };
    let mut parameters = CertificateParams::new([NAME.to_owned()]).map_err(rcgen_error)?;
    parameters.distinguished_name = DistinguishedName::new();
    parameters.distinguished_name.push(DnType::CommonName, NAME);
    let signed = parameters.self_signed(&pair).map_err(rcgen_error)?;
    secret_file::create(&folder.join(CERTIFICATE), &signed.pem())
}

fn invalid(path: &Path) -> NetworkError {
    NetworkError::Content {
        path: path.into(),
        reason:
            "it is not a PEM file of that kind; remove certificate.pem and key.pem to get new ones"
                .into(),
    }
}

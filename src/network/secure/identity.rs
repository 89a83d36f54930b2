//! The certificate and the key of this machine.

use std::path::Path;
use std::sync::Arc;

use rcgen::{CertificateParams, DistinguishedName, DnType, KeyPair};
use rustls::ServerConfig;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::server::NoServerSessionStorage;

use super::token::Hash;
use super::{VERSIONS, file_error, provider, secret_file};
use crate::network::NetworkError;

/// The file of the certificate. A person may put one of their own there, with those that signed it behind it.
const CERTIFICATE: &str = "certificate.pem";

/// The file of the private key.
const KEY: &str = "key.pem";

/// The name in a self-signed certificate. Clients compare the fingerprint and not the name.
const NAME: &str = "ademan";

/// A certificate, those that signed it, and its private key.
pub struct Identity {
    chain: Vec<CertificateDer<'static>>,
    key: PrivateKeyDer<'static>,
}

impl Identity {
    /// Reads the certificate and the key in a folder. Makes both, self-signed, if neither exists.
    pub fn load_or_create(folder: &Path) -> Result<Self, NetworkError> {
        let (certificate, key) = (folder.join(CERTIFICATE), folder.join(KEY));
        let texts = match (secret_file::read(&certificate)?, secret_file::read(&key)?) {
            (Some(certificate), Some(key)) => (certificate, key),
            (None, None) => create(&certificate, &key)?,
            (has_certificate, _) => {
                let missing = if has_certificate.is_some() {
                    key
                } else {
                    certificate
                };
                let absent = std::io::Error::from(std::io::ErrorKind::NotFound);
                return Err(file_error("read", &missing, absent));
            }
        };
        let invalid = |path: &Path| NetworkError::Content {
            path: path.into(),
            reason:
                "it is no PEM file of that kind; remove certificate.pem and key.pem to get new ones"
                    .into(),
        };
        let chain: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(texts.0.as_bytes()).collect();
        let chain = chain.map_err(|_| invalid(&certificate))?;
        if chain.is_empty() {
            return Err(invalid(&certificate));
        }
        let key = PrivateKeyDer::from_pem_slice(texts.1.as_bytes()).map_err(|_| invalid(&key))?;
        Ok(Self { chain, key })
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

/// Makes a certificate and a key and writes them. Returns both as PEM.
fn create(certificate: &Path, key: &Path) -> Result<(String, String), NetworkError> {
    let rcgen_error = |error: rcgen::Error| NetworkError::Tls(error.to_string());
    let pair = KeyPair::generate().map_err(rcgen_error)?;
    let mut parameters = CertificateParams::new([NAME.to_owned()]).map_err(rcgen_error)?;
    parameters.distinguished_name = DistinguishedName::new();
    parameters.distinguished_name.push(DnType::CommonName, NAME);
    let signed = parameters.self_signed(&pair).map_err(rcgen_error)?;
    let texts = (signed.pem(), pair.serialize_pem());
    secret_file::create(key, &texts.1)?;
    secret_file::create(certificate, &texts.0)?;
    Ok(texts)
}

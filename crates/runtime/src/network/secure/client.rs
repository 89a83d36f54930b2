//! The client of a server with TLS and tokens.

use std::io::{self, ErrorKind};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use rustls::pki_types::ServerName;
use rustls::{ClientConnection, StreamOwned};

use super::hello;
use super::pinned::{OTHER_CERTIFICATE, client_config};
use super::token_file::TokenFile;
use crate::network::{DeadlineStream, NetworkError, SecureError, Stream};

/// Longest time for the handshake and the answer.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(5);

/// Longest time of a read or write afterwards.
const IO_TIMEOUT: Duration = Duration::from_millis(50);

/// Secures a connection with the token and the fingerprint in a file, which is read each time. What is read from the result
/// is what the server sends after its answer.
pub fn connect(stream: TcpStream, token_file: &Path) -> Result<Box<dyn Stream>, SecureError> {
    let file = TokenFile::read(token_file)?;
    let tls_error = |error: rustls::Error| NetworkError::Tls(error.to_string());
    let config = client_config(file.server).map_err(tls_error)?;
    // The server has one certificate, and its name is not checked.
    let name = ServerName::try_from("ademan").expect("a valid name");
    let connection = ClientConnection::new(config, name).map_err(tls_error)?;
    let stream = DeadlineStream::new(Arc::new(stream), HANDSHAKE_TIMEOUT);
    let mut stream = StreamOwned::new(connection, stream.map_err(SecureError::Connection)?);
    let greet = |error: io::Error| greeting_error(error, token_file);
    hello::send(&mut stream, &file.token).map_err(greet)?;
    if !hello::receive_answer(&mut stream).map_err(greet)? {
        let token_file = token_file.into();
        return Err(SecureError::Refused { token_file });
    }
    let ended = stream.sock.end_deadline(IO_TIMEOUT);
    ended.map_err(SecureError::Connection)?;
    Ok(Box::new(stream))
}

fn greeting_error(error: io::Error, token_file: &Path) -> SecureError {
    let tls = error
        .get_ref()
        .and_then(|inner| inner.downcast_ref::<rustls::Error>());
    match tls {
        Some(inner) if *inner == OTHER_CERTIFICATE => SecureError::OtherCertificate {
            token_file: token_file.into(),
        },
        _ if error.kind() == ErrorKind::TimedOut => {
            let seconds = HANDSHAKE_TIMEOUT.as_secs();
            SecureError::Connection(io::Error::new(
                ErrorKind::TimedOut,
                format!("no answer within {seconds} s"),
            ))
        }
        _ => SecureError::Connection(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_silent_server_is_named_with_the_time_that_it_had() {
        let error = greeting_error(ErrorKind::TimedOut.into(), Path::new("desk.token"));
        let text = error.to_string();
        assert!(
            text.contains("the secure connection failed: no answer within 5 s; check"),
            "{text}"
        );
    }
}

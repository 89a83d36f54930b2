//! The conditions under which a web request is admitted.

use std::net::SocketAddr;

use tungstenite::handshake::server::Request;

use crate::message::escape;

/// The conditions under which the request of a web client is admitted.
///
/// A page of any site can send requests to this machine, and can have a host name that stands for its address. A request
/// therefore has to name this address, and to come from no page or from one that is admitted.
pub(crate) struct Admission {
    /// The address of the server.
    pub address: SocketAddr,
    /// Pages that are admitted, such as `http://localhost:8080`.
    pub origins: Vec<String>,
    /// The remedy for a page that is not admitted.
    pub remedy: &'static str,
}

impl Admission {
    /// Checks `Host` and `Origin`. The reason states what to do.
    pub fn check(&self, request: &Request) -> Result<(), String> {
        let header = |name| {
            let mut values = request.headers().get_all(name).iter();
            let first = values.next().map(|value| value.to_str().unwrap_or("?"));
            match values.next() {
                Some(_) => Some("?"),
                None => first,
            }
        };
        let hosts = [
            self.address.to_string(),
            format!("localhost:{}", self.address.port()),
        ];
        if !header("Host").is_some_and(|host| hosts.iter().any(|own| own == host)) {
            return Err(format!(
                "its request does not name {} as its host",
                hosts[0]
            ));
        }
        match header("Origin") {
            Some(origin) if !self.origins.iter().any(|admitted| admitted == origin) => Err(
                format!("it is the page {}; {}", escape(origin), self.remedy),
            ),
            _ => Ok(()),
        }
    }
}

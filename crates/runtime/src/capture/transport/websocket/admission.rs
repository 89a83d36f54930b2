//! The conditions under which a web request is admitted.

use std::net::SocketAddr;

use tungstenite::handshake::server::Request;
use tungstenite::http::Uri;

use ademan_core::message::escape;

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
    /// Checks the target of the request, `Host` and `Origin`. The reason states what to do.
    pub fn check(&self, request: &Request) -> Result<(), String> {
        let header = |name| {
            let mut values = request.headers().get_all(name).iter();
            let first = values.next().map(|value| value.to_str().unwrap_or("?"));
            match values.next() {
                Some(_) => Some("?"),
                None => first,
            }
        };
        if !is_path(request.uri()) {
            return Err("its request is not for a path of this server, such as /ws".into());
        }
        let hosts = [
            self.address.to_string(),
            format!("localhost:{}", self.address.port()),
        ];
        let is_own = |host: &str| {
            let mut names = hosts.iter();
            names.any(|own| own == host || without_default_port(own) == Some(host))
        };
        if !header("Host").is_some_and(is_own) {
            return Err(format!(
                "its request does not name {} as its host",
                hosts[0]
            ));
        }
        match header("Origin") {
            Some(origin) if !self.admits(origin) => Err(format!(
                "it is the page {}; {}",
                escape(origin),
                self.remedy
            )),
            _ => Ok(()),
        }
    }

    fn admits(&self, origin: &str) -> bool {
        let mut admitted = self.origins.iter();
        admitted.any(|page| as_browsers_write(page) == as_browsers_write(origin))
    }
}

/// Returns a host without its port if that is one of the ports of the web, which browsers leave out; otherwise `None`.
fn without_default_port(host: &str) -> Option<&str> {
    host.strip_suffix(":80")
        .or_else(|| host.strip_suffix(":443"))
}

/// Returns an origin without the default port of its scheme.
fn as_browsers_write(origin: &str) -> &str {
    let is_secure = origin.starts_with("https://");
    let port = if is_secure { ":443" } else { ":80" };
    origin.strip_suffix(port).unwrap_or(origin)
}

/// Returns `true` if a request target is a path, without another server in it: a proxy sends `http://HOST/ws`.
fn is_path(target: &Uri) -> bool {
    let path = target.path();
    target.authority().is_none() && path.starts_with('/') && !path.starts_with("//")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_path_of_this_server_is_a_request_target() {
        let admission = Admission {
            address: "127.0.0.1:8080".parse().unwrap(),
            origins: Vec::new(),
            remedy: "",
        };
        let check = |target: &str| {
            let request = Request::builder().uri(target);
            let request = request.header("Host", "127.0.0.1:8080").body(()).unwrap();
            admission.check(&request)
        };
        for target in ["/", "/ws", "/ws?a=1", "/ws//b"] {
            assert_eq!(check(target), Ok(()), "{target}");
        }
        for target in [
            "http://evil/ws",
            "http://127.0.0.1:8080/ws",
            "//evil/ws",
            "evil:80",
            "127.0.0.1:8080",
            "*",
        ] {
            let reason = check(target).unwrap_err();
            assert!(reason.contains("not for a path"), "{target}: {reason}");
        }
    }

    /// Returns `true` if the own page of a server at this address is admitted with these headers.
    fn admits_own_page(address: &str, scheme: &str, host: &str, origin: &str) -> bool {
        let admission = Admission {
            address: address.parse().unwrap(),
            origins: vec![format!("{scheme}://{address}")],
            remedy: "",
        };
        let request = Request::builder().uri("/ws").header("Host", host);
        let request = request.header("Origin", origin).body(()).unwrap();
        admission.check(&request).is_ok()
    }

    #[test]
    fn browsers_leave_out_the_default_port_of_the_own_page() {
        let (http, https) = ("127.0.0.1:80", "[::1]:443");
        assert!(admits_own_page(
            http,
            "http",
            "127.0.0.1",
            "http://127.0.0.1"
        ));
        assert!(admits_own_page(http, "http", http, "http://127.0.0.1:80"));
        assert!(admits_own_page(https, "https", "[::1]", "https://[::1]"));
        for (address, host, origin) in [
            ("127.0.0.1:8080", "127.0.0.1", "http://127.0.0.1:8080"),
            ("127.0.0.1:8080", "127.0.0.1:8080", "http://127.0.0.1"),
            (http, "127.0.0.1", "https://127.0.0.1"),
            (http, "127.0.0.1", "http://127.0.0.1:443"),
            (http, "evil", "http://127.0.0.1"),
        ] {
            let is_admitted = admits_own_page(address, "http", host, origin);
            assert!(!is_admitted, "{address}, {host}, {origin}");
        }
    }
}

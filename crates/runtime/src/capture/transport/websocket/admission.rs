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
}

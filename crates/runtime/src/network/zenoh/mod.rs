//! Readings and lines through a router of [zenoh](https://zenoh.io), for laboratories with many machines.
//!
//! The program connects to the router of its own machine, as a client: it listens to nothing, searches for nothing and sends
//! nothing beyond the loopback address. The routers of a laboratory connect to each other; encryption, certificates and
//! access rules between machines are set in their files. All of this needs the feature `zenoh`.

#[cfg(feature = "zenoh")]
mod client;
#[cfg(feature = "zenoh")]
pub use self::client::{Publisher, Subscriber};

#[cfg(not(feature = "zenoh"))]
mod unsupported;
#[cfg(not(feature = "zenoh"))]
pub use self::unsupported::{Publisher, Subscriber};

use ademan_core::message::{escape, escape_line};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};

use super::canonical;

/// `true` if this program was built with zenoh.
pub(crate) const HAS_ZENOH: bool = cfg!(feature = "zenoh");

/// The address of the router unless another one is named.
pub const DEFAULT_ROUTER: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 7447);

/// Longest key, in bytes.
pub const MAX_KEY_BYTES: usize = 128;

/// The reason why a router cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ZenohError {
    /// The program was built without zenoh.
    #[error("this program was built without zenoh; build it with `--features zenoh`")]
    NotBuilt,
    /// The router does not answer, or the key is refused.
    #[error(
        "no connection to the zenoh router at {router}: {}; start `zenohd` on this machine",
        escape_line(.reason)
    )]
    Router {
        /// The address.
        router: SocketAddr,
        /// The cause, as the library states it.
        reason: String,
    },
}

/// Checks a key: names joined by `/`, without wildcards, at most [`MAX_KEY_BYTES`]. A key carries one hand; with two publishers it
/// would jump.
pub fn check_key(key: &str) -> Result<(), String> {
    let is_name = |name: &str| !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_graphic());
    let is_key = key.len() <= MAX_KEY_BYTES && key.split('/').all(is_name);
    if is_key && !key.contains(['*', '$', '?', '#', '&', '@']) {
        Ok(())
    } else {
        Err(format!(
            "a key consists of names joined by `/`, without wildcards, of at most {MAX_KEY_BYTES} bytes, such as `lab/desk-3/right`"
        ))
    }
}

/// Reads the address of a router, which is one of this machine.
pub fn parse_router(text: &str) -> Result<SocketAddr, String> {
    let address: Option<SocketAddr> = text.parse().ok().map(canonical);
    match address {
        Some(address) if address.ip().is_loopback() && address.port() > 0 => Ok(address),
        Some(_) => Err(
            "the connection to a zenoh router is not encrypted, so it is one of this machine: write `router=127.0.0.1:7447`, \
             and connect that router to the others with TLS"
                .into(),
        ),
        None => Err(format!(
            "`{}` is not an address and a port, such as `router=127.0.0.1:7447`",
            escape(text)
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_names_one_hand() {
        assert_eq!(check_key("lab/desk-3/right"), Ok(()));
        for wrong in [
            "",
            "/lab",
            "lab/",
            "lab//right",
            "lab/*",
            "lab/**",
            "a b",
            "a\n",
            "@/router",
            &"a".repeat(129),
        ] {
            let error = check_key(wrong).unwrap_err();
            assert!(error.contains("at most 128 bytes"), "{wrong}: {error}");
        }
    }

    #[test]
    fn a_router_is_one_of_this_machine() {
        for text in ["127.0.0.1:7447", "[::ffff:127.0.0.1]:7447"] {
            assert_eq!(parse_router(text), Ok(DEFAULT_ROUTER));
        }
        for (wrong, remedy) in [
            ("192.0.2.2:7447", "with TLS"),
            ("0.0.0.0:7447", "with TLS"),
            ("[::ffff:0.0.0.0]:7447", "with TLS"),
            ("[::ffff:192.0.2.2]:7447", "with TLS"),
            ("127.0.0.1:0", "127.0.0.1:7447"),
            ("router", "not an address"),
        ] {
            let error = parse_router(wrong).unwrap_err();
            assert!(error.contains(remedy), "{wrong}: {error}");
        }
    }
}

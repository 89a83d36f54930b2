//! The addresses at which servers of this program may listen.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};

/// Returns the IPv4 address if this is an IPv6 address that stands for one (`::ffff:192.0.2.2`), otherwise the address
/// itself.
///
/// A socket at such an address is one of IPv4: `[::ffff:0.0.0.0]` listens on every network.
pub const fn canonical(address: SocketAddr) -> SocketAddr {
    match address.ip().to_canonical() {
        IpAddr::V4(ip) => SocketAddr::new(IpAddr::V4(ip), address.port()),
        // An address of IPv6 also has a scope, which names the network of `fe80::1%eth0`.
        IpAddr::V6(_) => address,
    }
}

/// Reads an address of this machine that no other machine can reach; `None` for any other text.
pub fn parse_loopback(text: &str) -> Option<SocketAddr> {
    let address = canonical(text.parse().ok()?);
    address.ip().is_loopback().then_some(address)
}

/// Checks the address of a server. `Err` states the reason and what to do.
///
/// Beyond the loopback address TLS is required, and the address has to belong to one interface: a server at `0.0.0.0`
/// would also listen on the networks that a person has forgotten.
pub fn check_listen_address(address: SocketAddr, is_secure: bool) -> Result<(), &'static str> {
    let ip = canonical(address).ip();
    if ip.is_unspecified() {
        return Err(
            "this address means every network of the machine; name the address of one, as `ip address` shows it",
        );
    }
    if ip.is_multicast() || ip == IpAddr::V4(Ipv4Addr::BROADCAST) {
        return Err("this is a multicast address, which no server can listen on");
    }
    if !ip.is_loopback() && !is_secure {
        return Err(
            "without TLS only programs on this machine may connect: use 127.0.0.1 or [::1], add `+tls` for other machines, or \
             use an SSH tunnel: `ssh -L`",
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_machines_need_tls_and_an_address_of_one_network() {
        for (address, plain, secure) in [
            ("127.0.0.1:1", "", ""),
            ("[::1]:1", "", ""),
            ("192.0.2.2:1", "`+tls`", ""),
            ("[fd00::2]:1", "`+tls`", ""),
            ("0.0.0.0:1", "every network", "every network"),
            ("[::]:1", "every network", "every network"),
            ("224.0.0.1:1", "multicast", "multicast"),
            ("255.255.255.255:1", "multicast", "multicast"),
            ("[ff02::1]:1", "multicast", "multicast"),
            ("[::ffff:127.0.0.1]:1", "", ""),
            ("[::ffff:192.0.2.2]:1", "`+tls`", ""),
            ("[::ffff:0.0.0.0]:1", "every network", "every network"),
            ("[::ffff:0:0]:1", "every network", "every network"),
            ("[0:0:0:0:0:ffff:0:0]:1", "every network", "every network"),
            ("[::ffff:224.0.0.1]:1", "multicast", "multicast"),
        ] {
            for (is_secure, expected) in [(false, plain), (true, secure)] {
                let checked = check_listen_address(address.parse().unwrap(), is_secure);
                match checked {
                    Ok(()) => assert_eq!(expected, "", "{address}"),
                    Err(reason) => {
                        assert!(
                            !expected.is_empty() && reason.contains(expected),
                            "{address}: {reason}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn only_addresses_of_this_machine_are_read_as_such_in_their_shortest_form() {
        let read = |text: &str| parse_loopback(text).map(|address| address.to_string());
        for (text, expected) in [
            ("127.0.0.1:1", "127.0.0.1:1"),
            ("[::1]:1", "[::1]:1"),
            ("[::ffff:127.0.0.1]:1", "127.0.0.1:1"),
        ] {
            assert_eq!(read(text).as_deref(), Some(expected), "{text}");
        }
        for text in [
            "0.0.0.0:1",
            "[::]:1",
            "[::ffff:0.0.0.0]:1",
            "[::ffff:192.0.2.2]:1",
            "localhost:1",
            "127.0.0.1",
        ] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}

//! The addresses at which servers of this program may listen.

use std::net::SocketAddr;

/// Checks the address of a server. `Err` states the reason and what to do.
///
/// Beyond the loopback address TLS is required, and the address has to be that of one interface: a server at `0.0.0.0`
/// would also listen on the networks that a person has forgotten.
pub fn check_listen_address(address: SocketAddr, is_secure: bool) -> Result<(), &'static str> {
    let ip = address.ip();
    if ip.is_unspecified() {
        return Err(
            "this address means every network of the machine; name the address of one, as `ip address` shows it",
        );
    }
    if ip.is_multicast() {
        return Err("this is a multicast address, which no server can listen at");
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
}

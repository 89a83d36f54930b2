//! Addresses of this machine for programs that open them themselves.

use std::fs;
use std::net::{Ipv4Addr, SocketAddr};
use std::process;
use std::sync::atomic::{AtomicU16, Ordering};

/// Ports below those that the system gives to sockets without one, so that no other socket takes them in the meantime.
const FIRST_PORT: u16 = 20_000;
const PORTS: u16 = 12_000;

static NEXT: AtomicU16 = AtomicU16::new(0);

/// Returns an address at which nothing listens, neither TCP nor UDP. A test program returns each once.
///
/// The kernel is asked for its sockets. A socket that is bound for a moment would stay open in a process that another test
/// starts, until that has executed its program.
pub fn free_address() -> SocketAddr {
    // Test programs that run at the same time start at other ports.
    let start = (process::id() % u32::from(PORTS / 100)) as u16 * 100;
    let bound = bound_ports();
    std::iter::repeat_with(|| NEXT.fetch_add(1, Ordering::Relaxed))
        .take(usize::from(PORTS))
        .map(|index| FIRST_PORT + (start + index) % PORTS)
        .find(|port| !bound.contains(port))
        .map(|port| SocketAddr::from((Ipv4Addr::LOCALHOST, port)))
        .expect("a free port")
}

/// Returns the ports of all sockets of the machine; none outside Linux.
fn bound_ports() -> Vec<u16> {
    let tables = ["tcp", "tcp6", "udp", "udp6"]
        .map(|table| fs::read_to_string(format!("/proc/net/{table}")).unwrap_or_default());
    assert!(
        cfg!(not(target_os = "linux")) || tables[0].contains("local_address"),
        "no table of sockets"
    );
    // The second field is `address:port`, in hexadecimal digits.
    let port = |line: &str| {
        let (_, port) = line.split_whitespace().nth(1)?.split_once(':')?;
        u16::from_str_radix(port, 16).ok()
    };
    tables
        .iter()
        .flat_map(|table| table.lines())
        .filter_map(port)
        .collect()
}

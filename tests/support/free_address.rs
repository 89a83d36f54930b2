//! Addresses of this machine for programs that open them themselves.

use std::net::{Ipv4Addr, SocketAddr, TcpListener, UdpSocket};
use std::process;
use std::sync::atomic::{AtomicU16, Ordering};

/// Ports below those that the system gives to sockets without one, so that no other socket takes them in the meantime.
const FIRST_PORT: u16 = 20_000;
const PORTS: u16 = 12_000;

static NEXT: AtomicU16 = AtomicU16::new(0);

/// Returns an address at which nothing listens, neither TCP nor UDP. A test program returns each once.
pub fn free_address() -> SocketAddr {
    // Test programs that run at the same time start at other ports.
    let start = (process::id() % u32::from(PORTS / 100)) as u16 * 100;
    let mut candidates = std::iter::repeat_with(|| NEXT.fetch_add(1, Ordering::Relaxed))
        .take(usize::from(PORTS))
        .map(|index| FIRST_PORT + (start + index) % PORTS)
        .map(|port| SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
    let is_free = |address: &SocketAddr| {
        TcpListener::bind(address).is_ok() && UdpSocket::bind(address).is_ok()
    };
    candidates.find(is_free).expect("a free port")
}

//! UDP receiver: each datagram holds whole packets, and only datagrams of one sender are read at a time.

use std::io::{Error, ErrorKind, Read, Result, Write};
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::{Scheme, Transport, check_socket_address, listen_remedy, open_stream};
use crate::capture::active_sender::ActiveSender;
use crate::capture::connection::{
    ByteStream, ConnectError, Connection, Connector, READ_TIMEOUT, UNKNOWN_SENDER,
};
use crate::capture::poll::Readiness;
use crate::network::{canonical, parse_loopback};

/// The `udp` transport.
pub const TRANSPORT: Transport = Transport {
    scheme: SCHEME,
    is_remote: true,
    is_datagram: true,
    needs_token: false,
    is_device: false,
    has_address: true,
    default_baud: None,
    probe: Some(|address| {
        bind(address)
            .map(drop)
            .map_err(|error| format!("{error}; {}", listen_remedy(&error)))
    }),
    check_address,
    open: |uri| {
        let address = uri.address.clone();
        open_stream(uri, UdpConnector { address })
    },
};

const SCHEME: Scheme = Scheme {
    name: "udp",
    syntax: "udp:ADDRESS:PORT",
    summary: "datagrams from this machine",
    example: "udp:127.0.0.1:9000?protocol=text-line",
};

/// Checks that the address is one of this machine that no other machine can send to: datagrams carry no credential.
fn check_address(address: &str) -> std::result::Result<(), String> {
    check_socket_address(SCHEME, address)?;
    let is_loopback = parse_loopback(address).is_some();
    if is_loopback || address.starts_with("localhost:") {
        Ok(())
    } else {
        Err(
        "datagrams carry no credential, so `udp` receives from this machine only: write `udp:127.0.0.1:PORT` and \
         forward the data through a tunnel such as WireGuard, or let the other machine share its hand with `+tls`"
            .to_owned(),
    )
    }
}

/// Binder of a local address.
#[derive(Clone)]
struct UdpConnector {
    address: String,
}

impl Connector for UdpConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;
    const IS_DATAGRAM: bool = true;
    const HAS_SENDERS: bool = true;
    const FIRST_BYTE_TIMEOUT: Option<Duration> = Some(Duration::from_secs(5));
    /// More than the longest datagram.
    const READ_BYTES: usize = 1 << 16;

    fn connect(&mut self) -> std::result::Result<Connection, ConnectError> {
        let socket = bind(&self.address)
            .map_err(|error| ConnectError::Absent(format!("{error}; {}", listen_remedy(&error))))?;
        let readiness = Readiness::new(&socket);
        // Without one, each read blocks for its timeout.
        let is_set = readiness.is_none() || socket.set_nonblocking(true).is_ok();
        Ok(Connection {
            readiness: readiness.filter(|_| is_set),
            bytes: Box::new(Datagrams {
                socket,
                senders: ActiveSender::default(),
                peer: Arc::default(),
            }),
            endpoint: self.address.clone(),
        })
    }
}

fn bind(address: &str) -> Result<UdpSocket> {
    let own = own_address(address.to_socket_addrs()?);
    // The socket must have the address to which programs send; at any other address it would receive nothing.
    let socket = UdpSocket::bind(own.as_slice())?;
    socket.set_read_timeout(Some(READ_TIMEOUT))?;
    Ok(socket)
}

/// Returns a loopback address, to which no other machine can send, if there is one: the hosts file may give `localhost` any address.
///
/// Prefers IPv4: most systems list `::1` first, but most programs that send to `localhost` use 127.0.0.1.
fn own_address(resolved: impl Iterator<Item = SocketAddr>) -> Option<SocketAddr> {
    let own = resolved.map(canonical).filter(|it| it.ip().is_loopback());
    own.min_by_key(SocketAddr::is_ipv6)
}

/// Reader of one datagram per read, all of them from one sender.
struct Datagrams {
    socket: UdpSocket,
    senders: ActiveSender<SocketAddr>,
    /// Address of the active sender, for the writer. Locked for a moment only.
    peer: Arc<Mutex<Option<SocketAddr>>>,
}

impl ByteStream for Datagrams {
    fn writer(&self) -> Option<Box<dyn Write + Send>> {
        Some(Box::new(PeerWriter {
            socket: self.socket.try_clone().ok()?,
            peer: Arc::clone(&self.peer),
        }))
    }

    fn take_sender_change(&mut self) -> bool {
        self.senders.take_change()
    }

    fn accept_sender(&mut self) -> bool {
        let accepted = self.senders.accept(Instant::now());
        if accepted.is_some() {
            *self.peer.lock().unwrap_or_else(PoisonError::into_inner) = accepted;
        }
        accepted.is_some()
    }
}

/// Writer of datagrams to the sender that is read.
struct PeerWriter {
    socket: UdpSocket,
    peer: Arc<Mutex<Option<SocketAddr>>>,
}

impl Write for PeerWriter {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let peer = *self.peer.lock().unwrap_or_else(PoisonError::into_inner);
        let peer = peer.ok_or(ErrorKind::NotConnected)?;
        self.socket.send_to(bytes, peer)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

impl Read for Datagrams {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let (length, sender) = self.socket.recv_from(buffer)?;
        if !self.senders.read_from(sender, Instant::now()) {
            return Err(Error::from(UNKNOWN_SENDER));
        }
        match length {
            // To a reader 0 is the end of the stream; an empty datagram is not.
            0 => Err(Error::from(ErrorKind::WouldBlock)),
            length => Ok(length),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::thread;
    use std::time::Duration;

    use super::*;
    use crate::capture::active_sender::SENDER_TIMEOUT;
    use crate::capture::protocol::text_line;
    use crate::capture::{Source, SourceEvent, SourceUri, open};
    use ademan_core::hand::JointAngles;
    use ademan_core::time::Timestamp;

    /// Opens a source of text lines. Returns it with its address.
    fn open_source() -> (Box<dyn Source>, SocketAddr) {
        let free = sender();
        let address = free.local_addr().unwrap();
        drop(free);
        let uri: SourceUri = format!("udp:{address}?protocol=text-line").parse().unwrap();
        (open(&uri).unwrap(), address)
    }

    fn sender() -> UdpSocket {
        UdpSocket::bind("127.0.0.1:0").unwrap()
    }

    fn line(time: Option<Timestamp>) -> Vec<u8> {
        let mut line = Vec::new();
        text_line::write(&JointAngles::default(), time, &mut line);
        line
    }

    #[test]
    fn a_name_is_its_address_of_ipv4_on_this_machine_before_the_one_of_ipv6() {
        let address = |text: &str| -> SocketAddr { text.parse().unwrap() };
        let resolved = ["[::1]:9000", "192.0.2.1:9000", "127.0.0.1:9000"].map(address);
        let own = |count: usize| own_address(resolved.into_iter().take(count));
        assert_eq!(own(1), Some(resolved[0]));
        assert_eq!(own(3), Some(resolved[2]));
        assert_eq!(own_address([resolved[1]].into_iter()), None);
    }

    #[test]
    fn a_sender_that_follows_another_one_is_counted_with_its_first_packet() {
        let (mut source, address) = open_source();
        let packet = line(None);
        let mut changes_after = |socket: &UdpSocket, bytes: &[u8]| {
            socket.send_to(bytes, address).unwrap();
            let is_packet = bytes == packet;
            let start = std::time::Instant::now();
            while !matches!(source.next(), Ok(SourceEvent::Reading(_))) && is_packet {
                assert!(start.elapsed().as_secs() < 60, "no reading");
            }
            source.stats().sender_changes
        };
        let (first, second) = (sender(), sender());
        assert_eq!(changes_after(&first, &packet), 0);
        thread::sleep(SENDER_TIMEOUT);
        assert_eq!(changes_after(&first, &packet), 0, "it was silent");
        thread::sleep(SENDER_TIMEOUT);
        assert_eq!(changes_after(&second, b"no packet"), 0);
        assert_eq!(changes_after(&second, &packet), 1);
        thread::sleep(SENDER_TIMEOUT);
        assert_eq!(changes_after(&first, &packet), 2);
    }

    #[test]
    fn lines_of_a_clock_that_is_set_back_by_half_a_second_are_read_again_soon() {
        let (mut source, address) = open_source();
        let socket = sender();
        let start = Instant::now();
        let mut readings_until = |end: u64, ahead: Duration| {
            let mut readings = 0;
            while start.elapsed() < Duration::from_secs(end) {
                let time = Timestamp((start.elapsed() + ahead).as_micros() as u64);
                socket.send_to(&line(Some(time)), address).unwrap();
                readings += usize::from(matches!(source.next(), Ok(SourceEvent::Reading(_))));
                thread::sleep(Duration::from_millis(10));
            }
            readings
        };
        assert!(readings_until(3, Duration::from_millis(500)) > 0);
        // Until the clock has passed the latest time that it had stated.
        readings_until(4, Duration::ZERO);
        assert!(readings_until(6, Duration::ZERO) > 0);
    }
}

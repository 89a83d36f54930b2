//! Datagrams of the steps of a session.

mod opentrack;
mod vmc;

use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};

use self::opentrack::OpentrackEncoder;
use self::vmc::VmcEncoder;
use super::step::SharedStep;
use super::{ShareError, ShareFormat, ShareTarget};
use ademan_core::hand::Side;

/// A sender to one address.
pub(super) struct DatagramSender {
    socket: UdpSocket,
    encoder: Encoder,
}

enum Encoder {
    Vmc(Box<VmcEncoder>),
    Opentrack(OpentrackEncoder),
}

impl DatagramSender {
    /// Opens a socket that sends to the address of a target. `first` is the first hand of the session.
    pub fn open(target: &ShareTarget, first: Side) -> Result<Self, ShareError> {
        let any_port: SocketAddr = match target.address {
            SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
            SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, 0).into(),
        };
        let open = || {
            let socket = UdpSocket::bind(any_port)?;
            socket.connect(target.address)?;
            socket.set_nonblocking(true)?;
            Ok(socket)
        };
        let socket = open().map_err(|error| ShareError::Send {
            address: target.address,
            error,
        })?;
        let encoder = match target.format {
            ShareFormat::Opentrack => Encoder::Opentrack(OpentrackEncoder::new(first)),
            _ => Encoder::Vmc(Box::default()),
        };
        Ok(Self { socket, encoder })
    }

    /// Sends the datagram of a step, if it has one. A receiver that is not there, or is too slow, misses it.
    pub fn send(&mut self, step: &SharedStep) {
        let Some((angles, pose)) = step.hand() else {
            return;
        };
        match &mut self.encoder {
            Encoder::Vmc(encoder) => {
                if let Some(datagram) = encoder.encode(angles, pose) {
                    let _ = self.socket.send(&datagram);
                }
            }
            Encoder::Opentrack(encoder) => {
                if let Some(datagram) = encoder.encode(pose) {
                    let _ = self.socket.send(&datagram);
                }
            }
        }
    }
}

//! The handshakes in progress, of which a silent client cannot take all.

use std::net::{IpAddr, Shutdown, TcpStream};
use std::sync::Arc;

/// Most handshakes at the same time.
pub const MAX_HANDSHAKES: usize = 16;

/// Most handshakes of one network at the same time, so that one machine cannot take them all.
pub const MAX_HANDSHAKES_OF_NETWORK: usize = 4;

/// As [`MAX_HANDSHAKES_OF_NETWORK`], for a server of pages: a browser opens six connections at once.
const MAX_HANDSHAKES_OF_BROWSERS: usize = 12;

/// The handshakes in progress, the oldest first.
pub struct Handshakes {
    list: Vec<Handshake>,
    latest: u64,
    max_of_network: usize,
}

impl Default for Handshakes {
    fn default() -> Self {
        Self {
            list: Vec::new(),
            latest: 0,
            max_of_network: MAX_HANDSHAKES_OF_NETWORK,
        }
    }
}

struct Handshake {
    number: u64,
    network: IpAddr,
    socket: Arc<TcpStream>,
}

impl Handshakes {
    /// Creates an empty list for a server of pages.
    pub fn of_browsers() -> Self {
        Self {
            max_of_network: MAX_HANDSHAKES_OF_BROWSERS,
            ..Self::default()
        }
    }

    /// Adds the connection of a client in a network. Returns its number.
    ///
    /// Beyond the limits the oldest handshake makes room: of this network if it has too many, otherwise of the network that has
    /// most. A client that speaks is done within milliseconds, so that the oldest is one that does not.
    pub fn add(&mut self, network: IpAddr, socket: &Arc<TcpStream>) -> u64 {
        if self.count(network) >= self.max_of_network {
            self.disconnect_oldest(network);
        } else if self.list.len() >= MAX_HANDSHAKES {
            let networks = self.list.iter().rev().map(|other| other.network);
            if let Some(largest) = networks.max_by_key(|other| self.count(*other)) {
                self.disconnect_oldest(largest);
            }
        }
        self.latest += 1;
        self.list.push(Handshake {
            number: self.latest,
            network,
            socket: Arc::clone(socket),
        });
        self.latest
    }

    /// Removes a handshake that has ended.
    pub fn remove(&mut self, number: u64) {
        self.list.retain(|other| other.number != number);
    }

    fn count(&self, network: IpAddr) -> usize {
        let same = self.list.iter().filter(|other| other.network == network);
        same.count()
    }

    fn disconnect_oldest(&mut self, network: IpAddr) {
        let index = self.list.iter().position(|other| other.network == network);
        if let Some(index) = index {
            let oldest = self.list.remove(index);
            let _ = oldest.socket.shutdown(Shutdown::Both);
        }
    }

    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.list.len()
    }

    #[cfg(test)]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

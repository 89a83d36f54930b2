//! A limit on wrong tokens: a growing pause for each address, in bounded memory.

use std::net::{IpAddr, Ipv6Addr};
use std::time::{Duration, Instant};

/// Wrong tokens of an address before its first pause.
const FREE_TRIES: u32 = 5;

/// The first pause. Each further wrong token doubles it.
const FIRST_PAUSE: Duration = Duration::from_secs(60);

/// The longest pause, and the time after which an address without a wrong token is forgotten.
const LONGEST_PAUSE: Duration = Duration::from_secs(3600);

/// Most addresses that are remembered.
const MAX_ADDRESSES: usize = 1024;

/// The addresses that have shown wrong tokens.
#[derive(Debug, Default)]
pub struct FailedTries {
    addresses: Vec<Address>,
}

#[derive(Debug)]
struct Address {
    network: IpAddr,
    tries: u32,
    last: Instant,
}

impl Address {
    /// Returns the pause after the last wrong token.
    fn pause(&self) -> Duration {
        let Some(doublings) = self.tries.checked_sub(FREE_TRIES) else {
            return Duration::ZERO;
        };
        FIRST_PAUSE
            .saturating_mul(1 << doublings.min(16))
            .min(LONGEST_PAUSE)
    }
}

impl FailedTries {
    /// Returns `true` if clients at this address have to wait.
    pub fn is_paused(&self, address: IpAddr, now: Instant) -> bool {
        let network = network_of(address);
        let found = self.addresses.iter().find(|known| known.network == network);
        found.is_some_and(|known| now.saturating_duration_since(known.last) < known.pause())
    }

    /// Counts a wrong token. Returns the pause that begins.
    pub fn count(&mut self, address: IpAddr, now: Instant) -> Duration {
        let network = network_of(address);
        self.addresses
            .retain(|known| now.saturating_duration_since(known.last) < LONGEST_PAUSE);
        let index = self
            .addresses
            .iter()
            .position(|known| known.network == network);
        let index = index.unwrap_or_else(|| self.add(network, now));
        let known = &mut self.addresses[index];
        known.tries = known.tries.saturating_add(1);
        known.last = now;
        known.pause()
    }

    /// Adds an address, in place of the one with the fewest tries if there are too many. Returns its index.
    fn add(&mut self, network: IpAddr, now: Instant) -> usize {
        if self.addresses.len() == MAX_ADDRESSES {
            let addresses = self.addresses.iter().enumerate();
            let least = addresses.min_by_key(|(_, known)| (known.tries, known.last));
            if let Some((index, _)) = least {
                self.addresses.swap_remove(index);
            }
        }
        self.addresses.push(Address {
            network,
            tries: 0,
            last: now,
        });
        self.addresses.len() - 1
    }
}

/// Returns the network of a client: its address, or the 64 bits of an IPv6 address that one machine cannot choose.
pub fn network_of(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) if !address.is_loopback() => {
            Ipv6Addr::from_bits(address.to_bits() >> 64 << 64).into()
        }
        address => address,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(number: u32) -> IpAddr {
        IpAddr::from(number.to_be_bytes())
    }

    #[test]
    fn an_address_has_five_tries_and_then_a_growing_pause() {
        let (mut tries, start) = (FailedTries::default(), Instant::now());
        let pauses: Vec<u64> = (0..12)
            .map(|_| tries.count(address(1), start).as_secs())
            .collect();
        assert_eq!(
            pauses,
            [0, 0, 0, 0, 60, 120, 240, 480, 960, 1920, 3600, 3600]
        );
        assert!(tries.is_paused(address(1), start + Duration::from_secs(3599)));
        assert!(!tries.is_paused(address(1), start + Duration::from_secs(3600)));
        assert!(!tries.is_paused(address(2), start));
    }

    #[test]
    fn ten_thousand_addresses_take_the_memory_of_a_thousand_and_end_no_long_pause() {
        let (mut tries, start) = (FailedTries::default(), Instant::now());
        for _ in 0..9 {
            tries.count(address(1), start);
        }
        for number in 0..10_000 {
            tries.count(address(100 + number), start);
        }
        assert_eq!(tries.addresses.len(), MAX_ADDRESSES);
        assert!(tries.is_paused(address(1), start + Duration::from_secs(60)));
    }

    #[test]
    fn a_machine_has_one_pause_for_all_addresses_that_it_can_choose() {
        let network = |text: &str| network_of(text.parse().unwrap());
        assert_eq!(network("2001:db8::1"), network("2001:db8::ffff:1:2"));
        assert_ne!(network("2001:db8::1"), network("2001:db8:0:1::1"));
        assert_eq!(network("::ffff:192.0.2.1"), network("192.0.2.1"));
        assert_eq!(network("::ffff:127.0.0.1"), network("127.0.0.1"));
        assert_ne!(network("::1"), network("::2"));
    }
}

//! The one sender that a source reads, of several that can send to it.

use std::time::{Duration, Instant};

use super::garbage::GarbageDetector;
use super::protocol::{InvalidPacket, InvalidPackets};

/// Silence of the active sender after which another one can become active.
pub(super) const SENDER_TIMEOUT: Duration = Duration::from_secs(2);

/// The active sender of a source. If the packets of two senders were read together, the hand would jump between them.
///
/// A sender becomes active with a valid packet and stays active until it has sent none for [`SENDER_TIMEOUT`]. Anything else,
/// such as an empty datagram, neither makes a sender active nor keeps it active.
#[derive(Debug)]
pub(super) struct ActiveSender<T> {
    /// The active sender, and the time of its latest valid packet.
    active: Option<(T, Instant)>,
    /// The sender whose bytes were read last.
    latest: Option<T>,
    has_changed: bool,
}

impl<T> Default for ActiveSender<T> {
    fn default() -> Self {
        Self {
            active: None,
            latest: None,
            has_changed: false,
        }
    }
}

impl<T: Copy + PartialEq> ActiveSender<T> {
    /// Returns the active sender; `None` if it has sent no valid packet for [`SENDER_TIMEOUT`].
    pub fn get(&self, now: Instant) -> Option<T> {
        let (sender, last) = self.active?;
        (now.saturating_duration_since(last) < SENDER_TIMEOUT).then_some(sender)
    }

    /// Returns the latest sender that was active, however long it has been silent.
    pub fn last(&self) -> Option<T> {
        self.active.map(|(sender, _)| sender)
    }

    /// Handles bytes of a sender. Returns `false` if they are dropped because another one is active.
    pub fn read_from(&mut self, sender: T, now: Instant) -> bool {
        if self.get(now).is_some_and(|active| active != sender) {
            return false;
        }
        self.has_changed |= self.latest.is_some_and(|latest| latest != sender);
        self.latest = Some(sender);
        true
    }

    /// Returns `true` if bytes of another sender were read since the previous call.
    pub fn take_change(&mut self) -> bool {
        std::mem::take(&mut self.has_changed)
    }

    /// Makes the sender of the bytes that were read last active, because they completed a valid packet. Returns the sender if it is
    /// another one than the previous active sender.
    pub fn accept(&mut self, now: Instant) -> Option<T> {
        let sender = self.latest?;
        let before = self.active.replace((sender, now));
        before
            .is_none_or(|(before, _)| before != sender)
            .then_some(sender)
    }
}

/// Counter of the senders of a source.
#[derive(Default)]
pub(super) struct SenderCount {
    accepted: u64,
    /// Packets that were dropped because another sender is active.
    refused: InvalidPackets,
    /// Detector of such packets that keep arriving.
    detector: GarbageDetector,
}

impl SenderCount {
    /// Counts a sender that was accepted, if `is_new`: it is another one than the previous active sender.
    pub fn note(&mut self, is_new: bool) {
        self.accepted += u64::from(is_new);
    }

    /// Returns how often a sender has followed another one.
    pub fn changes(&self) -> u64 {
        self.accepted.saturating_sub(1)
    }

    /// Counts a packet that was dropped at `now` because another sender is active. Returns `true` if a warning is due, once: several
    /// senders have sent for 2 s.
    pub fn refuse(&mut self, now: Instant) -> bool {
        self.refused.count(InvalidPacket::UnknownSender);
        self.detector.update(now, false)
    }

    /// Returns the number of packets that were dropped because another sender is active, by that reason.
    pub fn refused(&self) -> InvalidPackets {
        self.refused
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_valid_packet_makes_a_sender_active_and_keeps_it_so() {
        let mut senders = ActiveSender::default();
        let start = Instant::now();
        let at = |millis| start + Duration::from_millis(millis);
        // Before the first valid packet both are read, and each change of the sender is reported.
        assert!(senders.read_from('a', at(0)) && !senders.take_change());
        assert!(senders.read_from('b', at(1)) && senders.take_change());
        assert!(senders.read_from('b', at(2)) && !senders.take_change());
        assert_eq!(senders.accept(at(2)), Some('b'));
        assert!(!senders.read_from('a', at(2001)));
        // Bytes without a packet keep it active no longer.
        assert!(senders.read_from('b', at(2001)) && !senders.take_change());
        assert_eq!(senders.get(at(2002)), None);
        assert_eq!(senders.last(), Some('b'));
        assert!(senders.read_from('a', at(2002)) && senders.take_change());
        assert_eq!(senders.accept(at(2002)), Some('a'));
        assert!(!senders.read_from('b', at(2003)));
        assert!(senders.read_from('a', at(4000)));
        assert_eq!(senders.accept(at(4000)), None, "it was active");
        assert!(!senders.read_from('b', at(5999)));
    }
}

//! Pauses of a sender after its packets.

/// Number of consecutive packets with a pause after each and none within, before a pause confirms a packet. Adapters that deliver bytes
/// in blocks cause pauses anywhere, occasionally at the end of a packet.
const MIN_PACKETS: u8 = 8;

/// Detector of a sender that pauses after every packet and never within one.
///
/// A pause of such a sender marks the end of a packet as well as the header of the next one does: a packet that lost or
/// gained a byte has another length.
#[derive(Clone, Debug, Default)]
pub(super) struct PacketPauses {
    /// Pauses after packets since the last pause within a packet, at most [`MIN_PACKETS`].
    consecutive: u8,
    /// `true` if no byte has followed the latest pause.
    is_paused: bool,
}

impl PacketPauses {
    /// Handles bytes, which end a pause.
    pub fn push_bytes(&mut self) {
        self.is_paused = false;
    }

    /// Returns `true` if a pause would be a new one.
    pub fn is_expected(&self) -> bool {
        !self.is_paused
    }

    /// Handles a pause. Returns `true` if it confirms the packet before it.
    pub fn push_pause(&mut self, is_after_packet: bool) -> bool {
        if std::mem::replace(&mut self.is_paused, true) {
            return false;
        }
        if !is_after_packet {
            self.consecutive = 0;
            return false;
        }
        let is_confirmed = self.consecutive == MIN_PACKETS;
        self.consecutive = MIN_PACKETS.min(self.consecutive + 1);
        is_confirmed
    }
}

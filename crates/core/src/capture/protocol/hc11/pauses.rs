//! Pauses of a sender after its packets.

/// Packets in a row with a pause after each and none within, before a pause confirms a packet. Adapters that deliver bytes in
/// blocks cause pauses anywhere, and one of them at the end of a packet now and then.
const REQUIRED: u8 = 8;

/// Detector of a sender that pauses after every packet and never within one.
///
/// A pause of such a sender marks the end of a packet as well as the header of the next one does: a packet that lost or
/// gained a byte has another length.
#[derive(Clone, Debug, Default)]
pub(super) struct PacketPauses {
    /// Pauses after packets since the last one within a packet, at most [`REQUIRED`].
    in_a_row: u8,
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
            self.in_a_row = 0;
            return false;
        }
        let is_confirmed = self.in_a_row == REQUIRED;
        self.in_a_row = REQUIRED.min(self.in_a_row + 1);
        is_confirmed
    }
}

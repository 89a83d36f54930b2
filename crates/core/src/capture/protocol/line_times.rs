//! The order of lines by the times that they state.

use super::{InvalidPacket, PacketError};
use crate::time::Timestamp;

/// Latest time in a line, in microseconds: 285 years, which JSON numbers hold exactly.
const MAX_TIME_US: u64 = 1 << 53;

/// Largest delay of a datagram that another one has overtaken, in microseconds.
const MAX_DISORDER_US: u64 = 100_000;

/// Largest delay of a line that a network has held back, in microseconds. A line that is still earlier comes from a sender that has
/// started again.
const MAX_DELAY_US: u64 = 1_000_000;

/// Order of the lines by the times that they state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineTimes {
    latest: Option<u64>,
}

impl LineTimes {
    /// Accepts the time of a line, if the line states one. The time must be later than the times of all earlier lines, or so much earlier
    /// that the sender has started again.
    pub fn check(&mut self, time_us: Option<u64>) -> Result<Option<Timestamp>, PacketError> {
        let Some(time) = time_us else {
            return Ok(None);
        };
        if time > MAX_TIME_US {
            let text = format!("`time_us` is beyond {MAX_TIME_US}");
            return Err(PacketError::new(InvalidPacket::NotFinite, text));
        }
        let delay = self.latest.and_then(|latest| latest.checked_sub(time));
        let reason = match delay {
            Some(..=MAX_DISORDER_US) => InvalidPacket::OutOfOrder,
            Some(..=MAX_DELAY_US) => InvalidPacket::TooOld,
            _ => {
                self.latest = Some(time);
                return Ok(Some(Timestamp(time)));
            }
        };
        let text = "`time_us` is not later than in an earlier line; it counts microseconds";
        Err(PacketError::new(reason, text))
    }
}

//! When a frame was complete.

use std::time::Instant;

use super::hc11::PACKET_BYTES;
use super::uri::StreamOptions;
use crate::time::Timestamp;

/// The clock of a source.
pub(super) enum PacketClock {
    /// By the monotonic clock, from the moment the source was opened.
    Live { opened: Instant, last: Timestamp },
    /// By the number of frames, at the pace of the baud.
    Nominal { frames: u64, last: Timestamp },
}

impl PacketClock {
    pub fn new(is_live: bool) -> Self {
        let last = Timestamp::default();
        match is_live {
            true => Self::Live {
                opened: Instant::now(),
                last,
            },
            false => Self::Nominal { frames: 0, last },
        }
    }

    /// The time of a frame after which `bytes_after` more came in until `now`; always later than the one before.
    pub fn stamp(&mut self, now: Instant, bytes_after: usize, line: &StreamOptions) -> Timestamp {
        let (time, last) = match self {
            Self::Live { opened, last } => {
                let arrived = Timestamp::default() + now.saturating_duration_since(*opened);
                (arrived - line.transmission_time(bytes_after), last)
            }
            Self::Nominal { frames, last } => {
                *frames += 1;
                let microseconds = *frames as u128 * PACKET_BYTES as u128 * 10_000_000
                    / u128::from(line.baud.get());
                (Timestamp(microseconds as u64), last)
            }
        };
        *last = time.max(Timestamp(last.0 + 1));
        *last
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU32;
    use std::time::Duration;

    use super::*;

    #[test]
    fn frames_of_one_read_are_dated_back_by_what_came_after_them() {
        let line = StreamOptions {
            baud: NonZeroU32::new(9600).unwrap(),
            ..StreamOptions::default()
        };
        let mut clock = PacketClock::new(true);
        let PacketClock::Live { opened, .. } = clock else {
            panic!("not live");
        };
        let now = opened + Duration::from_secs(1);
        let mut stamp = |now, bytes| clock.stamp(now, bytes, &line).0;
        assert_eq!(stamp(now, 96), 900_000);
        assert_eq!(stamp(now, 30), 968_750);
        assert_eq!(stamp(now, 96), 968_751);
        assert_eq!(stamp(opened, 0), 968_752);
        assert_eq!(stamp(now + Duration::from_secs(1), 0), 2_000_000);
    }
}

//! Time stamps of packets.

use std::time::Instant;

use super::protocol::StreamFormat;
use ademan_core::time::Timestamp;

/// Clock that stamps the packets of a stream.
pub(super) enum PacketClock {
    /// Monotonic time since the source was opened.
    Live { opened: Instant, last: Timestamp },
    /// Time that the packets state, else their number times the nominal packet period.
    Nominal { packets: u64, last: Timestamp },
}

impl PacketClock {
    /// Creates a clock that starts now.
    pub fn new(is_live: bool) -> Self {
        let last = Timestamp::default();
        if is_live {
            Self::Live {
                opened: Instant::now(),
                last,
            }
        } else {
            Self::Nominal { packets: 0, last }
        }
    }

    /// Returns the time at which the last byte of a packet arrived, if `bytes_after` more bytes had arrived by `now`.
    /// Always later than the previous result. `stated` is the time that the packet states.
    pub fn stamp(
        &mut self,
        now: Instant,
        bytes_after: usize,
        format: &StreamFormat,
        stated: Option<Timestamp>,
    ) -> Timestamp {
        let (time, last) = match self {
            Self::Live { opened, last } => {
                let arrived = Timestamp::default() + now.saturating_duration_since(*opened);
                (arrived - format.transmission_time(bytes_after), last)
            }
            Self::Nominal { packets, last } => {
                *packets += 1;
                let time = stated.unwrap_or_else(|| format.nominal_time(*packets));
                (time, last)
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
    use crate::capture::hc11::Hc11Format;

    #[test]
    fn packets_of_one_read_are_dated_back_by_the_bytes_after_them() {
        let format = StreamFormat::from(Hc11Format {
            baud: NonZeroU32::new(9600).unwrap(),
            ..Hc11Format::default()
        });
        let mut clock = PacketClock::new(true);
        let PacketClock::Live { opened, .. } = clock else {
            panic!("not live");
        };
        let now = opened + Duration::from_secs(1);
        let mut stamp = |at, bytes| clock.stamp(at, bytes, &format, None).0;
        assert_eq!(stamp(now, 96), 900_000);
        assert_eq!(stamp(now, 30), 968_750);
        assert_eq!(stamp(now, 96), 968_751);
        assert_eq!(stamp(opened, 0), 968_752);
        assert_eq!(stamp(now + Duration::from_secs(1), 0), 2_000_000);
    }
}
